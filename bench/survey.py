#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Guards and cuts every model of a folder, verifies each result, and prints a table.

usage: survey.py STARGUARD FOLDER [--results FILE] [--only SUBFOLDER] [--limit S] [--threads N]
                 [--guards]

For each surface or tetrahedral file: its size; guards, proven bound, and the verdict of `verify`;
strict pieces, and the verdict of `verify`; processor seconds of both, of their verification, and
peak megabytes. Files that a command rejects are listed with status and message. Finished runs are
stored in FILE and not repeated. The table is Markdown; below it, the time of `verify` as a share of
that of `guard`. With --guards nothing is cut.

The exit status is 1 if a result was not verified, if a file outside nasty/ was not guarded (it may
only be rejected as unusable: see docs/formats.md), or if a command ended with anything but success or
a message with status 2 or 3.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile

SURFACES = (".off", ".obj", ".ply", ".stl")
SOLIDS = (".mesh", ".vtk", ".msh", ".node")
PATIENCE = 900  # seconds after which a command counts as hanging


def seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def call(words):
    """Runs a command of the program: status, processor seconds, and the --json report."""
    start = seconds()
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        return {"status": "hangs", "seconds": PATIENCE, "told": {}}
    took = seconds() - start
    try:
        told = json.loads(done.stdout)
    except ValueError:
        told = {"error": {"message": done.stderr.strip()[-200:]}}
    return {"status": done.returncode, "seconds": took, "told": told}


def verdict(options, *words):
    run = call([options.starguard, "verify", *words, "--json"])
    return {"verified": {0: "yes", 4: "NO"}.get(run["status"], "-"), "checked": run["seconds"]}


def megabytes(told):
    return told["memory"]["peak_resident_bytes"] / 2**20


def common(options):
    return ["--json", "--time-limit", str(options.limit), "--threads", str(options.threads)]


def guard(options, model, folder):
    result = os.path.join(folder, "guards.json")
    run = call([options.starguard, "guard", model, "-o", result, *common(options)])
    told = run["told"]
    if run["status"] != 0:
        return {"status": run["status"], "why": told["error"]["message"]}
    return {"status": 0, "seconds": run["seconds"], "megabytes": megabytes(told),
            "vertices": told["model"]["vertices"], "faces": told["model"]["faces"],
            "guards": len(told["guards"]), "bound": told["lower_bound"],
            **verdict(options, model, result)}


def cut(options, model, folder):
    grid, report = os.path.join(folder, "pieces.vtk"), os.path.join(folder, "pieces.json")
    run = call([options.starguard, "decompose", model, "-o", grid, "--report", report,
                *common(options)])
    told = run["told"]
    if run["status"] != 0:
        return {"status": run["status"], "why": told["error"]["message"]}
    return {"status": 0, "seconds": run["seconds"], "megabytes": megabytes(told),
            "pieces": len(told["pieces"]), "star": told["strictly_star"],
            "surface": told["surface"], **verdict(options, model, report, grid)}


def survey(options, path):
    """Both results of a file; tetrahedra are only cut."""
    with tempfile.TemporaryDirectory() as folder:
        solid = path.lower().endswith(SOLIDS)
        return {"guard": None if solid else guard(options, path, folder),
                "cut": None if options.guards else cut(options, path, folder)}


def cells_of(run, keys):
    if run is None:
        return ["-"] * (len(keys) + 4)
    if run["status"] != 0:
        return [f"status {run['status']}"] + ["-"] * (len(keys) + 3)
    return [*(f"{run[key]:,}" for key in keys), f"{run['seconds']:.1f}", f"{run['megabytes']:.0f}",
            run["verified"], f"{run['checked']:.1f}"]


def is_wrong(name, run):
    if run is None:
        return False
    if run["status"] != 0:
        return run["status"] not in (2, 3)
    return run["verified"] != "yes"


def find(options):
    for base, _, names in os.walk(os.path.join(options.folder, options.only)):
        for name in names:
            if name.lower().endswith(SURFACES + SOLIDS):
                yield os.path.join(base, name)


def load(path):
    if not path or not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        runs = [json.loads(line) for line in file]
    return {run["name"]: run for run in runs}


def show_shares(runs):
    """The time of `verify` of guards, beside that of `guard`."""
    shares = sorted((run["guard"]["checked"] / run["guard"]["seconds"], run["name"]) for run in runs
                    if run["guard"] and run["guard"]["status"] == 0)
    if shares:
        mean = sum(share for share, _ in shares) / len(shares)
        print(f"\n`verify` takes {mean:.2f} of the time of `guard` on average; most: "
              + ", ".join(f"{share:.2f} ({name})" for share, name in reversed(shares[-5:])))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("starguard")
    parser.add_argument("folder")
    parser.add_argument("--results", help="file of finished runs")
    parser.add_argument("--only", default="", help="this folder in FOLDER only")
    parser.add_argument("--limit", type=float, default=10, help="--time-limit of each command")
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--guards", action="store_true", help="cut nothing")
    options = parser.parse_args()
    known = load(options.results)
    head = ["model", "vertices", "guards", "bound", "s", "MB", "verified", "s", "pieces", "s", "MB",
            "verified", "s", "notes"]
    print("| " + " | ".join(head) + " |")
    print("|---" * len(head) + "|")
    wrong = 0
    runs = []
    for path in sorted(find(options)):
        name = os.path.relpath(path, options.folder)
        run = known.get(name)
        if run is None:
            run = dict(survey(options, path), name=name)
            if options.results:
                with open(options.results, "a", encoding="utf-8") as file:
                    file.write(json.dumps(run) + "\n")
        notes = [f"{word}: {part['why']}" for word, part in (("guard", run["guard"]),
                                                            ("decompose", run["cut"]))
                 if part and part["status"] != 0]
        if len(notes) == 2 and notes[0].split(": ", 1)[1] == notes[1].split(": ", 1)[1]:
            notes = [notes[0].split(": ", 1)[1]]
        runs.append(run)
        if run["cut"] and run["cut"]["status"] == 0 and run["cut"]["surface"] != "kept":
            notes.append("stuffed")
        shown = "; ".join(notes).replace(path, os.path.basename(path)).replace("|", "/")
        cells = [name, *cells_of(run["guard"], ["vertices", "guards", "bound"]),
                 *cells_of(run["cut"], ["pieces"]), " ".join(shown.split())]
        print("| " + " | ".join(cells) + " |", flush=True)
        bad = is_wrong(name, run["guard"]) or is_wrong(name, run["cut"])
        first = run["guard"] or run["cut"]
        refused = first and first["status"] != 0 and not name.startswith("nasty")
        if bad or refused:
            wrong += 1
            print(f"{name}: {'wrong' if bad else 'refused'}", file=sys.stderr)
    show_shares(runs)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
