#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Strict pieces of all models of some folders, by one or two programs at the same effort: one table.

usage: pieces.py STARGUARD DATA [--than OTHER] [--groups cad,solids,table2] [--effort N]

A row for each model where the programs differ, the surface is not kept, or `verify` fails; then the
sums: pieces, surfaces kept, seconds of processor time. OTHER is another build of the program. The table
is Markdown.
"""
import argparse
import glob
import json
import os
import resource
import subprocess
import tempfile


def spent():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def cut(program, verifier, model, effort):
    with tempfile.TemporaryDirectory() as folder:
        grid, report = os.path.join(folder, "p.vtk"), os.path.join(folder, "p.json")
        before = spent()
        done = subprocess.run([program, "decompose", model, "-o", grid, "--report", report, "--quiet",
                               "--effort", str(effort), "--seed", "1"], capture_output=True,
                              check=False)
        seconds = spent() - before
        if done.returncode:
            return {"pieces": 0, "kept": False, "seconds": seconds, "verified": False}
        verdict = subprocess.run([verifier, "verify", model, grid, report, "--quiet"],
                                 capture_output=True, check=False)
        with open(report, encoding="utf-8") as file:
            told = json.load(file)
    return {"pieces": len(told["pieces"]), "kept": told["surface"] == "kept", "seconds": seconds,
            "verified": verdict.returncode == 0}


def cells(run):
    return (f"{run['pieces'] or 'failed'} | {'kept' if run['kept'] else 'approximated'} | "
            f"{run['seconds']:.1f} | {'yes' if run['verified'] else 'NO'}")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("starguard")
    parser.add_argument("data")
    parser.add_argument("--than")
    parser.add_argument("--groups", default="cad,solids,table2")
    parser.add_argument("--effort", type=int, default=500)
    options = parser.parse_args()
    programs = [p for p in (options.than, options.starguard) if p]
    models = [m for group in options.groups.split(",")
              for m in sorted(glob.glob(os.path.join(options.data, group, "*.off")))]
    head = " | pieces | surface | seconds | verified"
    print("| model" + head * len(programs) + " |")
    print("|---" * (1 + 4 * len(programs)) + "|")
    sums = [{"pieces": 0, "kept": 0, "seconds": 0, "verified": 0} for _ in programs]
    for model in models:
        runs = [cut(p, options.starguard, model, options.effort) for p in programs]
        for total, run in zip(sums, runs):
            for key, value in run.items():
                total[key] += value
        if (len({run["pieces"] for run in runs}) > 1 or
                not all(run["kept"] and run["verified"] for run in runs)):
            name = os.path.splitext(os.path.relpath(model, options.data))[0]
            print(f"| {name} | " + " | ".join(map(cells, runs)) + " |", flush=True)
    print(f"| all {len(models)} | " + " | ".join(
        f"{s['pieces']} | {s['kept']} kept | {s['seconds']:.0f} | {s['verified']}"
        for s in sums) + " |")


if __name__ == "__main__":
    main()
