#!/bin/sh
# Format, layers, and public headers that stand alone.
set -eu
cd "$(dirname "$0")/.."

sources=$(find include src cli tests bench examples -name '*.[ch]' 2>/dev/null | sort)
# shellcheck disable=SC2086
clang-format --dry-run -Werror $sources

scripts/check-layers.sh

for header in include/starguard/*.h; do
    gcc -std=c11 -Wall -Wextra -Wpedantic -Werror -Iinclude -fsyntax-only -x c "$header"
    g++ -std=c++11 -Wall -Wextra -Wpedantic -Werror -Iinclude -fsyntax-only -x c++ "$header"
done
echo "lint: format, layers and headers are fine"
