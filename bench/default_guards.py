#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Guards with default options, by two versions of the program: their number, and processor seconds.

    bench/default_guards.py OLD [NEW] [--each] [--every N] [GROUP...]

Groups are folders of ../shared/data; of the retrieval sets every tenth model is used (--every)."""
import argparse
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT.parent / "shared" / "data"
GROUPS = ["solids", "table2", "tosca_paper", "retrieval_shrec07", "retrieval_tosca"]


def seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def guard(program: str, model: pathlib.Path, output: pathlib.Path) -> tuple[int, float]:
    before = seconds()
    subprocess.run([program, "guard", str(model), "-o", str(output), "--threads", "1", "--quiet"],
                   check=True)
    took = seconds() - before
    return len(json.loads(output.read_text())["guards"]), took


def say(name: str, rows: list) -> None:
    olds, news = sum(row[0] for row in rows), sum(row[1] for row in rows)
    mean = sum(row[1] / row[0] for row in rows) / len(rows)
    before, after = sum(row[2] for row in rows), sum(row[3] for row in rows)
    print(f"| {name} | {len(rows)} | {olds} | {news} | {100 * (mean - 1):+.1f} % "
          f"| {sum(row[1] < row[0] for row in rows)} | {sum(row[1] > row[0] for row in rows)} "
          f"| {before:.1f} | {after:.1f} | {after / before:.2f} |")
    sys.stdout.flush()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("old")
    parser.add_argument("new", nargs="?", default=str(ROOT / "build" / "starguard"))
    parser.add_argument("groups", nargs="*", default=GROUPS)
    parser.add_argument("--each", action="store_true", help="a line for each model")
    parser.add_argument("--every", type=int, default=10)
    wanted = parser.parse_args()
    print("| models | number | guards before | after | mean of ratios | fewer | more | s before "
          "| s after | ratio |\n|---|---|---|---|---|---|---|---|---|---|")
    everything = []
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder) / "g.json"
        for group in wanted.groups:
            models = sorted((DATA / group).glob("*.off"))
            if group.startswith("retrieval"):
                models = models[::wanted.every]
            rows = []
            for model in models:
                (old, before), (new, after) = (guard(program, model, output)
                                               for program in (wanted.old, wanted.new))
                rows.append((old, new, before, after))
                if wanted.each:
                    say(model.stem, rows[-1:])
            if rows:
                say(group, rows)
            everything += rows
    say("all", everything)


if __name__ == "__main__":
    main()
