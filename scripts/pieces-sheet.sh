#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Draws the star pieces of the bundled samples, as they come, on one contact sheet in full colour (needs
# ImageMagick's montage). The README tells the number of pieces of the horse.
#   scripts/pieces-sheet.sh [STARGUARD] [SHEET.png]
set -eu
starguard=${1:-build/starguard}
sheet=${2:-docs/pictures/pieces.png}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
set --
for name in horse dog cat giraffe dinosaur bird human octopus knot plate l-room labyrinth; do
    "$starguard" sample "$name" -o "$work/$name.off" --quiet
    "$starguard" decompose "$work/$name.off" -o "$work/$name.vtk" \
        --picture "$work/$name.png" --json >"$work/$name.json"
    pieces=$(python3 -c 'import json, sys; print(len(json.load(sys.stdin)["pieces"]))' \
        <"$work/$name.json")
    set -- "$@" -label "$name: $pieces" "$work/$name.png"
done
montage "$@" -trim +repage -resize 400x300 -tile 4x -geometry 400x300+6+6 -background white \
    -font "$(fc-match -f "%{file}" sans-serif)" \
    -pointsize 20 -depth 8 "PNG24:$sheet"
