#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures maps between solids: a row for each pair of poses that have the same faces.

usage: solid_maps.py STARGUARD [--shared FOLDER] [--samples-only] [--vertices N] [--only WORD]
       solid_maps.py STARGUARD --animals

Pairs: the first pose of each sample to each of its others, and poses/ of the shared data. Columns:
tetrahedra; pieces, and pieces of A and of B alone; mean and worst ratio of singular values; whether
`verify` accepts the map; processor seconds. A pair that is refused has the reason instead.

With --animals: different animals, without landmarks. B is then met in A's faces: `verify` is asked with
A's faces at the images of its vertices, and two columns tell how many of these are off B in A's faces, and
by how many per cent of the diagonal.
"""
import argparse
import functools
import itertools
import os
import subprocess
import tempfile

import morph


@functools.cache
def pieces_alone(program, folder, model):
    report = morph.run(program, "decompose", model, "-o", os.path.join(folder, "pieces.vtk"))
    return len(report["pieces"])


def measure(program, folder, files):
    out = os.path.join(folder, "map.vtu")
    try:
        report, seconds = morph.seconds(program, "map", "--solid", *files, "-o", out)
    except SystemExit as error:
        return [str(error).split(": ", 1)[1]]
    verified = subprocess.run([program, "verify", *files, out, "--quiet"], check=False,
                              capture_output=True).returncode == 0
    distortion = report["distortion"]
    return [report["tetrahedra"], report["pieces"],
            *(pieces_alone(program, folder, file) for file in files), f"{distortion['mean']:.2f}",
            f"{distortion['worst']:.1f}", "yes" if verified else "no", f"{seconds:.1f}"]


def image_of(model, map_file, out):
    """Writes A's faces at the images of its vertices, which come first in a map."""
    with open(map_file, encoding="ascii") as file:
        text = file.read()
    images = text.split('Name="image"', 1)[1].split(">", 1)[1].split("<", 1)[0].split()
    with open(model, encoding="ascii") as file:
        lines = file.read().split("\n")
    count = int(lines[1].split()[0])
    lines[2:2 + count] = [" ".join(images[3 * v:3 * v + 3]) for v in range(count)]
    with open(out, "w", encoding="ascii") as file:
        file.write("\n".join(lines))


def measure_animals(program, folder, files):
    out, image = (os.path.join(folder, name) for name in ("map.vtu", "image.off"))
    try:
        report, seconds = morph.seconds(program, "map", "--solid", *files, "--connectivity", "a", "-o", out)
    except SystemExit as error:
        return [str(error).split(": ", 1)[1]]
    image_of(files[0], out, image)
    verified = subprocess.run([program, "verify", files[0], image, out, "--quiet"], check=False,
                              capture_output=True).returncode == 0
    distortion, surface = report["distortion"], report["surface"]
    return [report["tetrahedra"], report["pieces"],
            *(pieces_alone(program, folder, file) for file in files), f"{distortion['mean']:.2f}",
            f"{distortion['worst']:.0f}", surface["strayed"], f"{100 * surface['farthest']:.2g}",
            "yes" if verified else "no", f"{seconds:.1f}"]


# Names and numbers of vertices.
ANIMALS = [(("dog", 2000), ("cat", 2000)), (("cat", 2000), ("dog", 2000)),
           (("horse", 2000), ("cat", 2000)), (("cat", 4000), ("horse", 2000)),
           (("dog", 4000), ("cat", 2000))]


def animals(program, folder):
    for pair in ANIMALS:
        files = []
        for name, vertices in pair:
            files.append(os.path.join(folder, f"{name}_{vertices}.off"))
            morph.run(program, "sample", name, "--vertices", str(vertices), "-o", files[-1])
        yield " to ".join(f"{name} {vertices:,}" for name, vertices in pair), files


def pairs(arguments, folder):
    for name, poses in [(name, 5) for name in morph.SAMPLES] + [("torus", 3), ("eight", 3)]:
        files = [os.path.join(folder, f"{name}_{pose}.off") for pose in range(poses)]
        for pose, file in enumerate(files):
            morph.run(arguments.starguard, "sample", name, "--pose", str(pose), "--vertices",
                      str(arguments.vertices), "-o", file)
        for pose in range(1, poses):
            yield f"{name} 0 {pose}", [files[0], files[pose]]
    poses = os.path.join(arguments.shared, "data", "poses")
    names = sorted(os.listdir(poses)) if os.path.isdir(poses) and not arguments.samples_only else []
    for a, b in itertools.combinations(names, 2):
        if a.split("_")[0] == b.split("_")[0]:
            yield f"{a[:-4]} {b[:-4]}", [os.path.join(poses, file) for file in (a, b)]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("starguard")
    parser.add_argument("--shared", default="../shared")
    parser.add_argument("--samples-only", action="store_true")
    parser.add_argument("--vertices", type=int, default=2000)
    parser.add_argument("--animals", action="store_true", help="pairs of different animals")
    parser.add_argument("--only", default="", help="pairs whose names hold this word")
    arguments = parser.parse_args()
    program = arguments.starguard
    off = " off B | per cent |" if arguments.animals else ""
    print(f"| pair | tetrahedra | pieces | A | B | mean | worst |{off} verified | s |")
    print("|---" + "|--:" * (off.count("|") + 6) + "|---|--:|")
    with tempfile.TemporaryDirectory() as folder:
        listed = animals(program, folder) if arguments.animals else pairs(arguments, folder)
        for name, files in listed:
            if arguments.only in name:
                row = (measure_animals if arguments.animals else measure)(program, folder, files)
                print(f"| {name} | " + " | ".join(str(value) for value in row) + " |", flush=True)


if __name__ == "__main__":
    main()
