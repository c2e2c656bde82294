#!/bin/sh
# clang-tidy over the library and the command line. Usage: tidy.sh BUILD
# Not those that this build may not compile: the visibility stages for instruction sets, which are one
# source (the plain form stands for all), and what stands in for the viewer.
set -eu
cd "$(dirname "$0")/.."
log="$1/tidy.log"
if ! find src cli -name '*.c' ! -name '*_avx*.c' ! -name '*_neon.c' ! -name viewer_missing.c -print0 | sort -z |
    xargs -0 -P "$(nproc)" -n 6 clang-tidy -p "$1" --quiet >"$log" 2>&1; then
    grep -E 'warning:|error:' "$log" >&2
    exit 1
fi
echo "tidy: nothing to complain of"
