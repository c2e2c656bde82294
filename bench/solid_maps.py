#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures maps between solids: a table for each kind of pairs. Without options the first three.

usage: solid_maps.py STARGUARD [--plain] [--animals VERTICES] [--poses VERTICES] [--balls N] [--mixed N]
                               [--only WORD] [--turned SEED] [--detail N] [--shared FOLDER]

--plain: the 90 ordered pairs of ten plain star-shaped solids (tests/cli/star_solids.py), mapped by `map --solid` and
morphed by `morph --method solid`; columns: tetrahedra; pieces; mean and worst ratio of singular values; keys of the
morph; whether `verify` accepts map and morph; processor seconds of `map` and of `morph`.
--animals: the 56 ordered pairs of eight samples of about so many vertices, and the same to the ball and the cube; median
is the ratio that half of A's volume is below, above 10 a share of that volume.
--poses: the first pose of each sample to its others, which have the same faces, and poses/ of the shared data; pieces of
the map, and of A and of B alone.
--balls: N random pairs of other plain solids without holes, trees of cubes, spiked prisms, combs and piles of rings;
--mixed: of the same and knotted bars, and in two of three places a sample of 300 to 3,000 vertices.
Every result is verified against B. A pair that is refused has the reason instead. The last row counts.
"""
import argparse
import functools
import itertools
import json
import math
import os
import random
import resource
import subprocess
import sys
import tempfile

import morph

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "cli"))
import plain_solids as plain  # noqa: E402  pylint: disable=wrong-import-position
import star_solids  # noqa: E402  pylint: disable=wrong-import-position

FIGURES = [*morph.SAMPLES, "vase", "bust", "table", "tool"]
SOLID_SAMPLES = [*FIGURES, "polycube", "maze", "comb", "spikes", "l-room", "labyrinth", "star", "sphere"]


def spent():
    """Processor time of all children."""
    return sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])


def attempt(program, files, out, *words):
    """The report or None, the reason, whether it is verified, and seconds."""
    before = spent()
    try:
        report = morph.run(program, *words)
    except SystemExit as error:
        return None, str(error).split(": ", 1)[1], False, spent() - before
    seconds = spent() - before
    verified = subprocess.run([program, "verify", *files, out, "--quiet"], check=False,
                              capture_output=True).returncode == 0
    return report, "yes" if verified else "no", verified, seconds


def measure(program, folder, files):
    out, path = os.path.join(folder, "map.vtu"), os.path.join(folder, "path.vtu")
    mapped, map_words, map_holds, map_seconds = attempt(program, files, out, "map", "--solid", *files, "-o", out)
    path_report, path_words, path_holds, path_seconds = attempt(
        program, files, path, "morph", *files, "--method", "solid", "--frames", "2", "-o",
        os.path.join(folder, "frames"), "--certificate", path)
    row = ["", "", "", ""]
    if mapped is not None:
        row = [mapped["tetrahedra"], mapped["pieces"], f"{mapped['distortion']['mean']:.2f}",
               f"{mapped['distortion']['worst']:.1f}"]
    row.append(path_report["solid"]["keys"] if path_report is not None else "")
    return [*row, map_words, path_words, f"{map_seconds:.2f}", f"{path_seconds:.2f}"], map_holds, path_holds


def random_ball(_program, rng, file):
    name, solid = star_solids.random_ball(rng)
    star_solids.write(file, solid)
    return name


def knotted_bar(rng):
    """A bar along an open trefoil knot."""
    steps, end = rng.randint(20, 60), rng.uniform(4, 5.9)
    times = [end * i / steps for i in range(steps + 1)]
    path = [[math.sin(t) + 2 * math.sin(2 * t), math.cos(t) - 2 * math.cos(2 * t), -math.sin(3 * t)] for t in times]
    return plain.tube(path, [rng.uniform(0.2, 0.4)] * len(path), rng.randint(4, 12))


def random_mixed(program, rng, file):
    """A sample without holes, a knotted bar, or a random ball."""
    listed = json.loads(subprocess.run([program, "sample", "--list", "--json"], check=True, capture_output=True).stdout)
    poses = {sample["name"]: sample["poses"] for sample in listed["samples"]}
    while rng.random() < 2 / 3:
        name = rng.choice(SOLID_SAMPLES)
        pose, size = str(rng.randrange(poses[name])), rng.randint(500 if name in FIGURES else 300, 3000)
        morph.run(program, "sample", name, "--vertices", str(size), "--pose", pose, "-o", file)
        with open(file, encoding="utf-8") as stream:
            words = stream.read().split()
        count, faces = int(words[1]), int(words[2])
        corners = list(map(int, words[4 + 3 * count:]))
        if star_solids.is_ball(range(count), [corners[4 * i + 1:4 * i + 4] for i in range(faces)]):
            return f"{name} {pose} ({count})"
    if rng.random() < 0.2:
        star_solids.write(file, knotted_bar(rng))
        return "knotted bar"
    return random_ball(program, rng, file)


def measure_random(program, folder, count, make, only):
    """Random pairs: whether they are mapped and verified, pieces, seconds."""
    print("| pair | tetrahedra | pieces | mean | worst | map | s |\n|---" + "|--:" * 4 + "|---|--:|")
    held = tried = 0
    for seed in range(count):
        rng = random.Random(seed)
        files = [os.path.join(folder, f"{which}.off") for which in "ab"]
        pair = f"{seed}: " + " to ".join([make(program, rng, file) for file in files])
        if only not in pair:
            continue
        out = os.path.join(folder, "map.vtu")
        mapped, words, holds, seconds = attempt(program, files, out, "map", "--solid", *files, "-o", out,
                                                "--time-limit", "300")
        row = ["", "", "", ""]
        if mapped is not None:
            row = [mapped["tetrahedra"], mapped["pieces"], f"{mapped['distortion']['mean']:.3g}",
                   f"{mapped['distortion']['worst']:.3g}"]
        tried += 1
        held += holds
        print(f"| {pair} | " + " | ".join(map(str, [*row, words, f"{seconds:.2f}"])) + " |", flush=True)
    print(f"| {tried} pairs | | | | | {held} | |")


def array(text, name):
    """The numbers of an array of MAP.vtu."""
    return text.split(f'Name="{name}"', 1)[1].split(">", 1)[1].split("<", 1)[0].split()


def median(file):
    """The ratio of singular values that half of A's volume is below."""
    with open(file, encoding="utf-8") as stream:
        text = stream.read()
    places = list(map(float, array(text, "Points")))
    cells = list(map(int, array(text, "connectivity")))
    sizes = []
    for i, ratio in enumerate(map(float, array(text, "ratio"))):
        a, u, v, w = (places[3 * c:3 * c + 3] for c in cells[4 * i:4 * i + 4])
        u, v, w = ([x - y for x, y in zip(q, a)] for q in (u, v, w))
        sizes.append((ratio, abs(plain.dot(u, plain.cross(v, w)))))
    half = sum(size for _, size in sizes) / 2
    for ratio, size in sorted(sizes):
        half -= size
        if half <= 0:
            return ratio
    return sizes[-1][0]


