#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reproduces the paper's tables and figures [YL11].

usage: paper.py COMMAND STARGUARD DATA [options]

  table1     guards and seconds of ILP, greedy, PILP, PILP with refinement, and guards anywhere;
             --coverage 0.99
  table2     skeletal against tetrahedral candidates and a lattice, proven optima
  figure1    stability of the guards under noise on the boundary
  figure2    greedy against PILP over many models; --svg FILE draws it
  figure3    pictures of guarded models into the folder --pictures FOLDER
  growth     cost of a point's visibility against the number of vertices, engine by engine

DATA is the folder of models. Every guards file is verified. Tables are Markdown.
"""
import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
import time

# The paper's Table 1: guards by ILP, greedy, PILP, and seconds; other meshes of the same shapes.
PAPER1 = {
    "david": (16, 22, 17, 107391.2, 233.9, 235.2),
    "cat": (14, 19, 15, 3173, 375.4, 393.1),
    "wolf": (13, 18, 15, 8044, 328.1, 349.9),
    "dog": (None, 39, 27, None, 412.3, 433.2),
    "victoria": (None, 35, 27, None, 408.7, 421.2),
    "horse": (None, 38, 29, None, 376.1, 384.2),
    "michael": (None, 46, 31, None, 321.0, 332.9),
    "gorilla": (None, 60, 46, None, 462.4, 490.1),
    "centaur": (None, 52, 32, None, 488.1, 514.5),
    "female": (13, 18, 14, 2046.2, 264.2, 281.1),
    "male": (14, 16, 15, 3074.3, 298.6, 310.2),
}
# Table 2: tetrahedral vertices; guards with all of them and with skeletal nodes as candidates.
PAPER2 = {"kitten_400": (1682, 3, 3), "beethoven_502": (2895, 2, 2), "bimba_752": (5115, 2, 2),
          "buddha_502": (3002, 2, 2), "bunny_998": (8320, 5, 5)}
METHODS = {
    "ilp": ["--method", "ilp"],
    "greedy": ["--method", "greedy"],
    "pilp": ["--method", "pilp", "--no-refine"],
    "refined": ["--method", "pilp"],
    "anywhere": ["--prove"],
}


class Guards:
    """One run of the program: its file and its report."""

    def __init__(self, program, model, words, keep=None):
        with tempfile.TemporaryDirectory() as folder:
            path = keep or os.path.join(folder, "guards.json")
            start = time.monotonic()
            done = subprocess.run([program, "guard", model, "-o", path, "--json"] + words,
                                  capture_output=True, text=True, check=False)
            self.seconds = time.monotonic() - start
            if done.returncode != 0:
                raise RuntimeError(f"{model}: {done.stderr.strip() or done.stdout[:300]}")
            self.told = json.loads(done.stdout)
            with open(path, encoding="utf-8") as file:
                self.file = json.load(file)
            verdict = subprocess.run([program, "verify", model, path, "--quiet"], check=False)
            if verdict.returncode != 0:
                raise RuntimeError(f"{model}: not verified")
        self.count = len(self.file["guards"])
        self.bound = self.file["lower_bound"]
        self.positions = [tuple(g["position"]) for g in self.file["guards"]]
        self.megabytes = self.told["memory"]["peak_resident_bytes"] / 2**20

    def mark(self):
        """The number of guards, starred if proven the fewest of the candidates."""
        return f"{self.count}{'*' if self.file['optimal'] else ''}"

    def mark_anywhere(self):
        """The number of guards, and how many are needed wherever they stand."""
        return f"{self.count} / {self.file['lower_bound_everywhere']}"


def anywhere(options, model):
    """Guards at any point, with the budget of --work."""
    return Guards(options.starguard, model, METHODS["anywhere"] + ["--prove-work", options.work])


def models_of(data, *folders):
    found = []
    for folder in folders:
        path = os.path.join(data, folder)
        found += [os.path.join(path, n) for n in sorted(os.listdir(path)) if n.endswith(".off")]
    return found


def short(path):
    return os.path.splitext(os.path.basename(path))[0]


def vertices_of(guards):
    return guards.file["model"]["vertices"]


def paper_row(name):
    key = name.rstrip("0123456789_")
    row = PAPER1.get(key)
    if row is None:
        return "-"
    return " / ".join("-" if n is None else str(n) for n in row[:3])


def table1(options):
    """Partial coverage is not refined, and its integer program does not finish: limited to 20 seconds."""
    whole = options.coverage == "1"
    methods = ["ilp", "greedy", "pilp"] + (["refined"] if whole else [])
    head = [f"{m} | s" for m in methods]
    more = "anywhere: guards / bound | s | " if whole else ""
    print(f"| model | vertices | {' | '.join(head)} | {more}levels s | MB "
          "| paper: ILP / greedy / PILP |")
    print("|---" * (2 * len(methods) + (7 if whole else 5)) + "|")
    counts = []
    for model in models_of(options.data, "tosca_paper", "table1_extra"):
        runs = {}
        for method in methods:
            words = METHODS[method] + ["--coverage", options.coverage]
            limit = ["--time-limit", "120" if whole else "20"]
            runs[method] = Guards(options.starguard, model, words + limit)
        seconds = runs["pilp"].told["seconds"]
        making = seconds.get("levels", 0) + seconds.get("simplify", 0)
        cells = [f"{runs[m].mark()} | {runs[m].seconds:.1f}" for m in methods]
        if whole:
            last = anywhere(options, model)
            cells.append(f"{last.mark_anywhere()} | {last.seconds:.1f}")
        print(f"| {short(model)} | {vertices_of(runs['ilp']):,} | {' | '.join(cells)} | "
              f"{making:.1f} | {runs['pilp'].megabytes:.0f} | {paper_row(short(model))} |",
              flush=True)
        counts.append({m: runs[m].count for m in methods})
    print()
    for first, second in (("pilp", "ilp"), ("pilp", "greedy"), ("refined", "ilp")):
        if first not in methods:
            continue
        ratios = [c[first] / c[second] for c in counts]
        print(f"{first} / {second}: {sum(ratios) / len(ratios):.3f} in the mean; above it on "
              f"{sum(r > 1 for r in ratios)}, below it on {sum(r < 1 for r in ratios)} of "
              f"{len(ratios)}.")


def tetrahedral_vertices(options, model, wanted):
    """Interior vertices of a tetrahedral mesh with about `wanted` vertices in total."""
    with open(model, encoding="utf-8") as file:
        surface = int(file.read().split()[1])
    density = 12.0
    with tempfile.TemporaryDirectory() as folder:
        grid = os.path.join(folder, "t.vtk")
        for _ in range(8):
            subprocess.run([options.starguard, "decompose", model, "-o", grid, "--mode", "paper",
                            "--generator", "tetgen", "--density", f"{density:.3f}", "--quiet"],
                           check=True)
            points = read_vtk_points(grid)
            if abs(len(points) - wanted) < 0.03 * wanted:
                break
            density *= (wanted - surface) / max(1, len(points) - surface)
    return points


def read_vtk_points(path):
    """The points of a legacy VTK file in text."""
    with open(path, encoding="utf-8") as file:
        words = file.read().split()
    at = words.index("POINTS")
    count = int(words[at + 1])
    return [words[at + 3 + 3 * i:at + 6 + 3 * i] for i in range(count)]


def guards_at(options, model, points):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "points.xyz")
        with open(path, "w", encoding="utf-8") as file:
            file.writelines(" ".join(p) + "\n" for p in points)
        return Guards(options.starguard, model, ["--method", "ilp", "--candidates", path])


def inside_of(model, points):
    """The points that are not vertices of the surface."""
    with open(model, encoding="utf-8") as file:
        words = file.read().split()
    surface = {tuple(map(float, words[4 + 3 * i:7 + 3 * i])) for i in range(int(words[1]))}
    return [p for p in points if tuple(map(float, p)) not in surface]


def table2(options):
    print("| model | vertices | tetrahedral vertices | of them inside | guards | "
          "skeletal candidates | guards | lattice | guards | refined | anywhere: guards / bound | "
          "paper: tetrahedral vertices | guards: tetrahedral / skeletal |")
    print("|---" * 13 + "|")
    for name, paper in PAPER2.items():
        model = os.path.join(options.data, "table2", name + ".off")
        skeletal = Guards(options.starguard, model, ["--method", "ilp"])
        lattice = Guards(options.starguard, model, ["--method", "ilp", "--candidates", "interior",
                                                    "--count", "8000"])
        every = tetrahedral_vertices(options, model, paper[0])
        inside = inside_of(model, every)
        tetrahedral = guards_at(options, model, inside)
        refined = Guards(options.starguard, model, [])
        print(f"| {name} | {vertices_of(skeletal):,} | {len(every):,} | {len(inside):,} | "
              f"{tetrahedral.mark()} | {skeletal.file['candidates']:,} | {skeletal.mark()} | "
              f"{lattice.file['candidates']:,} | {lattice.mark()} | {refined.mark()} | "
              f"{anywhere(options, model).mark_anywhere()} | {paper[0]:,} | {paper[1]} / {paper[2]} |",
              flush=True)


def read_off(path):
    with open(path, encoding="utf-8") as file:
        words = file.read().split()
    count, faces = int(words[1]), int(words[2])
    values = [float(w) for w in words[4:4 + 3 * count]]
    rest = words[4 + 3 * count:4 + 3 * count + 4 * faces]
    return [values[3 * i:3 * i + 3] for i in range(count)], rest


def write_noisy(path, vertices, rest, size, seed):
    """Moves every vertex by a random vector in a ball of the given radius."""
    draw = random.Random(seed)
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"OFF\n{len(vertices)} {len(rest) // 4} 0\n")
        for v in vertices:
            while True:
                shift = [draw.uniform(-1, 1) for _ in range(3)]
                if sum(s * s for s in shift) <= 1:
                    break
            file.write(" ".join(repr(x + size * s) for x, s in zip(v, shift)) + "\n")
        for i in range(0, len(rest), 4):
            file.write(" ".join(rest[i:i + 4]) + "\n")


def same(first, second, near):
    """Number of the first points with one of the second within `near`."""
    return sum(any(sum((a - b) ** 2 for a, b in zip(p, q)) <= near * near for q in second)
               for p in first)


def figure1(options):
    print("| model | noise | greedy: guards, kept | PILP: guards, kept | "
          "PILP, coarsest level: guards, kept |")
    print("|---|---|---|---|---|")
    shares = {"greedy": [], "pilp": [], "coarse": []}
    names = ("tosca_paper/centaur0", "tosca_paper/david0", "tosca_paper/cat0",
             "tosca_paper/victoria0")
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            model = os.path.join(options.data, name + ".off")
            vertices, rest = read_off(model)
            diagonal = sum((max(v[k] for v in vertices) - min(v[k] for v in vertices)) ** 2
                           for k in range(3)) ** 0.5
            noisy = os.path.join(folder, "noisy.off")
            first = {m: Guards(options.starguard, model, METHODS[m]) for m in ("greedy", "pilp")}
            write_noisy(noisy, vertices, rest, options.noise / 100 * diagonal, 1)
            second = {m: Guards(options.starguard, noisy, METHODS[m]) for m in ("greedy", "pilp")}
            near = options.near * diagonal
            cells = []
            for m in ("greedy", "pilp"):
                kept = same(first[m].positions, second[m].positions, near)
                shares[m].append(kept / first[m].count)
                cells.append(f"{first[m].count}, {kept} ({100 * kept / first[m].count:.0f} %)")
            coarse = [[tuple(p) for p in r["pilp"].file["levels"][0]["guards"]]
                      for r in (first, second)]
            kept = same(coarse[0], coarse[1], near)
            shares["coarse"].append(kept / len(coarse[0]))
            cells.append(f"{len(coarse[0])}, {kept} ({100 * kept / len(coarse[0]):.0f} %)")
            print(f"| {short(model)} | {options.noise} % | " + " | ".join(cells) + " |",
                  flush=True)
    print("\nMeans: " + ", ".join(f"{k} {100 * sum(v) / len(v):.0f} %" for k, v in shares.items())
          + f". Kept: another guard within {100 * options.near:g} % of the diagonal.")


def draw_bars(path, rows):
    """Figure 2 as SVG: bars for each model, and a line for how many are needed anywhere."""
    width, height, left, bottom = 12 * len(rows) + 60, 260, 40, 90
    top = max(r[1] for r in rows)
    scale = (height - 20) / top
    with open(path, "w", encoding="utf-8") as file:
        file.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" '
                   f'height="{height + bottom}" font-family="sans-serif" font-size="9">\n'
                   f'<rect width="100%" height="100%" fill="white"/>\n')
        for tick in range(0, top + 1, 10):
            y = height - tick * scale
            file.write(f'<line x1="{left}" x2="{width}" y1="{y:.1f}" y2="{y:.1f}" '
                       f'stroke="#ddd"/><text x="{left - 4}" y="{y + 3:.1f}" '
                       f'text-anchor="end">{tick}</text>\n')
        for i, (name, *counts) in enumerate(rows):
            x = left + 12 * i + 2
            for k, color in enumerate(("#c44", "#46a", "#4a6")):
                h = counts[k] * scale
                file.write(f'<rect x="{x + 3 * k}" y="{height - h:.1f}" width="3" '
                           f'height="{h:.1f}" fill="{color}"/>\n')
            y = height - counts[3] * scale
            file.write(f'<line x1="{x}" x2="{x + 9}" y1="{y:.1f}" y2="{y:.1f}" stroke="black"/>')
            file.write(f'<text transform="translate({x + 6},{height + 5}) rotate(90)">{name}'
                       '</text>\n')
        for k, (word, color) in enumerate((("greedy", "#c44"), ("PILP", "#46a"),
                                           ("anywhere", "#4a6"), ("needed", "black"))):
            file.write(f'<rect x="{left + 10 + 90 * k}" y="6" width="8" height="8" '
                       f'fill="{color}"/><text x="{left + 22 + 90 * k}" y="13">{word}</text>\n')
        file.write("</svg>\n")


def figure2(options):
    rows = []
    print("| model | greedy | PILP | refined | anywhere | needed |\n|---|---|---|---|---|---|")
    for model in models_of(options.data, "retrieval_tosca", "retrieval_shrec07"):
        counts = [Guards(options.starguard, model, METHODS[m]).count
                  for m in ("greedy", "pilp", "refined")]
        last = anywhere(options, model)
        rows.append((short(model), *counts, last.count, last.file["lower_bound_everywhere"]))
        print(f"| {short(model)} | " + " | ".join(map(str, rows[-1][1:])) + " |", flush=True)
    mean = [sum(r[k] / r[1] for r in rows) / len(rows) for k in (2, 3, 4)]
    print(f"\n{len(rows)} models: PILP / greedy {mean[0]:.3f}, refined / greedy {mean[1]:.3f}, "
          f"anywhere / greedy {mean[2]:.3f} in the mean; PILP above greedy on "
          f"{sum(r[2] > r[1] for r in rows)}; proven on {sum(r[4] == r[5] for r in rows)}.")
    if options.svg:
        draw_bars(options.svg, [(r[0], r[1], r[2], r[4], r[5]) for r in rows])


def figure3(options):
    os.makedirs(options.pictures, exist_ok=True)
    for model in models_of(options.data, "tosca_paper"):
        picture = os.path.join(options.pictures, short(model) + ".png")
        Guards(options.starguard, model, ["--picture", picture])
        print(picture)


def growth(options):
    """Seconds per point, on samples of one shape at several sizes."""
    print("| vertices | grid us | tree us | sweep us | sweep us / (N log2 N) x 1e3 |")
    print("|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for vertices in (1000, 2000, 5000, 10000, 20000, 50000, 100000):
            model = os.path.join(folder, "model.off")
            subprocess.run([options.starguard, "sample", "human", "--vertices", str(vertices),
                            "-o", model, "--quiet"], check=True)
            cells = []
            for engine in ("grid", "bvh", "sweep"):
                points = max(8, min(400, 400000 // vertices))
                run = Guards(options.starguard, model,
                             ["--method", "greedy", "--candidates", "interior", "--count",
                              str(points), "--coverage", "0.5", "--threads", "1",
                              "--visibility", engine])
                cells.append(1e6 * run.told["seconds"]["visibility"] / run.file["candidates"])
                size = vertices_of(run)
            law = 1e3 * cells[2] / (size * max(1, size.bit_length() - 1))
            print(f"| {size:,} | " + " | ".join(f"{c:.0f}" for c in cells) + f" | {law:.1f} |",
                  flush=True)


COMMANDS = {f.__name__: f for f in (table1, table2, figure1, figure2, figure3, growth)}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=COMMANDS)
    parser.add_argument("starguard")
    parser.add_argument("data")
    parser.add_argument("--coverage", default="1", help="table1: fraction to be seen, 1 or below")
    parser.add_argument("--work", default="90000000", help="anywhere: as of guard --prove-work")
    parser.add_argument("--svg", help="figure2: where to draw the bars")
    parser.add_argument("--pictures", default="pictures", help="figure3: folder for pictures")
    parser.add_argument("--noise", type=float, default=0.5, help="figure1: per cent of the diagonal")
    parser.add_argument("--near", type=float, default=0.01,
                        help="figure1: how far, in diagonals, a guard may be to be the same")
    options = parser.parse_args()
    COMMANDS[options.command](options)


if __name__ == "__main__":
    sys.exit(main())
