#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Set covers of 10,000 to 200,000 elements: plain greedy, our cover, CBC alone.

    bench/set_covers.py [--program PROGRAM] [--solver BENCH_SET_COVER] [--seconds S] [--keep FOLDER]
                        [NAME...]

Instances are in the plain text of the public OCP/USCP benchmark (numbers of elements and sets; of each
element its number, how many sets hold it, and which): caps of a sphere by bench_set_cover, and what
candidates see of the faces of samples by `guard --matrix`. S seconds limit each solver, on one thread; one that
does not end within six times as long is ended. FOLDER keeps the files; NAMEs choose among the instances. A line of a table for each: sizes, and of each method sets, bound and seconds."""
import argparse
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
#       elements, sets, smallest and largest share of the sphere, seed
CAPS = [(10000, 200, 0.02, 0.1, 1), (10000, 1000, 0.02, 0.1, 2), (50000, 300, 0.02, 0.1, 3), (50000, 1000, 0.05, 0.2, 4),
        (200000, 300, 0.02, 0.1, 5), (200000, 1000, 0.01, 0.04, 6)]
#         sample, vertices, candidates
MATRICES = [("gallery", 5000, 300), ("octopus", 5000, 300), ("horse", 25000, 300), ("human", 100000, 200)]


def solve(solver: str, file: pathlib.Path, seconds: float) -> str:
    """What the solver tells, as far as it comes."""
    try:
        return subprocess.run([solver, "solve", file, str(seconds)], check=True, capture_output=True, text=True,
                              timeout=8 * seconds).stdout
    except subprocess.TimeoutExpired as ended:
        return (ended.stdout or b"").decode()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build" / "starguard"))
    parser.add_argument("--solver", default=str(ROOT / "build" / "bench" / "bench_set_cover"))
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--keep", default=None)
    parser.add_argument("names", nargs="*")
    wanted = parser.parse_args()
    print("| instance | elements | sets | entries | greedy | s | our cover | s | CBC alone | s |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(wanted.keep or scratch)
        folder.mkdir(exist_ok=True)
        jobs = [(f"caps {e:,} x {s:,}", e, s, low, high, seed) for e, s, low, high, seed in CAPS] + \
               [(f"{name} {count:,}", name, count, candidates) for name, count, candidates in MATRICES]
        for name, *job in [job for job in jobs if not wanted.names or job[0] in wanted.names]:
            file = folder / (name.replace(" ", "-").replace(",", "") + ".txt")
            if len(job) == 5:
                subprocess.run([wanted.solver, "make", *map(str, job), file], check=True)
            else:
                model = folder / "model.off"
                subprocess.run([wanted.program, "sample", job[0], "--vertices", str(job[1]), "-o", model, "--quiet"], check=True)
                subprocess.run([wanted.program, "guard", model, "--method", "greedy", "--candidates", "interior", "--count",
                                str(job[2]), "--max-guards", "1", "--matrix", file, "-o", folder / "g.json", "--quiet"],
                               check=True)
            told = solve(wanted.solver, file, wanted.seconds).splitlines()
            elements, sets, entries = map(int, told[0].split()[1:])
            cells = []
            for line in told[1:]:
                _, count, bound, seconds, *state = line.split()
                if state not in (["cover"], ["none"]):
                    raise SystemExit(f"{name}: {line}")
                known = f", at least {bound}" if bound not in ("0", count) else " (optimal)" if bound == count else ""
                cells += [f"{count}{known}" if state == ["cover"] else f"none{known}", f"{float(seconds):.1f}"]
            cells += ["none", "ended"] * (3 - len(cells) // 2)
            print(f"| {name} | {elements:,} | {sets:,} | {entries:,} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
