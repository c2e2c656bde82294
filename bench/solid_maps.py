#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures maps between solids: a row for each pair of poses that have the same faces.

usage: solid_maps.py STARGUARD [--shared FOLDER] [--samples-only] [--vertices N] [--only WORD]

Pairs: the first pose of each sample to each of its others, and poses/ of the shared data. Columns:
tetrahedra; pieces, and pieces of A and of B alone; mean and worst ratio of singular values; whether
`verify` accepts the map; processor seconds. A map that `verify` refuses, as faces of the poses differ, is made again with
--overlay. A pair that is refused has the reason instead.
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
    for overlay in [], ["--overlay"]:
        try:
            report, seconds = morph.seconds(program, "map", "--solid", *files, "-o", out, *overlay)
        except SystemExit as error:
            return [str(error).split(": ", 1)[1]]
        verified = subprocess.run([program, "verify", *files, out, "--quiet"], check=False,
                                  capture_output=True).returncode == 0
        if verified:
            break
    distortion = report["distortion"]
    return [report["tetrahedra"], report["pieces"],
            *(pieces_alone(program, folder, file) for file in files), f"{distortion['mean']:.2f}",
            f"{distortion['worst']:.1f}", " ".join(["yes", *overlay]) if verified else "no", f"{seconds:.1f}"]


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
    parser.add_argument("--only", default="", help="pairs whose names hold this word")
    arguments = parser.parse_args()
    print("| pair | tetrahedra | pieces | A | B | mean | worst | verified | s |")
    print("|---|--:|--:|--:|--:|--:|--:|---|--:|")
    with tempfile.TemporaryDirectory() as folder:
        for name, files in pairs(arguments, folder):
            if arguments.only in name:
                row = measure(arguments.starguard, folder, files)
                print(f"| {name} | " + " | ".join(str(value) for value in row) + " |", flush=True)


if __name__ == "__main__":
    main()
