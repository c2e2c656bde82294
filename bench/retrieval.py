#!/usr/bin/env python3
"""How well each distance retrieves: the tables of docs/retrieval.md.

usage: retrieval.py COMMAND STARGUARD FOLDER... [--distances star,paper,shape-dna,d2]

  table    every measure for each folder of models, classes by prefix, and the paper's groups
  copies   is a model's own original the nearest, when it has been turned, scaled, moved and
           renumbered, or every vertex moved by 1 % of the mean edge at random?
  points   how close the points of a descriptor come to the surface, by their number

Tables are Markdown.
"""
import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile

MEASURES = ("nearest_neighbour", "first_tier", "second_tier", "e_measure", "dcg")
GROUPS = (("cat", "dog", "wolf"), ("david", "michael", "victoria"), ("horse", "centaur"))


def run(program, *words):
    done = subprocess.run([program, *words, "--json"], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, check=True)
    return json.loads(done.stdout)


def models(folder):
    return sorted(os.path.join(folder, n) for n in os.listdir(folder) if n.endswith(".off"))


def database(program, folder, scratch):
    name = os.path.join(scratch, os.path.basename(os.path.normpath(folder)) + ".db")
    run(program, "db", "create", name)
    run(program, "db", "add", name, *models(folder))
    return name


def row(*cells):
    print("| " + " | ".join(str(c) for c in cells) + " |", flush=True)


def head(*cells):
    row(*cells)
    row(*["---"] * len(cells))


def prefix(name):
    return os.path.splitext(name)[0].rsplit("_", 1)[0]


def group_means(program, name, distance, scratch):
    """For each of the paper's groups: mean distance of its classes to each other, and to the rest."""
    table = os.path.join(scratch, "matrix.csv")
    run(program, "db", "matrix", name, "-o", table, "--distance", distance)
    with open(table, encoding="utf-8") as file:
        lines = [line.strip().split(",") for line in file]
    classes = [prefix(n) for n in lines[0][1:]]
    for group in GROUPS:
        inside, outside = [], []
        for i, line in enumerate(lines[1:]):
            for k, cell in enumerate(line[1:]):
                if classes[i] in group and classes[k] != classes[i]:
                    (inside if classes[k] in group else outside).append(float(cell))
        if inside:
            yield ", ".join(group), sum(inside) / len(inside), sum(outside) / len(outside)


def table(program, folders, distances):
    with tempfile.TemporaryDirectory() as scratch:
        names = [database(program, f, scratch) for f in folders]
        head("set", "distance", *MEASURES)
        for name in names:
            for distance in distances:
                found = run(program, "db", "evaluate", name, "--distance", distance)
                row(os.path.basename(name)[:-3], f"`{distance}`",
                    *(f"{found[m]:.3f}" for m in MEASURES))
        print()
        head("group", "distance", "within", "outside")
        for name in names:
            for distance in distances:
                for group, inside, outside in group_means(program, name, distance, scratch):
                    row(group, f"`{distance}`", f"{inside:.3g}", f"{outside:.3g}")


# ---- copies ----

def read_off(name):
    with open(name, encoding="ascii") as file:
        words = file.read().split()
    count, faces = int(words[1]), int(words[2])
    numbers = [float(w) for w in words[4:4 + 3 * count]]
    rest = [int(w) for w in words[4 + 3 * count:4 + 3 * count + 4 * faces]]
    return ([numbers[i:i + 3] for i in range(0, 3 * count, 3)],
            [rest[i + 1:i + 4] for i in range(0, 4 * faces, 4)])


def write_off(name, vertices, faces):
    with open(name, "w", encoding="ascii") as file:
        file.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
        file.writelines("%.17g %.17g %.17g\n" % tuple(v) for v in vertices)
        file.writelines("3 %d %d %d\n" % tuple(f) for f in faces)


def moved(vertices, faces, chance):
    """Turned about a random axis, scaled, moved, vertices and faces in another order."""
    axis = [chance.gauss(0, 1) for _ in range(3)]
    length = math.sqrt(sum(x * x for x in axis))
    x, y, z = (c / length for c in axis)
    angle, scale = chance.uniform(1, 5), chance.uniform(0.1, 10)
    c, s = math.cos(angle), math.sin(angle)
    rows = [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]
    places = list(range(len(vertices)))
    chance.shuffle(places)
    out = [None] * len(vertices)
    for i, v in enumerate(vertices):
        out[places[i]] = [scale * (sum(r[k] * v[k] for k in range(3)) + 7) for r in rows]
    faces = [[places[i] for i in f] for f in faces]
    chance.shuffle(faces)
    return out, faces


def shaken(vertices, faces, chance):
    edges = [math.dist(vertices[f[k]], vertices[f[k - 1]]) for f in faces for k in range(3)]
    step = 0.01 * sum(edges) / len(edges)
    return [[x + chance.gauss(0, step) for x in v] for v in vertices], faces


def copies(program, folders, distances):
    head("set", "copy", *(f"`{d}`" for d in distances))
    for folder in folders:
        with tempfile.TemporaryDirectory() as scratch:
            name, copy = database(program, folder, scratch), os.path.join(scratch, "copy.off")
            for change in moved, shaken:
                hits = dict.fromkeys(distances, 0)
                for i, model in enumerate(models(folder)):
                    write_off(copy, *change(*read_off(model), random.Random(i)))
                    for d in distances:
                        found = run(program, "db", "query", name, copy, "-k", "1", "--distance", d)
                        hits[d] += found["models"][0]["name"] == os.path.basename(model)
                row(os.path.basename(os.path.normpath(folder)), change.__name__,
                    *(f"{hits[d]} of {len(models(folder))}" for d in distances))


# ---- points ----

def points(program, folders, _):
    keys = ("to_mean", "to_largest", "from_mean", "from_largest")
    head("model", "guards", "directions", *keys)
    with tempfile.TemporaryDirectory() as scratch:
        for folder in folders:
            for model in (models(folder) if os.path.isdir(folder) else [folder]):
                for directions in 256, 1024, 4096, 16384:
                    out = os.path.join(scratch, "out.json")
                    found = run(program, "describe", model, "-o", out, "--directions",
                                str(directions))
                    row(os.path.basename(model), found["guards"], directions,
                        *(f"{found['reconstruction'][k]:.2g}" for k in keys))


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("command", choices=["table", "copies", "points"])
    parser.add_argument("starguard")
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--distances", default="star,paper,shape-dna,d2")
    wanted = parser.parse_args()
    commands = {"table": table, "copies": copies, "points": points}
    commands[wanted.command](wanted.starguard, wanted.folders, wanted.distances.split(","))


if __name__ == "__main__":
    sys.exit(main())
