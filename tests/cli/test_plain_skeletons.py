#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Skeletons of plain solids, which are known: how many are right?

usage: test_plain_skeletons.py [--all] [--long] [--only WORD] [--keep FOLDER] [--processes N]

Every second solid is taken as it is, and every third of these also turned at random, and shaken by 1e-15 to 1e-4
of its size; with --all all of them, in all three ways. A skeleton is right if
  - it has the loops and ends of its solid, and no two nodes coincide;
  - its ends lie between the centre of the last ball and the cap, up to a tenth of the radius, both alike;
  - that of a straight round solid is within a twentieth of the radius of the axis;
  - that of a copy has the same joints and lies within 2 % of the radius of that of the solid itself.
Reads nothing but the written files. STARGUARD_LONG takes these 231 and 500 solids of other proportions, each with its copies.

Loops, ends, coincident nodes and the axis must be right in all. The rest is counted, and fewer right ones than
there were is a failure: copies of bars that meet in a joint, where the medial axis is a plate, are up to half a
sample apart.
"""
import argparse
import math
import multiprocessing
import os
import random
import subprocess
import sys
import tempfile

import plain_solids as plain
from plain_solids import add, dot

PROGRAM = os.environ.get("STARGUARD", "build/starguard")
LONG = 500
AXIS, END, COPY = 0.05, 0.1, 0.02
LEAST = {65: 64, 231: 228, 1731: 1700}  # of so many results, right in all


class Skeleton:
    def __init__(self, nodes, edges):
        self.nodes, self.edges = nodes, edges
        self.neighbours = [[] for _ in nodes]
        for a, b in edges:
            self.neighbours[a].append(b)
            self.neighbours[b].append(a)

    def ends(self):
        return [v for v, others in enumerate(self.neighbours) if len(others) == 1]

    def joints(self):
        return sum(len(others) > 2 for others in self.neighbours)

    def parts(self):
        seen, parts = set(), 0
        for v in range(len(self.nodes)):
            if v in seen:
                continue
            parts += 1
            stack = [v]
            while stack:
                w = stack.pop()
                if w not in seen:
                    seen.add(w)
                    stack += self.neighbours[w]
        return parts


def read_obj(path):
    nodes, edges = [], []
    with open(path, encoding="utf-8") as file:
        for line in file:
            word, *rest = line.split()
            if word == "v":
                nodes.append([float(x) for x in rest])
            elif word == "l":
                edges.append(tuple(int(x) - 1 for x in rest))
    return Skeleton(nodes, edges)


def distance(a, b):
    return math.dist(a, b)


def distance_to_edge(p, a, b):
    x, y, z = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    u, v, w = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    length = x * x + y * y + z * z
    t = min(max((u * x + v * y + w * z) / length, 0.0), 1.0) if length > 0 else 0.0
    return math.hypot(u - t * x, v - t * y, w - t * z)


class Grid:
    """The edges of a skeleton by cells of space."""

    def __init__(self, skeleton, size):
        self.skeleton, self.size, self.cells = skeleton, size, {}
        for e, (a, b) in enumerate(skeleton.edges):
            steps = 1 + int(distance(skeleton.nodes[a], skeleton.nodes[b]) / size)
            for i in range(steps + 1):
                p = add(skeleton.nodes[a], add(skeleton.nodes[b], skeleton.nodes[a], -1), i / steps)
                self.cells.setdefault(self.cell(p), set()).add(e)

    def cell(self, p):
        return tuple(math.floor(x / self.size) for x in p)

    def distance(self, p):
        """From the nearest edge; at most the size of a cell is found."""
        i, j, k = self.cell(p)
        best, nodes = self.size, self.skeleton.nodes
        for x in (i - 1, i, i + 1):
            for y in (j - 1, j, j + 1):
                for z in (k - 1, k, k + 1):
                    for e in self.cells.get((x, y, z), ()):
                        a, b = self.skeleton.edges[e]
                        best = min(best, distance_to_edge(p, nodes[a], nodes[b]))
        return best


def farthest(skeleton, grid):
    """The greatest distance of a node from the other skeleton: of the ends and joints, and of every third."""
    return max(grid.distance(p) for v, p in enumerate(skeleton.nodes)
               if v % 3 == 0 or len(skeleton.neighbours[v]) != 2)


def end_faults(solid, skeleton):
    """How far each end is from where it belongs, and whether two tips of one shape are treated alike."""
    faults, depths = [], []
    ends = [skeleton.nodes[v] for v in skeleton.ends()]
    for tip in solid.tips:
        scale = tip.radius if tip.radius > 0.1 * solid.radius else solid.radius
        off = min((distance_to_edge(p, tip.ball, tip.cap), distance(p, tip.cap)) for p in ends)
        depths.append(off[1])
        if off[0] > END * scale:
            faults.append(f"an end is off by {off[0] / scale:.2f} radii")
    if solid.alike and not faults and abs(depths[0] - depths[1]) > END * solid.tips[0].radius:
        faults.append(f"ends differ by {abs(depths[0] - depths[1]) / solid.tips[0].radius:.2f} radii")
    return faults


def coincident(skeleton, radius):
    """Pairs of nodes closer than a millionth of the radius, by sorting along a line."""
    order = sorted(range(len(skeleton.nodes)), key=lambda v: dot(skeleton.nodes[v], (1, 0.618, 0.414)))
    least, count = 1e-6 * radius, 0
    for i, v in enumerate(order):
        for w in order[i + 1:]:
            if dot(add(skeleton.nodes[w], skeleton.nodes[v], -1), (1, 0.618, 0.414)) > 2 * least:
                break
            count += distance(skeleton.nodes[v], skeleton.nodes[w]) < least
    return count


def faults_of(solid, skeleton):
    """What must not be."""
    loops = len(skeleton.edges) - len(skeleton.nodes) + skeleton.parts()
    faults = []
    if skeleton.parts() != 1 or loops != solid.loops:
        faults.append(f"{skeleton.parts()} parts, {loops} loops instead of {solid.loops}")
    if len(skeleton.ends()) != solid.ends():
        faults.append(f"{len(skeleton.ends())} ends instead of {solid.ends()}, {skeleton.joints()} joints")
    if coincident(skeleton, solid.radius) > 0:
        faults.append(f"{coincident(skeleton, solid.radius)} pairs of nodes coincide")
    if solid.axis is not None:
        off = max(distance_to_edge(p, *solid.axis) for p in skeleton.nodes) / solid.radius
        if off > AXIS:
            faults.append(f"off the axis by {off:.3f} radii")
    return faults


def compare(solid, skeleton, copy):
    """Faults of a copy's skeleton, turned back, against that of the solid itself."""
    size = 2.5 * COPY * solid.radius  # the most that is found
    off = max(farthest(copy, Grid(skeleton, size)), farthest(skeleton, Grid(copy, size))) / solid.radius
    faults = []
    if off > COPY:
        faults.append(f"off the unturned one by {off:.3f} radii")
    if copy.joints() != skeleton.joints():
        faults.append(f"{copy.joints()} joints, {skeleton.joints()} unturned")
    return faults


