#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Checks format, layers, sizes of rooms, names of files in comments and pages, and that public headers compile
# alone.
set -eu
cd "$(dirname "$0")/.."

sources=$( (find include src cli tools tests bench examples web -name '*.[ch]'; find src -name '*.cpp') 2>/dev/null | sort)
# shellcheck disable=SC2086
clang-format --dry-run -Werror $sources

scripts/check-layers.sh
python3 scripts/dead-names.py
python3 scripts/budget.py

# The licence line of each source.
unmarked=$(git ls-files '*.c' '*.h' '*.cpp' '*.py' '*.sh' '*.js' '*.mjs' '*.cmake' '*CMakeLists.txt' |
    xargs grep -L 'SPDX-License-Identifier' || true)
if [ -n "$unmarked" ]; then
    echo "lint: without an SPDX line: $unmarked" >&2
    exit 1
fi

# Each public header alone, as C11 and as C++.
for header in include/starguard/*.h; do
    unit=$(printf '#include "%s"\ntypedef int starg_not_empty;\n' "${header#include/}")
    for language in "gcc -std=c11 -x c" "g++ -std=c++11 -x c++"; do
        # shellcheck disable=SC2086
        printf '%s\n' "$unit" | $language -Wall -Wextra -Wpedantic -Werror -Iinclude -fsyntax-only -
    done
done
# The lock file of the viewer must not name a registry: npm uses the configured one.
if grep -nE '"resolved"|https?://' viewer/package-lock.json viewer/package.json >&2; then
    echo "lint: viewer/package-lock.json names a registry; make it anew with" >&2
    echo "  npm install --package-lock-only --omit-lockfile-registry-resolved" >&2
    exit 1
fi

echo "lint: format, layers and headers are fine"
