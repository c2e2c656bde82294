#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A folder of src/ includes only itself, the folders above it in this list, and the public headers that
# these implement; cover includes core only. verify includes core and the public headers that declare
# what it checks: their structs and readers are all it shares with the solvers (docs/verification.md).
# cli includes public headers only; the library starguard-shapes is the last two folders.
set -eu
cd "$(dirname "$0")/.."

# A folder, and the public headers that it implements; star reads the pieces that verify checks.
layers="core:bits,context,export,fields,ranks,status,version geometry:
mesh:check,mesh,repair,simplify,solid,space visibility:visibility,kernel skeleton:skeleton cover:cover
guard:guard tetra:tetra sphere: star:decompose,verify verify:verify sample:sample
export:animation,page,picture,scene shape:database,descriptor,shape morph:morph,solidmap"
above=""
headers_above=""
failed=0

report() {
    echo "layer check: $1" >&2
    failed=1
}

for entry in $layers; do
    layer=${entry%%:*}
    headers=$(echo "${entry#*:}" | tr ',' ' ')
    above="$above $layer"
    headers_above="$headers_above $headers"
    allowed=$above
    headers_allowed=$headers_above
    case $layer in
    cover) allowed="core $layer" headers_allowed="bits context fields $headers" ;;
    verify) allowed="core $layer" headers_allowed="mesh visibility $headers" ;;
    esac
    for include in $(grep -rhoE '^#include "[a-z]+/' "src/$layer" | sed 's/.*"//; s|/||' | sort -u); do
        case " starguard $allowed " in
        *" $include "*) ;;
        *) report "src/$layer includes $include/: $(grep -rlE "^#include \"$include/" "src/$layer" | tr '\n' ' ')" ;;
        esac
    done
    for header in $(grep -rhoE '^#include "starguard/[a-z]+' "src/$layer" | sed 's|.*/||' | sort -u); do
        case " $headers_allowed " in
        *" $header "*) ;;
        *) report "src/$layer includes starguard/$header.h: $(grep -rlE "^#include \"starguard/$header.h" "src/$layer" | tr '\n' ' ')" ;;
        esac
    done
done

# The partition knows nothing of the searches that change it.
floor="partition region cut apply merge_coplanar"
for name in $floor; do
    if grep -HnE '^#include "star/certified/search.h"' "src/star/certified/$name".[ch] >&2; then
        report "star/certified: $name is below search.h"
    fi
done

for folder in src/*/; do
    case " $above " in
    *" $(basename "$folder") "*) ;;
    *) report "$folder is in no layer" ;;
    esac
done
for header in include/starguard/*.h; do
    case " starguard $headers_above " in
    *" $(basename "$header" .h) "*) ;;
    *) report "$header is of no layer" ;;
    esac
done

inside=$(echo "$above" | tr ' ' '|')
if grep -rnE "^#include \"(${inside#|})/" cli >&2; then
    report "cli may include public headers only"
fi
exit $failed
