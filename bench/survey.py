#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Guards and cuts every model of a folder, verifies each result, and prints a table.

usage: survey.py STARGUARD FOLDER [--results FILE] [--only SUBFOLDER] [--limit S] [--threads N]

For each surface or tetrahedral file: its size; guards, proven bound, and the verdict of `verify`;
strict pieces, and the verdict of `verify`; seconds (elapsed) and peak megabytes of both. Files that a
command rejects are listed with status and message. Finished runs are stored in FILE and not repeated.
The table is Markdown.

The exit status is 1 if a result was not verified, if a file outside nasty/ was not guarded (it may
only be rejected as unusable: see docs/formats.md), or if a command ended with anything but success or
a message with status 2 or 3.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

SURFACES = (".off", ".obj", ".ply", ".stl")
SOLIDS = (".mesh", ".vtk", ".msh", ".node")
PATIENCE = 900  # seconds after which a command counts as hanging


def call(words):
    """Runs a command of the program: status, seconds, and the --json report."""
    start = time.monotonic()
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        return {"status": "hangs", "seconds": PATIENCE, "told": {}}
    seconds = time.monotonic() - start
    try:
        told = json.loads(done.stdout)
    except ValueError:
        told = {"error": {"message": done.stderr.strip()[-200:]}}
    return {"status": done.returncode, "seconds": seconds, "told": told}


def verdict(options, *words):
    status = call([options.starguard, "verify", *words, "--json"])["status"]
    return {0: "yes", 4: "NO"}.get(status, "-")


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
            "verified": verdict(options, model, result)}


def cut(options, model, folder):
    grid, report = os.path.join(folder, "pieces.vtk"), os.path.join(folder, "pieces.json")
    run = call([options.starguard, "decompose", model, "-o", grid, "--report", report,
                *common(options)])
    told = run["told"]
    if run["status"] != 0:
        return {"status": run["status"], "why": told["error"]["message"]}
    return {"status": 0, "seconds": run["seconds"], "megabytes": megabytes(told),
            "pieces": len(told["pieces"]), "star": told["strictly_star"],
            "surface": told["surface"], "verified": verdict(options, model, report, grid)}


def survey(options, path):
    """Both results of a file; tetrahedra are only cut."""
    with tempfile.TemporaryDirectory() as folder:
        solid = path.lower().endswith(SOLIDS)
        return {"guard": None if solid else guard(options, path, folder),
                "cut": cut(options, path, folder)}


def cells_of(run, keys):
    if run is None:
        return ["-"] * (len(keys) + 3)
    if run["status"] != 0:
        return [f"status {run['status']}"] + ["-"] * (len(keys) + 2)
    return [*(f"{run[key]:,}" for key in keys), run["verified"], f"{run['seconds']:.1f}",
            f"{run['megabytes']:.0f}"]


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


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("starguard")
    parser.add_argument("folder")
    parser.add_argument("--results", help="file of finished runs")
    parser.add_argument("--only", default="", help="this folder in FOLDER only")
    parser.add_argument("--limit", type=float, default=10, help="--time-limit of each command")
    parser.add_argument("--threads", type=int, default=0)
    options = parser.parse_args()
    known = load(options.results)
    head = ["model", "vertices", "guards", "bound", "verified", "s", "MB", "pieces", "verified", "s",
            "MB", "notes"]
    print("| " + " | ".join(head) + " |")
    print("|---" * len(head) + "|")
    wrong = 0
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
        if run["cut"]["status"] == 0 and run["cut"]["surface"] != "kept":
            notes.append("stuffed")
        shown = "; ".join(notes).replace(path, os.path.basename(path)).replace("|", "/")
        cells = [name, *cells_of(run["guard"], ["vertices", "guards", "bound"]),
                 *cells_of(run["cut"], ["pieces"]), " ".join(shown.split())]
        print("| " + " | ".join(cells) + " |", flush=True)
        bad = is_wrong(name, run["guard"]) or is_wrong(name, run["cut"])
        refused = (run["guard"] or run["cut"])["status"] != 0 and not name.startswith("nasty")
        if bad or refused:
            wrong += 1
            print(f"{name}: {'wrong' if bad else 'refused'}", file=sys.stderr)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
