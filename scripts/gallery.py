#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Makes docs/gallery.md: a dozen results, each with its picture, the command and what to notice.

    gallery.py [STARGUARD [NAME...]]

Every command runs as it stands on the page; its numbers come from what it prints, and the picture
from the same run, so that they agree. With NAMEs only those are made anew.
"""
import html
import os
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PICTURES = os.path.join(ROOT, "docs", "pictures", "gallery")
HEAD = """# Gallery

A dozen results, all of samples: `starguard sample NAME -o NAME.off` writes them. Numbers and pictures
are of the same runs (`scripts/gallery.py` makes this page). To look at a result from all sides use
`starguard view`.
"""

#: Name, title, preparations, the command, what to notice. {word} in the last is the number that stands
#: in the output after `word`, or the words of its line.
ENTRIES = [
    ("guards", "A hall that four walls of niches make hard to watch", ["sample gallery -o gallery.off"],
     "guard gallery.off -o guards.json --picture guards.png",
     "{guards} guards see every face of the hall. The lower bound is {lower bound}: if both agree, no fewer of the "
     "candidates would do."),
    ("cameras", "Five cameras", ["sample gallery --vertices 1000 -o gallery.off"],
     "guard gallery.off --max-guards 5 --cone 90 -o cameras.json --picture cameras.png",
     "Cameras see 90 degrees, not all around. The command asks for the best five, and bounds what any five of the "
     "candidates can see; red is what stays unseen by these."),
    ("one", "What one guard sees", ["sample gallery --vertices 1000 -o gallery.off"],
     "guard gallery.off --max-guards 1 -o guard.json --picture guard.png",
     "The best place for a single guard, and in red what it does not see: the niches, and strips behind the columns."),
    ("horse", "A horse", ["sample horse -o horse.off"],
     "guard horse.off -o guards.json --picture guards.png",
     "{guards} guards, with a lower bound of {lower bound} for the candidates. They stand in the trunk, the head, the tail "
     "and the legs, two in each bent hind leg."),
    ("skeleton", "The curve skeleton of an octopus", ["sample octopus -o octopus.off"],
     "skeleton octopus.off -o octopus.obj --picture octopus.png",
     "Guards are first sought on this curve. It has a branch for each arm, and its nodes know the radius of the solid "
     "around them."),
    ("office", "An office building",
     ["sample office --vertices 1000 -o office.off"],
     "guard office.off --orientation keep --fov 100,70 --range 10 --coverage 0.9 -o office.json --picture office.png",
     "Furniture stands in the rooms as it does in a model of a building, and every surface counts. Cameras of 100 by 70 "
     "degrees that reach 10 metres see nine tenths of it; red is the rest."),
    ("scan", "Scanning a part from outside", ["sample plate --vertices 1000 -o part.off"],
     "guard part.off --outside --standoff 1,3 -o scan.json --picture scan.png",
     "Guards stand outside, between 1 and 3 units from the part: places for a scanner."),
    ("pieces", "Star-shaped pieces of a horse", ["sample horse -o horse.off"],
     "decompose horse.off -o pieces.vtk --picture pieces.png",
     "{pieces} pieces, {star-shaped} star-shaped: each is seen as a whole by a guard inside it, which is proven. Cuts run "
     "where one part begins to hide from another: at tail, neck and legs."),
    ("paper", "The method of the paper", ["sample dog --vertices 1500 -o dog.off"],
     "decompose dog.off --mode paper -o pieces.vtk --picture pieces.png",
     "Pieces grow from guards over tetrahedra, as in the paper: {pieces} pieces, of which {star-shaped} are star-shaped in the "
     "strict sense. Seams are ragged where tetrahedra are taken one by one; the default mode cuts planes."),
    ("describe", "What a dog is, to a database", ["sample dog --vertices 2000 -o dog.off"],
     "describe dog.off -o dog.json --picture dog.png",
     "A descriptor holds the guards of a quick decomposition, what each of them sees in all directions, and which are "
     "neighbours."),
    ("matrix", "Distances of eighteen animals",
     [f"sample {animal} --pose {pose} --vertices 500 -o {animal}_{pose}.off"
      for animal in ("bird", "cat", "dog", "giraffe", "horse", "human") for pose in (0, 1, 2)]
     + ["db create shapes.db", "db add shapes.db bird_0.off bird_1.off bird_2.off cat_0.off cat_1.off cat_2.off "
        "dog_0.off dog_1.off dog_2.off giraffe_0.off giraffe_1.off giraffe_2.off horse_0.off horse_1.off horse_2.off "
        "human_0.off human_1.off human_2.off"],
     "db matrix shapes.db -o matrix.csv --picture matrix.png",
     "Three poses of each of six animals, in the order of their names; black is similar. The blocks along the diagonal are "
     "poses of one animal."),
    ("morph", "A horse changes its pose",
     ["sample horse --pose 0 --vertices 2000 -o a.off", "sample horse --pose 2 --vertices 2000 -o b.off"],
     "morph a.off b.off --frames 5 -o frames --picture morph.png",
     "A row for each method: `star` matches guards of both poses and turns the pieces around them as wholes, `arap` keeps "
     "triangles as rigid as possible, `linear` moves vertices along straight lines, which shortens legs on their way."),
]


def number(output, word):
    """The word that follows a label in the lines of the command."""
    line = re.search(rf"^{re.escape(word)} +(\d+)", output, flags=re.MULTILINE)
    if line is None:
        sys.exit(f"gallery.py: no {word!r} in:\n{output}")
    return line[1]


def run(program, words, folder):
    done = subprocess.run([program, *words.split()], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"gallery.py: {words}: status {done.returncode}\n{done.stderr}")
    return done.stdout


def entry(program, name, title, before, command, notice):
    """Makes the picture; the section of the page."""
    with tempfile.TemporaryDirectory(prefix="starguard-gallery-") as folder:
        for words in before:
            run(program, words, folder)
        output = run(program, command, folder)
        picture = re.search(r"--picture (\S+)", command)[1]
        os.makedirs(PICTURES, exist_ok=True)
        os.replace(shrunk(os.path.join(folder, picture)), os.path.join(PICTURES, f"{name}.png"))
    text = re.sub(r"\{([^}]+)\}", lambda match: number(output, match[1]), notice)
    files = {word for word in command.split() if word.endswith(".off")}
    first = [words for words in before if words.split()[-1] in files and not words.startswith("db")]
    shown = "\n".join(f"starguard {words}" for words in [*first, command])
    wrapped = textwrap.fill(text, 110, break_on_hyphens=False)
    return (f"## {title}\n\n![{html.escape(title)}](pictures/gallery/{name}.png)\n\n"
            f"<!-- not run: by gallery.py -->\n```sh\n{shown}\n```\n\n{wrapped}\n")


def shrunk(path):
    """Trimmed and at most 900 wide, in full colour."""
    subprocess.run(["convert", path, "-trim", "+repage", "-bordercolor", "white", "-border", "10", "-resize", "900x700>",
                    "-depth", "8", "-strip", f"PNG24:{path}"], check=True)
    return path


def sections_of_page(path):
    """The sections that the page has, by title."""
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        parts = re.split(r"^## ", file.read(), flags=re.MULTILINE)[1:]
    return {part.split("\n", 1)[0]: f"## {part.rstrip()}\n" for part in parts}


def main(program="build/starguard", *names):
    if shutil.which("convert") is None:
        sys.exit("gallery.py: trims pictures by ImageMagick; install it (apt-get install imagemagick)")
    program = os.path.abspath(program)
    path = os.path.join(ROOT, "docs", "gallery.md")
    for row in ENTRIES:
        if not names or row[0] in names:
            print(row[0], flush=True)
            made = entry(program, *row)
            sections = sections_of_page(path)
            sections[row[1]] = made
            with open(path, "w", encoding="utf-8") as file:
                file.write("\n".join([HEAD, *(sections[title] for _, title, *_ in ENTRIES if title in sections)]))


if __name__ == "__main__":
    main(*sys.argv[1:])