def run(path, keep=None):
    """The skeleton of a model, or what the program says."""
    result = path + ".obj"
    done = subprocess.run([PROGRAM, "skeleton", path, "-o", result], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return None, done.stderr.strip()
    return read_obj(result), done.stderr.strip()


def examine(job):
    """The solid and its copies: (kind, name, faults, flaws) of each."""
    solid, number, folder, turned = job
    rng = random.Random(number)
    path = os.path.join(folder, solid.name)
    size = math.dist([min(v[k] for v in solid.vertices) for k in range(3)],
                     [max(v[k] for v in solid.vertices) for k in range(3)])
    matrix = plain.random_turn(rng)
    shake = size * 10 ** -(4 + number % 12)
    copies = [("", lambda v: v, lambda v: v),
              ("_turned", lambda v: plain.turn(matrix, v), lambda v: plain.turn(list(zip(*matrix)), v)),
              (f"_shaken_1e-{4 + number % 12}", lambda v: [x + rng.uniform(-shake, shake) for x in v], lambda v: v)]
    results, first = [], None
    for suffix, there, back in copies if turned else copies[:1]:
        solid.write(path + suffix + ".off", [there(v) for v in solid.vertices])
        skeleton, words = run(path + suffix + ".off")
        if skeleton is None:
            results.append((solid.kind, solid.name + suffix, [words], []))
            continue
        skeleton.nodes = [back(p) for p in skeleton.nodes]
        faults, flaws = faults_of(solid, skeleton), []
        if not faults and solid.tips:
            flaws += end_faults(solid, skeleton)
        if first is not None:
            flaws += compare(solid, first, skeleton)
        else:
            first = skeleton
        results.append((solid.kind, solid.name + suffix, faults, flaws))
    return results


def solids_of_family(long, every):
    solids = list(enumerate(plain.bases()))[::every]
    if long:
        rng = random.Random(500)
        solids += [(1000 + i, plain.random_base(rng)) for i in range(LONG)]
    return solids


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--long", action="store_true", default=bool(os.environ.get("STARGUARD_LONG")))
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--keep", default=None)
    parser.add_argument("--processes", type=int, default=1)
    options = parser.parse_args()
    every = 1 if options.all or options.long or options.only else 2
    with tempfile.TemporaryDirectory() as scratch:
        jobs = [(solid, number, options.keep or scratch, options.all or options.long or number % 3 == 0)
                for number, solid in solids_of_family(options.long, every) if options.only in solid.name]
        with multiprocessing.Pool(options.processes) as pool:
            results = [r for group in pool.imap(examine, jobs) for r in group]
    kinds = {}
    for kind, name, faults, flaws in results:
        count = kinds.setdefault(kind, [0, 0, 0])
        count[0] += not faults
        count[1] += not faults and not flaws
        count[2] += 1
        if faults or flaws:
            print(f"{name}: {'; '.join(faults + flaws)}")
    for kind, (sound, right, count) in kinds.items():
        print(f"{kind}: {count} solids, {sound} with the right loops, ends and axis, {right} right in all")
    sound = sum(not faults for _, _, faults, _ in results)
    right = sum(not faults and not flaws for _, _, faults, flaws in results)
    print(f"{len(results)} plain skeletons: {sound} have the right loops, ends and axis, {right} are right in all")
    sys.exit(sound < len(results) or (not options.only and right < LEAST.get(len(results), 0)))


if __name__ == "__main__":
    main()
