#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Draws the skeletons of the bundled samples, and those of plain solids, on two contact sheets (needs
# ImageMagick's montage).
#   scripts/skeleton-sheet.sh [STARGUARD] [SAMPLES.png] [PLAIN.png]
set -eu
starguard=${1:-build/starguard}
samples=${2:-docs/pictures/skeletons.png}
plain=${3:-docs/pictures/plain-skeletons.png}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# draw NAME [OPTION...]: the skeleton of a model
draw() {
    name=$1
    shift
    "$starguard" skeleton "$work/$name.off" -o "$work/$name.obj" --picture "$work/$name.png" --quiet "$@"
}

# tile SHEET [MONTAGE'S OPTION...]
tile() {
    sheet=$1
    shift
    montage "$@" -trim +repage -resize 400x300 -tile 4x -geometry 400x300+6+6 -background white \
        -font "$(fc-match -f "%{file}" sans-serif)" -pointsize 20 -depth 8 "PNG24:$sheet"
}

pictures=
for name in horse dog cat giraffe dinosaur bird human octopus knot torus star gallery; do
    "$starguard" sample "$name" -o "$work/$name.off" --quiet
    draw "$name" --nodes 200
    pictures="$pictures -label $name $work/$name.png"
done
# shellcheck disable=SC2086
tile "$samples" $pictures

pictures=
for name in $(python3 -B - "$work" <<'EOF'
import sys
sys.path.insert(0, "tests/cli")
import plain_solids
drawn = {}
for solid in plain_solids.bases():  # the last of each kind, which are the thickest and the finest
    drawn[solid.kind] = solid
for kind in ["cylinder", "cone", "capsule", "vase", "torus", "bulge", "bend", "helix", "T", "frame", "six", "branching"]:
    drawn[kind].write(f"{sys.argv[1]}/{kind}.off")
    print(kind)
EOF
); do
    draw "$name"
    pictures="$pictures $work/$name.png"
done
# shellcheck disable=SC2086
tile "$plain" $pictures
