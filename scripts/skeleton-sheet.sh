#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Draws the skeletons of the bundled samples on one contact sheet (needs ImageMagick's montage).
#   scripts/skeleton-sheet.sh [STARGUARD] [SHEET.png]
set -eu
starguard=${1:-build/starguard}
sheet=${2:-docs/pictures/skeletons.png}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
pictures=
for name in horse dog cat giraffe dinosaur bird human octopus knot torus star gallery; do
    "$starguard" sample "$name" -o "$work/$name.off" --quiet
    "$starguard" skeleton "$work/$name.off" -o "$work/$name.obj" --nodes 200 \
        --picture "$work/$name.png" --quiet
    pictures="$pictures -label $name $work/$name.png"
done
# shellcheck disable=SC2086
montage $pictures -trim +repage -resize 400x300 -tile 4x -geometry 400x300+6+6 -background white \
    -font "$(fc-match -f "%{file}" sans-serif)" \
    -pointsize 20 -depth 8 "PNG24:$sheet"
