#!/bin/sh
# The main job on a bundled sample: makes the solid, guards it, checks the result, draws it.
# Usage: demo.sh BUILD
set -eu
starguard=$1/starguard
mkdir -p demo
"$starguard" sample horse --vertices 5000 -o demo/horse.off
"$starguard" guard demo/horse.off -o demo/guards.json --picture demo/guards.png
"$starguard" verify demo/horse.off demo/guards.json
echo
echo "Look at demo/guards.png; the guards stand in demo/guards.json."
