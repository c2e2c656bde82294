#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# cppcheck over the library and the command line. Usage: cppcheck.sh
set -eu
cd "$(dirname "$0")/.."
command -v cppcheck >/dev/null || {
    echo "cppcheck: skipped, for there is none (apt install cppcheck)"
    exit 0
}
cppcheck --enable=warning,performance,portability --inline-suppr --quiet --std=c11 -j "$(nproc)" \
    -Iinclude -Isrc --suppress=missingIncludeSystem --error-exitcode=1 src cli tools
echo "cppcheck: no findings"