def measure_animals(program, folder, vertices, only):
    """All ordered pairs, and all to the ball and the cube."""
    print("| pair | tetrahedra | pieces | median | above 10 | map | s |\n|---" + "|--:" * 4 + "|---|--:|")
    files = {name: os.path.join(folder, f"{name}.off") for name in morph.SAMPLES}
    for name, file in files.items():
        morph.run(program, "sample", name, "--vertices", str(vertices), "-o", file)
    out, counts = os.path.join(folder, "map.vtu"), {}
    for a, b in [*itertools.permutations(files, 2), *itertools.product(files, ("ball", "cube"))]:
        name = f"{a} to {b}"
        if only not in name:
            continue
        models = [files[a], files[b]] if b in files else [files[a]]
        words = models if b in files else [*models, "--to", b]
        mapped, reason, holds, seconds = attempt(program, models, out, "map", "--solid", *words, "-o", out)
        row = ["", "", "", ""]
        if mapped is not None:
            row = [mapped["tetrahedra"], mapped["pieces"], f"{median(out):.3g}", f"{mapped['distortion']['above_10']:.2f}"]
        kind = counts.setdefault(b if b not in files else "pairs", [0, 0])
        kind[0] += 1
        kind[1] += holds
        print(f"| {name} | " + " | ".join(map(str, [*row, reason, f"{seconds:.1f}"])) + " |", flush=True)
    for kind, (count, held) in counts.items():
        print(f"| {count} {kind} | | | | | {held} | |")


@functools.cache
def pieces_alone(program, folder, model):
    report = morph.run(program, "decompose", model, "-o", os.path.join(folder, "pieces.vtk"))
    return len(report["pieces"])


