#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Retrieval quality of each distance: the tables of docs/retrieval.md.

usage: retrieval.py COMMAND STARGUARD FOLDER... [--distances star,paper,shape-dna,d2]

  table    every measure for each folder of models, classes by prefix, and the paper's groups
  copies   is the original the nearest model to its copy, rotated, scaled, translated and
           renumbered, with half the vertices, or with noise on every coordinate: Gaussian with
           1 % of the mean edge, or uniform up to 0.5 % or 1 % of the diagonal?
  growth   processor seconds of a query against the folder, mainly for describing the query, and
           against 1,000 to 100,000 signatures derived from it by random factors
  points   distance of a descriptor's points from the surface, by their number
  families FOLDER: makes the samples that weights are chosen by, 10 members of each family and 5
           poses of each animal
  robustness  disguises of every fifth model of the folder among all of its models: how often the
           original is the nearest, how often another of its class

Tables are Markdown. Needs the package: PYTHONPATH=build/python.
"""
import argparse
import array
import json
import math
import os
import random
import resource
import sqlite3
import subprocess
import sys
import tempfile

import starguard

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


def read_matrix(program, name, distance, scratch):
    table = os.path.join(scratch, "matrix.csv")
    run(program, "db", "matrix", name, "-o", table, "--distance", distance)
    with open(table, encoding="utf-8") as file:
        lines = [line.strip().split(",") for line in file]
    return lines[0][1:], [[float(x) for x in line[1:]] for line in lines[1:]]


def group_means(program, name, distance, scratch):
    """For each of the paper's groups: mean distance of its classes to each other, and to the rest."""
    names, matrix = read_matrix(program, name, distance, scratch)
    classes = [prefix(n) for n in names]
    for group in GROUPS:
        inside, outside = [], []
        for i, line in enumerate(matrix):
            for k, cell in enumerate(line):
                if classes[i] in group and classes[k] != classes[i]:
                    (inside if classes[k] in group else outside).append(cell)
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
    """Rotated about a random axis, scaled, translated, with vertices and faces reordered."""
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


def thinned(vertices, faces, wanted):
    """By the package's edge collapses."""
    mesh, _ = starguard.Mesh(vertices, faces).simplify(wanted)
    return mesh.vertices.tolist(), mesh.faces.tolist()


