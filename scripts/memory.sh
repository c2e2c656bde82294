#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs every kind of command under valgrind, which finds memory that is read before it is written.
# What it does not know, AVX-512, the program does not choose there; so the results, which have to
# be those of the program as it is, also hold one vector width against another.
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
