#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A folder of src/ includes only itself and the folders above it in this list; cover includes core
# only; cli sees public headers only.
set -eu
cd "$(dirname "$0")/.."

layers="core geometry mesh skeleton visibility cover guard tetra star verify sample export shape morph"
above=""
failed=0

report() {
    echo "layer check: $1" >&2
    failed=1
}

for layer in $layers; do
    above="$above $layer"
    allowed=$above
    case $layer in
    cover | verify) allowed="core $layer" ;;
    esac
    for include in $(grep -rhoE '^#include "[a-z]+/' "src/$layer" | sed 's/.*"//; s|/||' | sort -u); do
        [ "$include" = starguard ] && continue
        case " $allowed " in
        *" $include "*) ;;
        *) report "src/$layer includes $include/: $(grep -rlE "^#include \"$include/" "src/$layer" | tr '\n' ' ')" ;;
        esac
    done
done

for folder in src/*/; do
    case " $layers " in
    *" $(basename "$folder") "*) ;;
    *) report "$folder is in no layer" ;;
    esac
done

if grep -rnE '^#include "(core|geometry|mesh|skeleton|visibility|cover|guard|tetra|star|shape|morph|verify|sample|export)/' cli >&2; then
    report "cli may include public headers only"
fi
exit $failed
