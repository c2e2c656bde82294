#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures overlays: a row for each pair of bench/morph.py, and human and octopus.

usage: overlays.py STARGUARD [--shared FOLDER] [--samples-only] [--only WORD]

Columns: faces of A, of B, and of the overlay; pairs of faces that intersect in A, in B, in the last frame
with the faces of A, and in the first and the last frame with those of the overlay; whether `verify`
accepts the map and the frames; processor seconds of the map without and with the overlay.
"""
import argparse
import os
import subprocess
import tempfile

import morph


def intersections(program, model):
    report = morph.run(program, "check", model)
    return report["findings"].get("self_intersections", {}).get("count", 0)


def measure(arguments, folder, files, landmarks):
    program, out = arguments.starguard, os.path.join(folder, "map.json")
    frames = os.path.join(folder, "frames")
    _, plain = morph.seconds(program, "map", *files, *landmarks, "-o", out)
    last = morph.run(program, "morph", *files, "--map", out, "--frames", "2", "--method", "linear",
                     "-o", frames)["frames"][-1]["intersections"]
    _, both = morph.seconds(program, "map", *files, *landmarks, "--overlay", "-o", out)
    report = morph.run(program, "morph", *files, "--map", out, "--overlay", "--frames", "2", "--report",
                       "--method", "linear", "-o", frames)
    verified = subprocess.run([program, "verify", *files, out, frames, "--quiet"], check=False,
                              capture_output=True).returncode == 0
    faces = [morph.run(program, "check", file)["model"]["faces"] for file in files]
    return [*faces, report["overlay"]["faces"], *(intersections(program, file) for file in files), last,
            *(frame["intersections"] for frame in report["frames"]), "yes" if verified else "no",
            f"{plain:.1f}", f"{both:.1f}"]


def pairs(arguments, folder):
    for name in morph.SAMPLES:
        files = [os.path.join(folder, f"{name}_{pose}.off") for pose in (0, 1)]
        for pose, file in enumerate(files):
            morph.run(arguments.starguard, "sample", name, "--pose", str(pose), "-o", file)
        yield name, files
    data = os.path.join(arguments.shared, "data")
    for kind, names in ("poses", morph.POSES), ("tosca_paper", morph.ANIMALS):
        for a, b in names if os.path.isdir(data) and not arguments.samples_only else []:
            yield f"{a} {b}", [os.path.join(data, kind, f + ".off") for f in (a, b)]
    for name in "human", "octopus":
        morph.run(arguments.starguard, "sample", name, "--vertices", "3000", "-o",
                  os.path.join(folder, f"{name}.off"))
    yield "human octopus", [os.path.join(folder, f"{name}.off") for name in ("human", "octopus")]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("starguard")
    parser.add_argument("--shared", default="../shared")
    parser.add_argument("--samples-only", action="store_true")
    parser.add_argument("--only", default="", help="pairs whose names hold this word")
    arguments = parser.parse_args()
    print("| pair | A | B | overlay | A | B | B in A's faces | first | last | verified | map s | with s |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|--:|---|--:|--:|")
    with tempfile.TemporaryDirectory() as folder:
        for name, files in pairs(arguments, folder):
            if arguments.only not in name:
                continue
            marks = os.path.join(morph.LANDMARKS, name.replace(" ", "_") + ".txt")
            words = ["--landmarks", marks] if os.path.exists(marks) else []
            row = measure(arguments, folder, files, words)
            print(f"| {name} | " + " | ".join(str(value) for value in row) + " |", flush=True)


if __name__ == "__main__":
    main()
