#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Guards and pieces by effort: their number, the bound for all places, and processor seconds of one thread.

    bench/efforts.py [--new PROGRAM] [--old PROGRAM] [--command guard|decompose] [--each] [--every N] [--threads]
                     [--efforts EFFORT... --] [GROUP...]

Groups are folders of ../shared/data; without that folder, and with --samples, the program's own
samples are used, README's horse among them. --old is another version, by its defaults. --threads
also tells the time on the clock with one thread and with two. Bounds are those of guards; a line
counts the models with more guards, and with a lower bound, than by --old."""
import argparse
import json
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT.parent / "shared" / "data"
GROUPS = ["solids", "table2", "tosca_paper", "retrieval_shrec07", "retrieval_tosca"]
SAMPLES = ["horse", "human", "octopus", "gallery"]
EFFORTS = ["quick", "normal", "best"]
COUNTED = {"guard": "guards", "decompose": "pieces"}


def run(wanted, program: str, model: pathlib.Path, folder: pathlib.Path, options: list) -> tuple:
    """The number of guards or pieces, the bound, processor seconds, and seconds on the clock."""
    output, report = folder / "out.json", folder / "out.vtk"
    command = ([program, "guard", model, "-o", output] if wanted.command == "guard" else
               [program, "decompose", model, "-o", report, "--report", output])
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run([*map(str, command), "--quiet", *options], check=True)
    clock = time.monotonic() - began
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    took = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    result = json.loads(output.read_text())
    return len(result[COUNTED[wanted.command]]), result.get("lower_bound_everywhere") or 0, took, clock


def measure(wanted, model: pathlib.Path, folder: pathlib.Path) -> list:
    """For the old version, if there is one, and each effort."""
    ways = [(wanted.old, [])] * (wanted.old is not None)
    ways += [(wanted.new, ["--effort", effort]) for effort in wanted.efforts]
    row = []
    for program, options in ways:
        count, bound, took, clock = run(wanted, program, model, folder, [*options, "--threads", "1"])
        two = run(wanted, program, model, folder, [*options, "--threads", "2"])[3] if wanted.threads else 0
        row.append((count, bound, took, clock, two))
    return row


def say(wanted, name: str, rows: list) -> None:
    cells = []
    for column in zip(*rows):
        count, bound, took, one, two = (sum(values) for values in zip(*column))
        cells.append(f"{count} | {bound} | {took:.1f}" + (f" | {two / one:.2f}" if wanted.threads else ""))
    print(f"| {name} | {len(rows)} | {' | '.join(cells)} |", flush=True)


def compare(wanted, rows: list) -> None:
    for i, effort in enumerate(wanted.efforts, start=1):
        more = sum(row[i][0] > row[0][0] for row in rows)
        lower = sum(row[i][1] < row[0][1] for row in rows)
        print(f"{effort}: more than before on {more} models, a lower bound on {lower}", flush=True)


def models(wanted, folder: pathlib.Path) -> dict:
    if wanted.samples or not DATA.is_dir():
        made = {name: folder / f"{name}.off" for name in SAMPLES}
        for name, path in made.items():
            subprocess.run([wanted.new, "sample", name, "-o", str(path), "--quiet"], check=True)
        return {"samples": list(made.values())}
    return {group: sorted((DATA / group).glob("*.off"))[::wanted.every] for group in wanted.groups}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--new", default=str(ROOT / "build" / "starguard"))
    parser.add_argument("--old")
    parser.add_argument("--command", choices=COUNTED, default="guard")
    parser.add_argument("groups", nargs="*", default=GROUPS)
    parser.add_argument("--each", action="store_true", help="a line for each model")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--samples", action="store_true")
    parser.add_argument("--threads", action="store_true")
    parser.add_argument("--efforts", nargs="+", choices=EFFORTS, default=EFFORTS)
    wanted = parser.parse_args()
    what = COUNTED[wanted.command]
    heads = ["before"] * (wanted.old is not None) + wanted.efforts
    print("| models | number | " + " | ".join(f"{head}: {what} | bound | s" + " | two threads" * wanted.threads
                                              for head in heads) + " |")
    print("|---|" + "--:|" * (1 + len(heads) * (3 + wanted.threads)))
    everything = []
    with tempfile.TemporaryDirectory() as name:
        for group, paths in models(wanted, pathlib.Path(name)).items():
            rows = []
            for path in paths:
                rows.append(measure(wanted, path, pathlib.Path(name)))
                if wanted.each:
                    say(wanted, path.stem, rows[-1:])
            if rows:
                say(wanted, group, rows)
            everything += rows
    say(wanted, "all", everything)
    if wanted.old:
        compare(wanted, everything)


if __name__ == "__main__":
    sys.exit(main())
