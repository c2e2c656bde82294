#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# clang-tidy over what a build compiles of the library and the command line. Usage: tidy.sh BUILD
# But for the visibility stages for instruction sets, which are one source: the plain variant stands for all.
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
