#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Guards at any point of a solid, and lower bounds: guards and bounds of `guard --prove`, with cells,
witnesses and processor seconds; and certificates of the bounds: their size, reasons, and seconds to
check them.

    bench/prove.py [--work N] [MODEL...]

Without models: those of docs/BENCHMARKS.md that are available in ../shared/data."""
import argparse
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT.parent / "shared" / "data"
MODELS = [
    "table2/kitten_400", "cad/three_torus", "solids/hand_1197", "solids/spot", "table2/bunny_998",
    "solids/knight_502", "solids/eight", "solids/3holes", "solids/hand_8k", "tosca_paper/wolf0",
    "retrieval_shrec07/teddy_161", "retrieval_shrec07/fish_221", "retrieval_shrec07/fourleg_382",
    "solids/cactus", "cad/fandisk", "cad/joint", "retrieval_shrec07/plier_201",
    "retrieval_shrec07/airplane_062", "retrieval_shrec07/hand_182", "solids/elephant_g0",
    "retrieval_shrec07/human_001", "cad/pinion", "cad/anchor", "retrieval_tosca/wolf_00",
    "retrieval_shrec07/bust_309", "solids/horse_12k"]


def seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def guard(program: str, model: pathlib.Path, output: pathlib.Path, *options: str) -> dict:
    before = seconds()
    done = subprocess.run([program, "guard", str(model), "-o", str(output),
                           "--quiet", "--json", *options], stdout=subprocess.PIPE, check=True)
    told = json.loads(done.stdout)
    told["took"] = seconds() - before
    return told


def verify(program: str, *files: pathlib.Path) -> float:
    before = seconds()
    subprocess.run([program, "verify", *map(str, files), "--quiet", "--threads", "1"], check=True)
    return seconds() - before


def reasons(certificate: pathlib.Path) -> int:
    """All words but the first of the cell lines."""
    lines = certificate.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("cells "))
    return sum(line.count(" ") for line in lines[first + 1:first + 1 + int(lines[first][6:])])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--work", help="as of guard --prove-work")
    parser.add_argument("--threads", default="1")
    parser.add_argument("--program", default=str(ROOT / "build" / "starguard"))
    parser.add_argument("models", nargs="*", type=pathlib.Path)
    wanted = parser.parse_args()
    models = wanted.models or [path for name in MODELS if (path := DATA / f"{name}.off").exists()]
    more = ["--prove-work", wanted.work] if wanted.work else []
    print("| model | faces | candidates: guards / bound | everywhere: guards / bound | cells "
          "| witnesses | s before | s in all | certificate: kB | reasons | s to verify |\n"
          "|---|---|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        output, why = pathlib.Path(folder) / "g.json", pathlib.Path(folder) / "why.txt"
        for model in models:
            first = guard(wanted.program, model, output, "--threads", wanted.threads)
            best = guard(wanted.program, model, output, "--threads", wanted.threads, "--prove",
                         "--certificate", str(why), *more)
            checked = verify(wanted.program, model, output, why) - verify(wanted.program, model, output)
            print(f"| {model.stem} | {best['model']['faces']:,} "
                  f"| {len(first['guards'])} / {first['lower_bound']} "
                  f"| {len(best['guards'])} / {best['lower_bound_everywhere']} "
                  f"| {best.get('cells', 0):,} | {best.get('witnesses', 0)} "
                  f"| {first['took']:.1f} | {best['took']:.1f} "
                  f"| {why.stat().st_size / 1000:,.0f} | {reasons(why):,} | {checked:.2f} |")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
