#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs every kind of command under valgrind, which detects reads of uninitialized memory. valgrind does
# not support AVX-512, and the program does not use it there; results must equal those of a normal run,
# so this also compares vector widths.
# Usage: memory.sh BUILD
set -eu
cd "$(dirname "$0")/.."
build=$(cd "$1" && pwd)
watched=$build/starguard-valgrind
cat >"$watched" <<END
#!/bin/sh
exec valgrind --quiet --error-exitcode=99 "$build/starguard" "\$@"
END
chmod +x "$watched"
scripts/determinism.py --threads 2 "$build/starguard" "$watched"
