#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Star-shaped pieces beside convex ones, on samples: for docs/convex.md.

    bench/convex.py STARGUARD [NAME...]

For each sample: its reflex edges, how many convex pieces it needs at least, the star-shaped pieces of
`decompose`, and how much larger the convex hulls of these are than the solid.

The bound for convex pieces: points of which no two see each other are in different convex pieces. They
are right inside of faces, spread by farthest-first traversal, and a set of them is chosen greedily, the
best of 200 orders. Signs are those of doubles, and only a segment that clearly crosses a face counts as
blocked, so rounding makes the bound smaller."""
import json
import os
import resource
import subprocess
import sys
import tempfile

import numpy as np

POINTS, ORDERS, VERTICES = 300, 200, 500


def run(program, *words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([program, *words, "--quiet"], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def read_obj(path):
    """Vertices, and the faces of each group."""
    vertices, groups = [], []
    with open(path, encoding="ascii") as file:
        for line in file:
            words = line.split()
            if not words:
                continue
            if words[0] == "v":
                vertices.append([float(word) for word in words[1:4]])
            elif words[0] in ("g", "o"):
                groups.append([])
            elif words[0] == "f":
                if not groups:
                    groups.append([])
                groups[-1].append([int(word.split("/")[0]) - 1 for word in words[1:4]])
    return np.array(vertices), [np.array(group) for group in groups if group]


def volume(corners):
    return np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6


def orient(a, b, c, d):
    return np.einsum("...i,...i->...", np.cross(b - a, c - a), d - a)


def reflex_edges(vertices, faces, size):
    """Edges at which the solid turns inward by more than rounding."""
    opposite = {}
    for face in faces:
        for i in range(3):
            opposite[face[i], face[(i + 1) % 3]] = face[(i + 2) % 3]
    return sum(orient(*vertices[[a, b, tip]], vertices[opposite[b, a]]) > 1e-12 * size ** 3
               for (a, b), tip in opposite.items() if a < b)


def blocked(p, ends, corners, size):
    """Which segments from p to each of the ends clearly cross a face."""
    a, b, c = (corners[None, :, i] for i in range(3))
    tip, end, least = p[None, None], ends[:, None], 1e-12 * size ** 3
    near, far = orient(a, b, c, tip), orient(a, b, c, end)
    sides = np.stack([orient(tip, end, x, y) for x, y in ((a, b), (b, c), (c, a))])
    inner = (sides > least).all(axis=0) | (sides < -least).all(axis=0)
    return ((np.abs(near) > least) & (np.abs(far) > least) & (np.sign(near) != np.sign(far)) & inner).any(axis=1)


def inner_points(corners, size):
    """Right inside of faces, far from one another."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middles = corners.mean(axis=1)
    points = middles - 1e-4 * size * normals / np.linalg.norm(normals, axis=1)[:, None]
    chosen, distance = [0], np.linalg.norm(points - points[0], axis=1)
    while len(chosen) < min(POINTS, len(points)):
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    reached = [i for i in chosen if not blocked(middles[i] - 1e-7 * size * normals[i] / np.linalg.norm(normals[i]),
                                                points[i:i + 1], corners, size)[0]]
    return points[reached]


def convex_at_least(points, corners, size):
    """Size of a set of points of which no two see each other."""
    sees = np.array([~blocked(p, points, corners, size) for p in points])
    sees |= sees.T
    random, best = np.random.default_rng(1), 0
    for _ in range(ORDERS):
        order = np.argsort(sees.sum(axis=1) + random.random(len(points)) * 0.2 * len(points))
        free, count = np.ones(len(points), bool), 0
        for i in order:
            if free[i]:
                count += 1
                free &= ~sees[i]
        best = max(best, count)
    return best


def hull_volume(points):
    """Of the convex hull, by adding points one after the other; points are shaken by a billionth."""
    size = np.ptp(points, axis=0).max()
    points = points + np.random.default_rng(1).normal(0, 1e-9 * size, points.shape)
    first = [0, int(np.linalg.norm(points - points[0], axis=1).argmax())]
    line = points[first[1]] - points[0]
    first.append(int(np.linalg.norm(np.cross(points - points[0], line), axis=1).argmax()))
    first.append(int(np.abs(orient(*points[first], points)).argmax()))
    if orient(*points[first]) > 0:
        first[0], first[1] = first[1], first[0]
    a, b, c, d = first
    faces = np.array([[a, b, c], [a, d, b], [b, d, c], [c, d, a]])
    for i in range(len(points)):
        outside = orient(points[faces[:, 0]], points[faces[:, 1]], points[faces[:, 2]], points[i]) > 0
        if not outside.any() or i in first:
            continue
        edges = {(face[k], face[(k + 1) % 3]) for face in faces[outside] for k in range(3)}
        faces = np.vstack([faces[~outside], [[x, y, i] for x, y in edges if (y, x) not in edges]])
    return volume(points[faces])


def main(program, *names):
    program = os.path.abspath(program)
    print("| sample | faces | reflex edges | convex pieces, at least | star-shaped pieces | s | their hulls | one hull |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|")
    for name in names or ("horse", "octopus", "gallery"):
        with tempfile.TemporaryDirectory() as folder:
            model, report = f"{folder}/model.obj", f"{folder}/pieces.json"
            run(program, "sample", name, "--vertices", str(VERTICES), "-o", model)
            seconds = run(program, "decompose", model, "-o", f"{folder}/pieces.vtk", "--report", report,
                          "--surfaces", f"{folder}/surfaces", "--threads", "1")
            vertices, (faces,) = read_obj(model)
            places, pieces = read_obj(f"{folder}/surfaces/pieces.obj")
            with open(report, encoding="utf-8") as file:
                told = json.load(file)
        assert told["strictly_star"] == len(pieces) == len(told["pieces"])
        corners, size = vertices[faces], np.linalg.norm(np.ptp(vertices, axis=0))
        whole = volume(corners)
        least = convex_at_least(inner_points(corners, size), corners, size)
        hulls = sum(hull_volume(places[np.unique(piece)]) for piece in pieces)
        print(f"| {name} | {len(faces):,} | {reflex_edges(vertices, faces, size):,} | {least} | {len(pieces)} | {seconds:.1f} | "
              f"{100 * (hulls / whole - 1):.0f} % | {100 * (hull_volume(vertices) / whole - 1):.0f} % |", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
