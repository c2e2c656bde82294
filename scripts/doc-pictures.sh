#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Draws the pictures of docs/ that show results of the command line: guards of four samples, what one guard
# sees, a morph by three methods, distances of shapes; and those of the tutorials, by their own commands. All from
# samples. Needs ImageMagick. Usage: doc-pictures.sh [STARGUARD]
set -eu
starguard=$(readlink -f "${1:-build/starguard}")
docs=$(cd "$(dirname "$0")/../docs" && pwd)
pictures=$docs/pictures
scratch=$(mktemp -d "${TMPDIR:-/tmp}/starguard-pictures.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"

keep() {
    convert "$1" -trim +repage -bordercolor white -border 12 -resize "$2" -depth 8 "PNG24:$pictures/$1"
}

for name in horse human octopus gallery; do
    "$starguard" sample $name -o $name.off
    "$starguard" guard $name.off -o $name.json --picture $name.png
done
montage horse.png human.png octopus.png gallery.png -trim +repage -resize 800x600 -tile 2x2 \
    -geometry 800x600+12+12 -background white guards.png
keep guards.png 1200x

"$starguard" sample gallery --vertices 3000 -o gallery.off
"$starguard" guard gallery.off --max-guards 1 -o guard.json --picture visibility.png
keep visibility.png 900x

for pose in 0 2; do
    "$starguard" sample horse --pose $pose --vertices 2000 -o morph_$pose.off
done
"$starguard" morph morph_0.off morph_2.off --frames 5 -o frames --picture morph.png
keep morph.png 1200x

mkdir shapes
for animal in bird cat dog giraffe horse human; do
    for pose in 0 1 2; do
        "$starguard" sample $animal --pose $pose --vertices 1000 -o shapes/${animal}_$pose.off
    done
done
"$starguard" db create shapes.db
"$starguard" db add shapes.db shapes/*.off
"$starguard" db matrix shapes.db -o matrix.csv --picture matrix.png --distance star
cp matrix.png "$pictures"

PATH=$(dirname "$starguard"):$PATH
for page in room level part; do
    sed -n '/^```sh$/,/^```$/{/^```/!p}' "$docs/tutorials/$page.md" >$page.sh
    sh -e $page.sh
    keep $page.png 800x
    mv "$pictures/$page.png" "$pictures/tutorials/"
done
