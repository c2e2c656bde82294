#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a unit of work takes: microseconds on the clock of a quiet machine, one thread, over sizes of models
and kinds of search.

    bench/units.py [--program PROGRAM] [MODEL...]

Budgets count units, which are to take about a microsecond, within a factor of two, on tiny and on
large models. Without models, samples of three sizes are used, a comb of cubes, and a soup with faces that nobody sees."""
import argparse
import json
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
KINDS = {
    "refinement": ["guard", "--refine-lines", "1500000"],
    "whole faces": ["guard", "--refine-lines", "1500000", "--faces", "whole"],
    "limit of guards": ["guard", "--max-guards", "3", "--prove", "--prove-work", "3000000"],
    "proof": ["guard", "--prove", "--prove-work", "3000000"],
    "unseen": ["visible", "--unseen", "--work", "3000000"],
}


def comb(path: pathlib.Path, teeth: int = 8) -> pathlib.Path:
    """A bar with cubes on every second of its cubes, as faces of voxels."""
    cells = {(x, 0, 0) for x in range(2 * teeth)} | {(2 * x, 0, 1) for x in range(teeth)}
    vertices, faces = {}, []
    for cell in sorted(cells):
        for axis in range(3):
            for side in (0, 1):
                beside = tuple(c + (2 * side - 1) * (k == axis) for k, c in enumerate(cell))
                if beside in cells:
                    continue
                u, v = (axis + 1) % 3, (axis + 2) % 3
                ring = []
                for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    corner = list(cell)
                    corner[axis] += side
                    corner[u] += a
                    corner[v] += b
                    ring.append(vertices.setdefault(tuple(corner), len(vertices)))
                ring = ring if side else ring[::-1]
                faces += [(ring[0], ring[1], ring[2]), (ring[0], ring[2], ring[3])]
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += ["%d %d %d" % v for v in vertices] + ["3 %d %d %d" % f for f in faces]
    path.write_text("\n".join(lines) + "\n")
    return path


def samples(program: str, folder: pathlib.Path) -> list:
    made = [comb(folder / "comb.off")]
    for name, size in (("gallery", 500), ("octopus", 3000), ("horse", 12000)):
        made.append(folder / f"{name}.off")
        subprocess.run([program, "sample", name, "--vertices", str(size), "-o", str(made[-1]), "--quiet"],
                       check=True)
    made.append(folder / "soup_statue.off")
    subprocess.run([program, "sample", "statue", "-o", str(made[-1]), "--quiet"], check=True)
    return made


def unit(program: str, model: pathlib.Path, options: list, folder: pathlib.Path) -> str:
    out = ["-o", str(folder / "g.json")] * (options[0] == "guard")
    soup = ["--soup"] * model.stem.startswith("soup")
    ran = subprocess.run([program, options[0], str(model), *options[1:], *soup, *out, "--json", "--threads", "1",
                          "--quiet"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    if ran.returncode != 0:
        return "-"
    told = json.loads(ran.stdout)
    seconds = told["seconds"]
    total = seconds.pop("total")
    spent = seconds["search"] if "search" in seconds else total - sum(seconds.values())
    work = told["counted_work"]
    return f"{1e6 * spent / work:.2f}" if work > 100000 else "-"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build" / "starguard"))
    parser.add_argument("models", nargs="*", type=pathlib.Path)
    wanted = parser.parse_args()
    print("| model | " + " | ".join(KINDS) + " |\n|---|" + "--:|" * len(KINDS))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for model in wanted.models or samples(wanted.program, folder):
            units = [unit(wanted.program, model, options, folder) for options in KINDS.values()]
            print(f"| {model.stem} | " + " | ".join(units) + " |", flush=True)


if __name__ == "__main__":
    main()
