#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# clang-tidy over the compiled sources of the library and the command line. Usage: tidy.sh BUILD
# Of the visibility stages, one source for all instruction sets, it checks only the plain variant.
set -eu
cd "$(dirname "$0")/.."
log="$1/tidy.log"
sources() {
    jq -r '.[].file' "$1/compile_commands.json" | grep "^$PWD/\(src\|cli\)/.*\.c$" | grep -v '_avx\|_neon' | sort -u
}
if ! sources "$1" | tr '\n' '\0' | xargs -0 -P "$(nproc)" -n 6 clang-tidy -p "$1" --quiet >"$log" 2>&1; then
    grep -E 'warning:|error:' "$log" >&2
    exit 1
fi
echo "tidy: no findings"
