#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cameras in rooms of a few large triangles, against the same rooms in fine meshes.

    bench/rooms.py [--program PROGRAM] [--cell LENGTH]

Ten rooms: floor plans drawn here, extruded, some with columns and crates as boxes within. Each is guarded
by cameras under the ceiling as it is (faces are seen in parts, which the program chooses), and with every
triangle cut into four until no edge is longer than LENGTH (faces are seen as they are). A line for each:
triangles, cameras and share of the area seen of both, and processor seconds."""
import argparse
import json
import math
import pathlib
import resource
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEIGHT = 3
SENSOR = ["--mount", "ceiling", "--clearance", "0.1", "--fov", "90,60", "--range", "6"]

#       plan (counterclockwise), boxes within (x0, y0, z0, x1, y1, z1)
ROOMS = {
    "box": ([(0, 0), (8, 0), (8, 6), (0, 6)], []),
    "L": ([(0, 0), (9, 0), (9, 4), (4, 4), (4, 9), (0, 9)], []),
    "T": ([(0, 0), (10, 0), (10, 3), (6.5, 3), (6.5, 8), (3.5, 8), (3.5, 3), (0, 3)], []),
    "U": ([(0, 0), (9, 0), (9, 8), (6, 8), (6, 3), (3, 3), (3, 8), (0, 8)], []),
    "plus": ([(3, 0), (6, 0), (6, 3), (9, 3), (9, 6), (6, 6), (6, 9), (3, 9), (3, 6), (0, 6), (0, 3), (3, 3)], []),
    "two rooms, a door": ([(0, 0), (5, 0), (5, 2.2), (5.2, 2.2), (5.2, 0), (10, 0), (10, 6), (5.2, 6), (5.2, 3.2),
                           (5, 3.2), (5, 6), (0, 6)], []),
    "corridor": ([(0, 0), (16, 0), (16, 2), (0, 2)], []),
    "columns": ([(0, 0), (10, 0), (10, 8), (0, 8)],
                [(3, 3, 0.02, 3.5, 3.5, 2.98), (6.5, 3, 0.02, 7, 3.5, 2.98), (5, 5.5, 0.02, 5.5, 6, 2.98)]),
    "crates": ([(0, 0), (9, 0), (9, 7), (0, 7)],
               [(2, 2, 0.02, 3.2, 3.2, 1.2), (5, 1, 0.02, 6, 2.5, 0.8), (6, 4, 0.02, 7.5, 5, 1.6)]),
    "skew": ([(0, 0), (7, 1), (9, 6), (4, 8), (-1, 4)], []),
}


def turn(a: tuple, b: tuple, c: tuple) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def triangulate(plan: list) -> list:
    """Ears of a polygon, cut one after another."""
    left, out = list(range(len(plan))), []
    while len(left) > 3:
        for i in range(len(left)):
            a, b, c = left[i - 1], left[i], left[(i + 1) % len(left)]
            corner = [plan[a], plan[b], plan[c]]
            others = [plan[k] for k in left if k not in (a, b, c)]
            if turn(*corner) > 0 and not any(all(turn(corner[j], corner[(j + 1) % 3], p) >= 0 for j in range(3))
                                             for p in others):
                out.append((a, b, c))
                del left[i]
                break
    return out + [tuple(left)]


def extrude(plan: list, low: float, high: float, inward: bool) -> list:
    """Triangles of a prism; y is up."""
    n, out = len(plan), []
    at = [(x, low, -y) for x, y in plan] + [(x, high, -y) for x, y in plan]
    for a, b, c in triangulate(plan):
        out += [(at[c], at[b], at[a]), (at[a + n], at[b + n], at[c + n])]
    for i in range(n):
        j = (i + 1) % n
        out += [(at[i], at[j], at[j + n]), (at[i], at[j + n], at[i + n])]
    return [(c, b, a) for a, b, c in out] if inward else out


def room(plan: list, boxes: list) -> list:
    out = extrude(plan, 0, HEIGHT, False)
    for x0, y0, z0, x1, y1, z1 in boxes:
        out += extrude([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], z0, z1, True)
    return out


def middle(a: tuple, b: tuple) -> tuple:
    return tuple((s + t) / 2 for s, t in zip(a, b))


def refine(triangles: list, cell: float) -> list:
    """Quarters of all triangles until no edge is longer."""
    while max(math.dist(t[i], t[i - 1]) for t in triangles for i in range(3)) > cell:
        quarters = []
        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            quarters += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = quarters
    return triangles


def write(path: pathlib.Path, triangles: list) -> None:
    """An OBJ; the ceiling is a group."""
    number, lines, faces = {}, [], {"ceiling": [], "rest": []}
    for t in triangles:
        for p in t:
            if p not in number:
                number[p] = len(number) + 1
                lines.append("v " + " ".join(map(repr, map(float, p))))
        faces["ceiling" if all(p[1] == HEIGHT for p in t) else "rest"].append(" ".join(str(number[p]) for p in t))
    for name, list_ in faces.items():
        lines += [f"g {name}"] + [f"f {f}" for f in list_]
    path.write_text("\n".join(lines) + "\n")


def guard(program: str, model: pathlib.Path, out: pathlib.Path, *more: str) -> tuple:
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([program, "guard", model, *SENSOR, *more, "-o", out, "--quiet", "--threads", "1"], check=True)
    took = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    found = json.loads(out.read_text())
    return len(found["guards"]), found["coverage"]["area"], took


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build" / "starguard"))
    parser.add_argument("--cell", type=float, default=0.25)
    wanted = parser.parse_args()
    print("| room | triangles | cameras | seen | every point | s | fine | cameras | seen | s |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for room_name, (plan, boxes) in ROOMS.items():
            coarse = room(plan, boxes)
            fine = refine(coarse, wanted.cell)
            write(folder / "coarse.obj", coarse)
            write(folder / "fine.obj", fine)
            parts = guard(wanted.program, folder / "coarse.obj", folder / "coarse.json")
            points = guard(wanted.program, folder / "coarse.obj", folder / "points.json", "--target", "points")
            whole = guard(wanted.program, folder / "fine.obj", folder / "fine.json", "--patch", "off")
            print(f"| {room_name} | {len(coarse)} | {parts[0]} | {100 * parts[1]:.2f} % "
                  f"| {points[0]}: {100 * points[1]:.2f} % | {parts[2]:.1f} + {points[2]:.1f} "
                  f"| {len(fine)} | {whole[0]} | {100 * whole[1]:.2f} % | {whole[2]:.1f} |", flush=True)


if __name__ == "__main__":
    main()
