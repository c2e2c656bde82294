#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Strict pieces of all models of some folders, by one or two programs at the same effort: one table.

usage: pieces.py STARGUARD DATA [--than OTHER] [--groups cad,solids,table2] [--effort N]
       pieces.py STARGUARD DATA --quality [--prove] [--models solids/spot,...] [--effort N]

A row for each model where the programs differ, the surface is not kept, or `verify` fails; then the
sums: pieces, surfaces kept, seconds of processor time. OTHER is another build of the program.

With --quality a row for each model: pieces, with --prove the lower bound for all partitions and
whether it is met, the smallest dihedral angle that the model does not force and the median, the
smallest margin, the share of pieces whose margin is at least a thousandth, and seconds. The tables are
Markdown.
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


def report_of(program, model, words):
    """What the report says, seconds of processor time, and whether all of it is verified."""
    with tempfile.TemporaryDirectory() as folder:
        grid, report, why = (os.path.join(folder, name) for name in ("p.vtk", "p.json", "c.txt"))
        proof = ["--certificate", why] if "--prove" in words else []
        before = spent()
        subprocess.run([program, "decompose", model, "-o", grid, "--report", report, "--quiet",
                        "--threads", "1", *words, *proof], check=True)
        seconds = spent() - before
        files = [grid, report] + ([why] if proof else [])
        verdict = subprocess.run([program, "verify", model, *files, "--quiet"], check=False)
        with open(report, encoding="utf-8") as file:
            return json.load(file), seconds, verdict.returncode == 0


def tell_quality(program, models, data, words):
    proof = "--prove" in words
    names = ["model", "pieces"] + ["lower bound", "optimal"] * proof + [
        "smallest angle", "of all", "median", "smallest margin", "margins >= 0.001", "seconds",
        "verified"]
    print("| " + " | ".join(names) + " |")
    print("|---" * len(names) + "|")
    for model in models:
        told, seconds, verified = report_of(program, model, words)
        margins = [piece["margin"] for piece in told["pieces"]]
        wide = sum(margin >= 1e-3 for margin in margins)
        row = [os.path.splitext(os.path.relpath(model, data))[0], str(len(margins))]
        if proof:
            row += [str(told["lower_bound"]), "yes" if told["optimal"] else "no"]
        row += [f"{told.get('smallest_angle_made', 0):.2g}", f"{told['smallest_angle']:.2g}",
                f"{told['median_angle']:.0f}", f"{min(margins):.1e}", f"{wide} of {len(margins)}",
                f"{seconds:.1f}", "yes" if verified else "NO"]
        print("| " + " | ".join(row) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("starguard")
    parser.add_argument("data")
    parser.add_argument("--than")
    parser.add_argument("--groups", default="cad,solids,table2")
    parser.add_argument("--effort", type=int)
    parser.add_argument("--quality", action="store_true")
    parser.add_argument("--prove", action="store_true")
    parser.add_argument("--models", default="")
    parser.add_argument("--more", default="", help="further options of decompose")
    options = parser.parse_args()
    programs = [p for p in (options.than, options.starguard) if p]
    models = [m for group in options.groups.split(",")
              for m in sorted(glob.glob(os.path.join(options.data, group, "*.off")))]
    if options.models:
        models = [os.path.join(options.data, name + ".off") for name in options.models.split(",")]
    if options.quality:
        words = ["--prove"] * options.prove + options.more.split()
        if options.effort:
            words += ["--effort", str(options.effort)]
        tell_quality(options.starguard, models, options.data, words)
        return
    effort = options.effort or 500
    head = " | pieces | surface | seconds | verified"
    print("| model" + head * len(programs) + " |")
    print("|---" * (1 + 4 * len(programs)) + "|")
    sums = [{"pieces": 0, "kept": 0, "seconds": 0, "verified": 0} for _ in programs]
    for model in models:
        runs = [cut(p, options.starguard, model, effort) for p in programs]
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