def poses(program, folder, vertices, shared):
    """Names of pairs, and their files."""
    for name, count in [(name, 5) for name in morph.SAMPLES] + [("torus", 3), ("eight", 3)]:
        files = [os.path.join(folder, f"{name}_{pose}.off") for pose in range(count)]
        for pose, file in enumerate(files):
            morph.run(program, "sample", name, "--pose", str(pose), "--vertices", str(vertices), "-o", file)
        for pose in range(1, count):
            yield f"{name} 0 {pose}", [files[0], files[pose]]
    given = os.path.join(shared, "data", "poses")
    names = sorted(os.listdir(given)) if os.path.isdir(given) else []
    for a, b in itertools.combinations(names, 2):
        if a.split("_")[0] == b.split("_")[0]:
            yield f"{a[:-4]} {b[:-4]}", [os.path.join(given, file) for file in (a, b)]


def measure_poses(program, folder, vertices, shared, only):
    print("| pair | tetrahedra | pieces | A | B | mean | worst | map | s |\n|---" + "|--:" * 6 + "|---|--:|")
    tried = held = 0
    for name, files in poses(program, folder, vertices, shared):
        if only not in name:
            continue
        out = os.path.join(folder, "map.vtu")
        mapped, reason, holds, seconds = attempt(program, files, out, "map", "--solid", *files, "-o", out)
        row = [""] * 6
        if mapped is not None:
            row = [mapped["tetrahedra"], mapped["pieces"], *(pieces_alone(program, folder, file) for file in files),
                   f"{mapped['distortion']['mean']:.2f}", f"{mapped['distortion']['worst']:.1f}"]
        tried += 1
        held += holds
        print(f"| {name} | " + " | ".join(map(str, [*row, reason, f"{seconds:.1f}"])) + " |", flush=True)
    print(f"| {tried} pairs | | | | | | | {held} | |")


def measure_plain(program, folder, turned, detail, only):
    rng = random.Random(turned) if turned is not None else None
    print("| pair | tetrahedra | pieces | mean | worst | keys | map | morph | s | s |")
    print("|---" + "|--:" * 5 + "|---|---|--:|--:|")
    counts = [0, 0, 0]
    listed = star_solids.solids(rng, detail)
    for name, solid in listed:
        star_solids.write(os.path.join(folder, f"{name}.off"), solid)
    for a, b in itertools.permutations([name for name, _ in listed], 2):
        name = f"{a} to {b}"
        if only not in name:
            continue
        files = [os.path.join(folder, f"{solid}.off") for solid in (a, b)]
        row, *holds = measure(program, folder, files)
        counts = [counts[0] + 1, counts[1] + holds[0], counts[2] + holds[1]]
        print(f"| {name} | " + " | ".join(str(value) for value in row) + " |", flush=True)
    print(f"| {counts[0]} pairs | | | | | | {counts[1]} | {counts[2]} | | |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("starguard")
    parser.add_argument("--plain", action="store_true", help="90 pairs of plain star-shaped solids")
    parser.add_argument("--animals", type=int, help="pairs of samples with about so many vertices")
    parser.add_argument("--poses", type=int, help="poses of samples with about so many vertices")
    parser.add_argument("--balls", type=int, help="so many random pairs of other plain solids")
    parser.add_argument("--mixed", type=int, help="so many random pairs of samples, knotted bars and those")
    parser.add_argument("--only", default="", help="pairs whose names hold this word")
    parser.add_argument("--turned", type=int, help="turn, move and stretch the plain solids at random")
    parser.add_argument("--detail", type=int, default=1, help="finer round plain solids")
    parser.add_argument("--shared", default="../shared")
    wanted = parser.parse_args()
    if not (wanted.plain or wanted.animals or wanted.poses or wanted.balls or wanted.mixed):
        wanted.plain, wanted.animals, wanted.poses = True, 2000, 2000
    program, only = wanted.starguard, wanted.only
    with tempfile.TemporaryDirectory() as folder:
        if wanted.plain:
            measure_plain(program, folder, wanted.turned, wanted.detail, only)
        if wanted.animals:
            measure_animals(program, folder, wanted.animals, only)
        if wanted.poses:
            measure_poses(program, folder, wanted.poses, wanted.shared, only)
        if wanted.balls:
            measure_random(program, folder, wanted.balls, random_ball, only)
        if wanted.mixed:
            measure_random(program, folder, wanted.mixed, random_mixed, only)


if __name__ == "__main__":
    main()
