#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Star decomposition of many models: one table.

usage: decompose.py STARGUARD DATA [MODEL ...] [--results FILE] [--seeds N] [--limit S]
                    [--modes paper,strict]

DATA is the folder of models (those of its folder `solids` are cut), MODEL the names of some of them.
For each: tetrahedra; guards of the best cover; pieces in paper mode and how many of them are
star-shaped; pieces in strict mode over the seeds, median and spread; seconds and megabytes; whether
the results are verified; and results of other open programs.

Finished runs are stored in FILE and not repeated, so an interrupted table can be continued. The table
is Markdown.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

# Pieces and seconds of other open programs: breadth-first growth from random tetrahedra, one linear
# program each; a quarter of their pieces are single tetrahedra.
PEERS = {"hand_1197": (72, 7.8), "elephant_g3": (51, 20), "knot1": (25, 22), "homer": (133, 157),
         "femur_g2": (299, 261)}
# Excluded from mean ratios: their shapes need more pieces than guards.
APART = ("homer", "octopus_124")


class Results:
    """Finished runs by (model, what, seed), stored in a file with one JSON object per line."""

    def __init__(self, path):
        self.path = path
        self.runs = {}
        if path and os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                for line in file:
                    run = json.loads(line)
                    self.runs[tuple(run["key"])] = run

    def get(self, key, make):
        if key not in self.runs:
            run = dict(make(), key=list(key))
            self.runs[key] = run
            if self.path:
                with open(self.path, "a", encoding="utf-8") as file:
                    file.write(json.dumps(run) + "\n")
        return self.runs[key]


def call(words):
    """Runs the program with --json: its report, or why it failed."""
    start = time.monotonic()
    done = subprocess.run(words + ["--json"], capture_output=True, text=True, check=False)
    seconds = time.monotonic() - start
    try:
        told = json.loads(done.stdout)
    except ValueError:
        told = {"error": {"message": f"status {done.returncode}: {done.stderr.strip()[-200:]}"}}
    if "error" in told:
        return {"failed": told["error"]["message"]}
    return {"told": told, "seconds": seconds,
            "megabytes": told["memory"]["peak_resident_bytes"] / 2**20}


def cover(options, model):
    """Guards of the best cover."""
    with tempfile.TemporaryDirectory() as folder:
        run = call([options.starguard, "guard", model, "-o", os.path.join(folder, "g.json"),
                    "--method", "ilp", "--time-limit", str(options.limit)])
    if "failed" in run:
        return run
    return {"guards": len(run["told"]["guards"]), "optimal": run["told"]["optimal"]}


def cut(options, model, mode, seed):
    with tempfile.TemporaryDirectory() as folder:
        grid, report = os.path.join(folder, "p.vtk"), os.path.join(folder, "p.json")
        run = call([options.starguard, "decompose", model, "-o", grid, "--report", report, "--mode",
                    mode, "--seed", str(seed), "--time-limit", str(options.limit)])
        if "failed" in run:
            return run
        verdict = subprocess.run([options.starguard, "verify", model, report, grid, "--quiet"],
                                 capture_output=True, check=False)
    told = run["told"]
    return {"pieces": len(told["pieces"]), "star": told["strictly_star"],
            "single": told["single_tetrahedra"], "visible": told["visible_vertices"],
            "tetrahedra": told["tetrahedra"], "kept": told["surface"] == "kept",
            "seconds": run["seconds"], "megabytes": run["megabytes"],
            "verified": {0: "yes", 4: "NO"}.get(verdict.returncode, "-")}


def good(runs):
    return [r for r in runs if "failed" not in r]


def paper_cells(run):
    if run is None or "failed" in run:
        return ["failed" if run else "-", "-", "-", "-"]
    shown = f"{int(1e4 * run['visible']) / 100:.2f}"  # rounded down
    return [f"{run['pieces']}", f"{run['star']}", shown, f"{run['seconds']:.1f}"]


def strict_cells(runs):
    done = good(runs)
    if not done:
        return ["failed" if runs else "-", "-", "-", "-"]
    pieces = [r["pieces"] for r in done]
    shown = f"{statistics.median(pieces):g} ({min(pieces)}-{max(pieces)})"
    if len(done) < len(runs):
        shown += f", {len(runs) - len(done)} failed"
    if any(r["star"] < r["pieces"] for r in done):
        shown += ", NOT all star-shaped"
    return [shown, f"{sum(r['single'] for r in done)}",
            f"{statistics.median(r['seconds'] for r in done):.1f}",
            f"{max(r['megabytes'] for r in done):.0f}"]


def verified_cell(runs):
    words = {r["verified"] for r in good(runs)}
    return next((w for w in ("NO", "-", "yes") if w in words), "-")


def ratio_of(runs, best):
    done = good(runs)
    if not done or "failed" in best or best["guards"] == 0:
        return None
    return (statistics.median(r["pieces"] for r in done) - 2) / best["guards"]


def row(options, results, name):
    model = os.path.join(options.data, "solids", name + ".off")
    best = results.get((name, "cover", 0), lambda: cover(options, model))
    paper = None
    if "paper" in options.modes:
        paper = results.get((name, "paper", 1), lambda: cut(options, model, "paper", 1))
    strict = []
    if "strict" in options.modes:
        strict = [results.get((name, "strict", seed), lambda s=seed: cut(options, model, "strict", s))
                  for seed in range(1, options.seeds + 1)]
    runs = ([paper] if paper else []) + strict
    done = good(runs)
    tetrahedra = f"{done[0]['tetrahedra']:,}" if done else "-"
    if done and not done[0]["kept"]:
        tetrahedra += " (stuffed)"
    guards = "-" if "failed" in best else f"{best['guards']}{'*' if best['optimal'] else ''}"
    ratio = ratio_of(strict, best)
    peers = PEERS.get(name)
    cells = [name, tetrahedra, guards, *paper_cells(paper), *strict_cells(strict),
             f"{ratio:.2f}" if ratio is not None else "-", verified_cell(runs),
             f"{peers[0]} in {peers[1]:g} s" if peers else "-"]
    print("| " + " | ".join(cells) + " |", flush=True)
    for run in runs + [best]:
        if "failed" in run:
            print(f"{name}: {run['failed']}", file=sys.stderr)
    return ratio


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("starguard")
    parser.add_argument("data")
    parser.add_argument("models", nargs="*")
    parser.add_argument("--results", help="file of finished runs")
    parser.add_argument("--seeds", type=int, default=5, help="strict mode: seeds 1 to N")
    parser.add_argument("--limit", type=float, default=60, help="seconds that a run may search")
    parser.add_argument("--modes", type=lambda s: s.split(","), default=["paper", "strict"])
    options = parser.parse_args()
    names = options.models or sorted(n[:-4] for n in os.listdir(os.path.join(options.data, "solids"))
                                     if n.endswith(".off"))
    results = Results(options.results)
    head = ["model", "tetrahedra", "cover guards", "paper: pieces", "star-shaped", "visible %", "s",
            "strict: pieces, median (spread)", "single tetrahedra", "s", "MB",
            "(pieces - 2) / guards", "verified", "open peers"]
    print("| " + " | ".join(head) + " |")
    print("|---" * len(head) + "|")
    ratios = {name: row(options, results, name) for name in names}
    known = [r for name, r in ratios.items() if r is not None and name not in APART]
    if known:
        print(f"\nMean of (pieces - 2) / guards over {len(known)} models: "
              f"{sum(known) / len(known):.2f}.")
    for name in APART:
        if ratios.get(name) is not None:
            print(f"{name}, apart: {ratios[name]:.2f}.")


if __name__ == "__main__":
    main()