def halved(vertices, faces, _):
    return thinned(vertices, faces, len(vertices) // 2)


def shaken(vertices, faces, chance):
    edges = [math.dist(vertices[f[k]], vertices[f[k - 1]]) for f in faces for k in range(3)]
    step = 0.01 * sum(edges) / len(edges)
    return [[x + chance.gauss(0, step) for x in v] for v in vertices], faces


def noisy(vertices, faces, chance, part):
    box = [(min(v[k] for v in vertices), max(v[k] for v in vertices)) for k in range(3)]
    step = part * math.sqrt(sum((b - a) ** 2 for a, b in box))
    return [[x + chance.uniform(-step, step) for x in v] for v in vertices], faces


CHANGES = {"moved": moved, "half the vertices": halved, "1 % of the edge": shaken,
           "0.5 % of the diagonal": lambda v, f, c: noisy(v, f, c, 0.005),
           "1 % of the diagonal": lambda v, f, c: noisy(v, f, c, 0.01)}


def copies(program, folders, distances):
    head("set", "copy", *(f"`{d}`" for d in distances))
    for folder in folders:
        with tempfile.TemporaryDirectory() as scratch:
            name, copy = database(program, folder, scratch), os.path.join(scratch, "copy.off")
            for word, change in CHANGES.items():
                hits = dict.fromkeys(distances, 0)
                for i, model in enumerate(models(folder)):
                    write_off(copy, *change(*read_off(model), random.Random(i)))
                    for d in distances:
                        found = run(program, "db", "query", name, copy, "-k", "1", "--distance", d)
                        hits[d] += found["models"][0]["name"] == os.path.basename(model)
                row(os.path.basename(os.path.normpath(folder)), word,
                    *(f"{hits[d]} of {len(models(folder))}" for d in distances))


# ---- families ----

FAMILIES = {"vase": 10, "bust": 10, "bearing": 10, "table": 10, "tool": 10, "bird": 5, "cat": 5, "dinosaur": 5,
            "dog": 5, "giraffe": 5, "horse": 5, "human": 5, "octopus": 5}


def families(program, folders, _):
    os.makedirs(folders[0], exist_ok=True)
    for name, members in FAMILIES.items():
        for i in range(members):
            run(program, "sample", name, "--pose", str(i), "--vertices", "5000", "-o",
                os.path.join(folders[0], f"{name}_{i}.off"))


# ---- robustness ----

def used_only(vertices, faces):
    used = sorted({v for f in faces for v in f})
    number = {v: i for i, v in enumerate(used)}
    return [vertices[v] for v in used], [[number[v] for v in f] for f in faces]


def tenth(vertices, faces, _):
    return thinned(vertices, faces, len(vertices) // 10)


def neighbours_of(faces):
    around = {}
    for i, f in enumerate(faces):
        for v in f:
            around.setdefault(v, []).append(i)
    return around


def holed(vertices, faces, chance):
    """Without five discs of a hundredth of the faces each: the surface is open."""
    around, gone = neighbours_of(faces), set()
    for _ in range(5):
        disc, border = set(), [chance.randrange(len(faces))]
        while border and len(disc) < len(faces) // 100:
            f = border.pop(0)
            if f not in disc:
                disc.add(f)
                border += [g for v in faces[f] for g in around[v] if g not in disc]
        gone |= disc
    return used_only(vertices, [f for i, f in enumerate(faces) if i not in gone])


def stretched(vertices, faces, chance):
    factors = [math.exp(chance.gauss(0, 0.15)) for _ in range(3)]
    return [[x * k for x, k in zip(v, factors)] for v in vertices], faces


def remeshed(vertices, faces, chance):
    """Cuts all edges at random and collapses to as many vertices as before: other, uneven triangles."""
    middle, points, fine = {}, [list(v) for v in vertices], []
    for f in faces:
        for a, b in zip(f, f[1:] + f[:1]):
            if a < b:
                t = chance.uniform(0.3, 0.7)
                middle[a, b] = middle[b, a] = len(points)
                points.append([x + t * (y - x) for x, y in zip(vertices[a], vertices[b])])
    for a, b, c in faces:
        ab, bc, ca = middle[a, b], middle[b, c], middle[c, a]
        fine += [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
    return thinned(points, fine, len(vertices))


def cut(vertices, faces, chance):
    """Without what is beyond a random plane, a fifth of the vertices: the surface is open."""
    axis = [chance.gauss(0, 1) for _ in range(3)]
    heights = [sum(a * x for a, x in zip(axis, v)) for v in vertices]
    level = sorted(heights)[4 * len(heights) // 5]
    return used_only(vertices, [f for f in faces if max(heights[v] for v in f) <= level])


DISGUISES = {"noise of 0.5 % of the diagonal": lambda v, f, c: noisy(v, f, c, 0.005),
             "noise of 1 %": lambda v, f, c: noisy(v, f, c, 0.01),
             "a tenth of the vertices": tenth,
             "holes, 5 % of the faces": holed,
             "stretched": stretched,
             "remeshed": remeshed,
             "a fifth cut away": cut}


def robustness(program, folders, distances):
    head("disguise", *(f"`{d}`: original" for d in distances), *(f"`{d}`: class" for d in distances))
    for folder in folders:
        originals = models(folder)
        names = {os.path.basename(m) for m in originals}
        with tempfile.TemporaryDirectory() as scratch:
            name = database(program, folder, scratch)
            marks = {}
            for i, model in enumerate(originals[::5]):
                for k, (word, change) in enumerate(DISGUISES.items()):
                    copy = f"~{k}_{os.path.basename(model)}"
                    marks[copy] = word, os.path.basename(model)
                    write_off(os.path.join(scratch, copy), *change(*read_off(model), random.Random(i)))
            subprocess.run([program, "db", "add", name, *(os.path.join(scratch, c) for c in marks), "--quiet"],
                           check=False)
            hits = {(w, d, c): [] for w in DISGUISES for d in distances for c in range(2)}
            for d in distances:
                labels, matrix = read_matrix(program, name, d, scratch)
                there = [i for i, label in enumerate(labels) if label in names]
                for label, line in zip(labels, matrix):
                    if label in marks:
                        word, original = marks[label]
                        first = min(there, key=lambda i, r=line: r[i])
                        others = [i for i in there if labels[i] != original]
                        second = min(others, key=lambda i, r=line: r[i])
                        hits[word, d, 0].append(labels[first] == original)
                        hits[word, d, 1].append(prefix(labels[second]) == prefix(original))
            for word in DISGUISES:
                row(word, *(f"{sum(hits[word, d, c])} of {len(hits[word, d, c])}" for c in range(2)
                            for d in distances))


# ---- growth ----

def growth(program, folders, distances):
    distances = [d for d in distances if d != "paper"]  # its numbers cannot be scaled freely
    head("models", *(f"`{d}`" for d in distances))
    with tempfile.TemporaryDirectory() as scratch:
        name = database(program, folders[0], scratch)
        query = models(folders[0])[0]
        connection = sqlite3.connect(name)
        count = connection.execute("SELECT count(*) FROM model").fetchone()[0]
        known = connection.execute("SELECT kind, version, numbers FROM signature ORDER BY model, "
                                   "kind").fetchall()
        chance = random.Random(1)
        for wanted in count, 1000, 10000, 100000:
            while count < wanted:
                row_id = connection.execute(
                    "INSERT INTO model (path, hash, vertices, faces) VALUES (?, ?, 1, 1)",
                    (f"generated_{count}.off", chance.randbytes(32))).lastrowid
                first = 4 * chance.randrange(len(known) // 4)
                for kind, version, blob in known[first:first + 4]:
                    if kind in distances:
                        numbers = array.array("d", blob)
                        factor = chance.uniform(0.9, 1.1)
                        changed = array.array("d", (x * factor for x in numbers))
                        connection.execute("INSERT INTO signature VALUES (?, ?, ?, ?)",
                                           (row_id, kind, version, changed.tobytes()))
                count += 1
            connection.execute("DROP TABLE IF EXISTS sketch")
            connection.commit()
            subprocess.run([program, "db", "add", name, query, "--quiet"], check=True)  # sketches
            cells = []
            for d in distances:
                before = resource.getrusage(resource.RUSAGE_CHILDREN)
                run(program, "db", "query", name, query, "--distance", d)
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                cells.append("%.2f" % (after.ru_utime + after.ru_stime
                                       - before.ru_utime - before.ru_stime))
            row(count, *cells)


# ---- points ----

def points(program, folders, _):
    keys = ("to_mean", "to_largest", "from_mean", "from_largest")
    head("model", "guards", "directions", *keys)
    with tempfile.TemporaryDirectory() as scratch:
        for folder in folders:
            for model in (models(folder) if os.path.isdir(folder) else [folder]):
                for directions in 256, 1024, 4096, 16384:
                    out = os.path.join(scratch, "out.json")
                    found = run(program, "describe", model, "-o", out, "--detail", "0",
                                "--directions", str(directions))
                    row(os.path.basename(model), found["guards"], directions,
                        *(f"{found['reconstruction'][k]:.2g}" for k in keys))


def main():
    parser = argparse.ArgumentParser(usage=__doc__.replace("%", "%%"))
    parser.add_argument("command", choices=["table", "copies", "growth", "points", "families", "robustness"])
    parser.add_argument("starguard")
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--distances", default="star,paper,shape-dna,d2")
    wanted = parser.parse_args()
    commands = {"table": table, "copies": copies, "growth": growth, "points": points,
                "families": families, "robustness": robustness}
    commands[wanted.command](wanted.starguard, wanted.folders, wanted.distances.split(","))


if __name__ == "__main__":
    sys.exit(main())
