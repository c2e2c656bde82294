#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Strict pieces of random solids, which are made by their number: a table of what went wrong, and sums.

usage: stress.py STARGUARD [--first N] [--count N] [--effort N] [--keep FOLDER]

Five kinds in turn. csg: two to four samples, turned, stretched and placed at random, some inside out, their union
(`repair --union`), which makes the others holes. organic: a figure with waves in it. voxels: cubes of a grid, that meet in
faces, edges and vertices. thin: a sample pressed flat, or pulled long, by up to a million. crossing: samples that run
through one another as they are. What bounds no solid as it is (cubes that meet in an edge) is repaired first. A solid that
`check` calls embedded must keep its surface; all must pass `verify`. Status 1 if one does not. FOLDER gets the models that
fail.
"""
import argparse
import json
import math
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile

RIGID = ("l-room", "gallery", "labyrinth", "plate", "knot", "torus", "star", "shell", "sphere")
FIGURES = ("horse", "dog", "cat", "giraffe", "dinosaur", "bird", "human", "octopus")
KINDS = ("csg", "organic", "voxels", "thin", "crossing")


def run(options, *words):
    done = subprocess.run([options.starguard, *words, "--quiet"], capture_output=True, check=False, text=True)
    return done.returncode, done.stdout, done.stderr


# ---- meshes: a list of points, a list of faces ----

def read(path):
    with open(path, encoding="ascii") as file:
        words = file.read().split()
    points, faces = int(words[1]), int(words[2])
    numbers = list(map(float, words[4:4 + 3 * points]))
    corners = list(map(int, words[4 + 3 * points:]))
    return ([numbers[i:i + 3] for i in range(0, 3 * points, 3)],
            [corners[i + 1:i + 4] for i in range(0, 4 * faces, 4)])


def write(path, mesh):
    with open(path, "w", encoding="ascii") as file:
        file.write(f"OFF\n{len(mesh[0])} {len(mesh[1])} 0\n")
        for point in mesh[0]:
            file.write(" ".join(map(repr, point)) + "\n")
        for face in mesh[1]:
            file.write("3 " + " ".join(map(str, face)) + "\n")


def sample(options, rng, folder, names, most):
    path = os.path.join(folder, "sample.off")
    name = rng.choice(names)
    words = ["sample", name, "-o", path, "--vertices", str(rng.randrange(500, most))]
    if name in FIGURES:
        words += ["--pose", str(rng.randrange(5))]
    status, _, told = run(options, *words)
    if status:
        sys.exit(told)
    points, faces = read(path)
    low = [min(point[k] for point in points) for k in range(3)]
    high = [max(point[k] for point in points) for k in range(3)]
    size = max(high[k] - low[k] for k in range(3))
    return [[(point[k] - (low[k] + high[k]) / 2) / size for k in range(3)] for point in points], faces


def turned(rng, points):
    """By a random rotation."""
    while True:
        w, x, y, z = (rng.uniform(-1, 1) for _ in range(4))
        square = w * w + x * x + y * y + z * z
        if 0.01 < square < 1:
            break
    s = 2 / square
    rows = ((1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)),
            (s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)),
            (s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)))
    return [[sum(row[k] * point[k] for k in range(3)) for row in rows] for point in points]


def together(options, rng, folder, may_subtract):
    points, faces = [], []
    for number in range(rng.randrange(2, 5)):
        more, corners = sample(options, rng, folder, RIGID + FIGURES, 700)
        sizes = [rng.uniform(.4, 1.2) for _ in range(3)]
        more = turned(rng, [[point[k] * sizes[k] for k in range(3)] for point in more])
        place = [rng.uniform(-.3, .3) if number else 0 for _ in range(3)]
        inside_out = may_subtract and number > 0 and rng.random() < .5
        first = len(points)
        points += [[point[k] + place[k] for k in range(3)] for point in more]
        faces += [[first + c for c in (face[::-1] if inside_out else face)] for face in corners]
    return points, faces


def csg(options, rng, folder):
    path = os.path.join(folder, "before.off")
    write(path, together(options, rng, folder, True))
    status, _, _ = run(options, "repair", path, "-o", os.path.join(folder, "union.off"), "--union")
    return None if status else read(os.path.join(folder, "union.off"))


def crossing(options, rng, folder):
    return together(options, rng, folder, False)


def organic(options, rng, folder):
    points, faces = sample(options, rng, folder, FIGURES + ("sphere", "torus", "knot"), 1500)
    waves = [([rng.uniform(-1, 1) * 10 ** rng.uniform(0, 1.5) for _ in range(3)], rng.uniform(0, 6.3),
              [rng.uniform(-1, 1) for _ in range(3)]) for _ in range(6)]
    for point in points:
        move = [0, 0, 0]
        for along, phase, way in waves:
            steep = math.sqrt(sum(a * a for a in along))
            height = .25 / steep * math.sin(sum(along[k] * point[k] for k in range(3)) + phase)
            move = [move[k] + height * way[k] for k in range(3)]
        for k in range(3):
            point[k] += move[k]
    return points, faces


def voxels(_options, rng, _folder):
    """Faces between a cube that is there and one that is not; each vertex of the grid once."""
    n, share = rng.randrange(2, 6), rng.uniform(.3, .8)
    full = {(x, y, z) for x in range(n) for y in range(n) for z in range(n) if rng.random() < share} or {(0, 0, 0)}
    numbers, faces = {}, []
    for cube in sorted(full):
        for axis in range(3):
            for high in range(2):
                beyond = list(cube)
                beyond[axis] += 2 * high - 1
                if tuple(beyond) in full:
                    continue
                ring = []
                for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    at = list(cube)
                    at[axis] += high
                    at[(axis + 1) % 3] += du
                    at[(axis + 2) % 3] += dv
                    ring.append(numbers.setdefault(tuple(at), len(numbers)))
                ring = ring if high else ring[::-1]
                faces += [ring[:3], [ring[0], ring[2], ring[3]]]
    return [list(map(float, at)) for at in numbers], faces


def thin(options, rng, folder):
    points, faces = sample(options, rng, folder, RIGID + FIGURES, 800)
    way, factor = rng.randrange(3), 10 ** rng.uniform(-6, 3)
    for point in points:
        point[way] *= factor
    return points, faces


# ---- trials ----

def is_embedded(report):
    """Closed, and faces meet in common edges and vertices only."""
    found = report["findings"]
    return report["usable"] and all(found.get(kind, {}).get("count", 0) == 0
                                    for kind in ("self_intersections", "self_contacts", "degenerate_faces"))


def check(options, model):
    return json.loads(run(options, "check", model, "--json")[1])


def make_usable(options, model, folder):
    """What `check` says of the model, which is repaired if it bounds no solid."""
    checked, repaired = check(options, model), os.path.join(folder, "repaired.off")
    if not checked["usable"] and run(options, "repair", model, "-o", repaired)[0] == 0:
        shutil.move(repaired, model)
        checked = check(options, model)
    return checked


def trial(options, number, folder):
    """The kind, what went wrong or None, whether the surface is embedded, is kept; pieces."""
    rng = random.Random(number)
    kind = KINDS[number % len(KINDS)]
    model, grid, report = (os.path.join(folder, name) for name in ("m.off", "p.vtk", "p.json"))
    mesh = globals()[kind](options, rng, folder)
    if mesh is None:
        return kind, None, False, False, 0
    write(model, mesh)
    checked = make_usable(options, model, folder)
    if not checked["usable"]:
        return kind, None, False, False, 0
    embedded = is_embedded(checked)
    status, _, told = run(options, "decompose", model, "-o", grid, "--report", report, "--effort", str(options.effort))
    if status:
        return kind, f"decompose: status {status}: {told.strip().splitlines()[-1]}", embedded, False, 0
    with open(report, encoding="utf-8") as file:
        result = json.load(file)
    kept, wrong = result["surface"] == "kept", None
    status, _, told = run(options, "verify", model, grid, report)
    if status:
        wrong = f"verify: status {status}: {told.strip().splitlines()[-1] if told.strip() else ''}"
    elif embedded and not kept:
        wrong = "embedded, but approximated"
    elif not kept and "faces_kept" not in result:
        wrong = "filled by a lattice"
    return kind, wrong, embedded, kept, len(result["pieces"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("starguard")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--effort", type=int, default=20)
    parser.add_argument("--keep")
    options = parser.parse_args()
    sums = {kind: [0] * 6 for kind in KINDS}
    print("| number | kind | what went wrong |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for number in range(options.first, options.first + options.count):
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            kind, wrong, embedded, kept, pieces = trial(options, number, folder)
            spent = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
            sums[kind] = [a + b for a, b in zip(sums[kind], (pieces > 0, embedded, kept, wrong is not None, pieces, spent))]
            if wrong is not None:
                print(f"| {number} | {kind} | {wrong} |", flush=True)
                if options.keep:
                    os.makedirs(options.keep, exist_ok=True)
                    shutil.copy(os.path.join(folder, "m.off"), os.path.join(options.keep, f"{number}.off"))
    print("\n| kind | solids | embedded | kept | wrong | pieces | seconds |\n|---|--:|--:|--:|--:|--:|--:|")
    for kind, row in sums.items():
        print(f"| {kind} | " + " | ".join(map(str, row[:5])) + f" | {row[5]:.0f} |")
    sys.exit(any(row[3] for row in sums.values()))


if __name__ == "__main__":
    main()
