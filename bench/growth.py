#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How few pieces: those of `decompose --tets` beside growth in random order, on the same tetrahedra.

    bench/growth.py STARGUARD MESH [MESH...] [--seeds N]

Growth as in star decomposition maps [Hinderink, Campen 2024]: a piece begins with a random tetrahedron that is in none;
of its neighbours, in random order, each is added with which the piece stays a ball and has a centre, a point that is on
the inner side of all its faces (a linear program); where none can be added, the next piece begins. MESH is MEDIT .mesh
or legacy ASCII .vtk. Needs SciPy. Takes some minutes for ten thousand tetrahedra. The table is Markdown."""
import argparse
import json
import pathlib
import random
import subprocess
import tempfile

import numpy
from scipy.optimize import linprog

FACES = ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))  # outward, each across from a corner


def read(path: pathlib.Path):
    """Vertices, and tetrahedra as corners."""
    words = path.read_text().split()
    if path.suffix == ".mesh":
        at = words.index("Vertices") + 1
        count = int(words[at])
        vertices = numpy.array(words[at + 1:at + 1 + 4 * count], float).reshape(-1, 4)[:, :3]
        at = words.index("Tetrahedra") + 1
        count = int(words[at])
        return vertices, numpy.array(words[at + 1:at + 1 + 5 * count], int).reshape(-1, 5)[:, :4] - 1
    at = words.index("POINTS") + 1
    vertices = numpy.array(words[at + 2:at + 2 + 3 * int(words[at])], float).reshape(-1, 3)
    at = words.index("CELLS") + 1
    return vertices, numpy.array(words[at + 2:at + 2 + int(words[at + 1])], int).reshape(-1, 5)[:, 1:]


def has_center(vertices, faces) -> bool:
    """Is there a point strictly inside of all planes of the faces?"""
    a, b, c = (vertices[[face[k] for face in faces]] for k in range(3))
    normals = numpy.cross(b - a, c - a)
    normals /= numpy.linalg.norm(normals, axis=1)[:, None]
    rows = numpy.hstack([normals, numpy.ones((len(faces), 1))])
    found = linprog([0, 0, 0, -1], A_ub=rows, b_ub=(normals * a).sum(1), bounds=[(None, None)] * 3 + [(None, 1)])
    return found.status == 0 and found.x[3] > 1e-9 * numpy.abs(vertices).max()


def grow(vertices, corners, seed: int) -> int:
    """The number of pieces."""
    draw = random.Random(seed)
    sides = vertices[corners[:, 1:]] - vertices[corners[:, :1]]
    corners = numpy.where((numpy.linalg.det(sides) < 0)[:, None], corners[:, [1, 0, 2, 3]], corners)
    faces = [[tuple(int(t[k]) for k in face) for face in FACES] for t in corners]
    across = {}
    for t, own in enumerate(faces):
        for face in own:
            across.setdefault(frozenset(face), []).append(t)
    free, pieces = set(range(len(corners))), 0
    order = list(free)
    draw.shuffle(order)
    for first in order:
        if first not in free:
            continue
        pieces += 1
        free.discard(first)
        piece, boundary = {first}, {frozenset(face): face for face in faces[first]}
        beside = list(boundary)
        while beside:
            at = draw.randrange(len(beside))
            beside[at], beside[-1] = beside[-1], beside[at]
            face = beside.pop()
            other = [t for t in across[face] if t in free]
            if face not in boundary or not other:
                continue
            t = other[0]
            shared = [f for f in faces[t] if frozenset(f) in boundary]
            new = [f for f in faces[t] if frozenset(f) not in boundary]
            # the vertex, or the edge, across from what is shared must be new, or the piece is no ball any more
            if len(shared) < 3 and any(set.intersection(*map(set, new)) <= key for key in boundary):
                continue
            trial = {key: f for key, f in boundary.items() if key not in map(frozenset, shared)}
            trial.update((frozenset(f), f) for f in new)
            if not has_center(vertices, list(trial.values())):
                continue
            boundary = trial
            piece.add(t)
            free.discard(t)
            beside += [frozenset(f) for f in new]
    return pieces


def decompose(program: str, mesh: pathlib.Path, folder: pathlib.Path) -> int:
    report = folder / "p.json"
    subprocess.run([program, "decompose", "--tets", str(mesh), "-o", str(folder / "p.vtk"), "--report", str(report),
                    "--quiet"], check=True)
    return len(json.loads(report.read_text())["pieces"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("meshes", nargs="+", type=pathlib.Path)
    parser.add_argument("--seeds", type=int, default=1)
    wanted = parser.parse_args()
    print("| mesh | tetrahedra | growth in random order | decompose |\n|---|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as folder:
        for mesh in wanted.meshes:
            vertices, corners = read(mesh)
            grown = [grow(vertices, corners, seed) for seed in range(wanted.seeds)]
            ours = decompose(wanted.program, mesh, pathlib.Path(folder))
            print(f"| {mesh.stem} | {len(corners)} | {min(grown)} | {ours} |", flush=True)


if __name__ == "__main__":
    main()
