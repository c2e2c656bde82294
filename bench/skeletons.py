#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Computes the skeleton of every .off model of a folder except nasty/, and checks each independently.

usage: skeletons.py STARGUARD FOLDER [--only SUBFOLDER]

Components and loops are counted in the written graph and compared with those of the model's surface;
nodes must be inside, by the winding number of the surface about them. Lists every model with a
difference, or whose skeleton the program itself reports as not homotopic; at the end the counts. The
exit status is 1 if the skeleton of a handlebody (embedded, without cavities, and nothing was cut) has
wrong components or loops, or if any skeleton has a node outside.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from fractions import Fraction

CELLS = 64  # per side of the grid that stores faces
# Any linear map with positive determinant preserves winding numbers; this one makes no ray axis-parallel.
TURN = (0.80123, -0.47131, 0.36871, 0.59317, 0.65197, -0.47269, -0.01811, 0.59743, 0.80181)


def run(program, *words):
    done = subprocess.run([program, *words, "--json"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return None, done.stderr.strip() or done.stdout.strip()
    return json.loads(done.stdout), ""


def turned(v, number=float):
    return tuple(sum(number(TURN[3 * i + k]) * number(v[k]) for k in range(3)) for i in range(3))


def read_off(path):
    """One vertex or face per line; further values, such as colours, are ignored."""
    with open(path, encoding="utf-8") as file:
        lines = [line.split("#")[0].split() for line in file]
    lines = [line for line in lines if line and line != ["OFF"]]
    count, faces = int(lines[0][0]), int(lines[0][1])
    vertices = [[float(w) for w in line[:3]] for line in lines[1:1 + count]]
    corners = []
    for line in lines[1 + count:1 + count + faces]:
        ring = [int(w) for w in line[1:1 + int(line[0])]]
        corners += [(ring[0], ring[k], ring[k + 1]) for k in range(1, len(ring) - 1)]
    return vertices, corners


def read_graph(path):
    nodes, edges = [], []
    with open(path, encoding="utf-8") as file:
        for line in file:
            kind, *words = line.split()
            if kind == "v":
                nodes.append([float(w) for w in words[:3]])
            elif kind == "l":
                edges.append(tuple(int(w) - 1 for w in words))
    return nodes, edges


def count_parts(count, pairs):
    parent = list(range(count))

    def root(i):
        while parent[i] != i:
            parent[i] = i = parent[parent[i]]
        return i

    for a, b in pairs:
        parent[root(a)] = root(b)
    return sum(parent[i] == i for i in range(count))


class Windings:
    """Winding number of a surface about a point: signed crossings of the ray towards +x."""

    def __init__(self, vertices, corners):
        self.given, self.corners = vertices, corners
        self.vertices = vertices = [turned(v) for v in vertices]
        self.low = [min(v[k] for v in vertices) for k in (1, 2)]
        high = [max(v[k] for v in vertices) for k in (1, 2)]
        self.scale = [CELLS / (h - l) for h, l in zip(high, self.low)]
        self.cells = {}
        for face in corners:
            spans = []
            for k in (0, 1):
                values = [vertices[c][k + 1] for c in face]
                spans.append(range(self.cell(min(values), k), self.cell(max(values), k) + 1))
            for i in spans[0]:
                for j in spans[1]:
                    self.cells.setdefault((i, j), []).append(face)

    def cell(self, value, k):
        return min(max(math.floor((value - self.low[k]) * self.scale[k]), 0), CELLS - 1)

    def holds(self, node):
        """Is the node inside? Next to a wall this needs exact numbers."""
        p = turned(node)
        near = self.cells.get((self.cell(p[1], 0), self.cell(p[2], 1)), ())
        if self.count(p, [[self.vertices[i] for i in face] for face in near]) > 0:
            return True
        p = turned(node, Fraction)
        exact = {i: turned(v, Fraction) for i, v in enumerate(self.given)}
        return self.count(p, [[exact[i] for i in face] for face in self.corners]) > 0

    @staticmethod
    def count(p, faces):
        winding = 0
        for face in faces:
            a, b, c = (tuple(x - y for x, y in zip(v, p)) for v in face)
            sides = [u[1] * v[2] - u[2] * v[1] for u, v in ((b, c), (c, a), (a, b))]
            if all(s > 0 for s in sides) or all(s < 0 for s in sides):
                if (sides[0] * a[0] + sides[1] * b[0] + sides[2] * c[0]) / sum(sides) > 0:
                    winding += 1 if sides[0] > 0 else -1
        return winding


def describe(told, graph, surface):
    """What is wrong or noteworthy; and is it wrong?"""
    nodes, edges = graph
    parts = count_parts(len(nodes), edges)
    loops = len(edges) - len(nodes) + parts
    outside = sum(not surface.holds(p) for p in nodes)
    handlebody = told["embedded"] and told["cavities"] == 0 and told["cuts"] == 0
    right = parts == told["surface"][0] and loops == told["surface"][1]
    words = f"{parts} parts, {loops} loops"
    if not right:
        words += f" (the surface asks for {told['surface'][0]} and {told['surface'][1]})"
    words += "".join(f", {told[k]} {k}" for k in ("cavities", "cuts", "mends") if told[k])
    if not told["embedded"]:
        words += ", crosses itself"
    if outside:
        words += f", {outside} of {len(nodes)} nodes outside"
    return words, handlebody, right, outside > 0


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("starguard")
    parser.add_argument("folder")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    paths = []
    for base, _, names in os.walk(os.path.join(options.folder, options.only)):
        if os.path.basename(base) != "nasty":  # files for testing readers
            paths += [os.path.join(base, n) for n in names if n.endswith(".off")]
    counts = dict.fromkeys(("solids", "handlebodies", "right", "homotopic", "outside", "refused"),
                           0)
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        result = os.path.join(folder, "skeleton.obj")
        for path in sorted(paths):
            name = os.path.relpath(path, options.folder)
            model, _ = run(options.starguard, "check", path)
            if model is None:
                continue
            skeleton, message = run(options.starguard, "skeleton", path, "-o", result)
            counts["solids"] += 1
            if skeleton is None:
                counts["refused"] += 1
                print(f"{name}: {message}", flush=True)
                continue
            told = {"embedded": model["embedded"], "cavities": model["cavities"],
                    "surface": (model["components"] - model["cavities"], model["genus"]),
                    "cuts": skeleton["cuts"], "mends": skeleton["mends"]}
            words, handlebody, right, outside = describe(told, read_graph(result),
                                                         Windings(*read_off(path)))
            counts["handlebodies"] += handlebody
            counts["right"] += handlebody and right
            counts["homotopic"] += skeleton["homotopic"]
            counts["outside"] += outside
            failed = failed or outside or (handlebody and not right)
            if outside or not (right and skeleton["homotopic"]):
                print(f"{name}: {words}", flush=True)
    print("{solids} solids, {handlebodies} of them handlebodies: {right} have the right parts and "
          "loops; {homotopic} are homotopic, {refused} refused, {outside} have nodes outside"
          .format(**counts))
    sys.exit(failed)


if __name__ == "__main__":
    main()
