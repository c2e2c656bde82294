#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The main commands on a bundled sample: generates a solid, places guards, cuts it into pieces, verifies
# both, and writes a picture and a page.
# Usage: demo.sh BUILD
set -eu
starguard=$1/starguard
mkdir -p demo
"$starguard" sample horse --vertices 5000 -o demo/horse.off
"$starguard" guard demo/horse.off -o demo/guards.json --picture demo/guards.png
"$starguard" decompose demo/horse.off -o demo/pieces.vtk --report demo/pieces.json --effort 2000
"$starguard" verify demo/horse.off demo/guards.json demo/pieces.vtk demo/pieces.json
echo
if "$starguard" view demo/guards.json demo/pieces.vtk demo/pieces.json -o demo/horse.html; then
    echo "Open demo/horse.html in a browser: guards, what they see, and star-shaped pieces."
fi
echo "Look at demo/guards.png; the guards stand in demo/guards.json, the pieces in demo/pieces.vtk."
