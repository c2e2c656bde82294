#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Maps the pieces of every model of a folder to balls, and verifies: a row for each file.

usage: balls.py STARGUARD FOLDER [--only SUBFOLDER] [--every N] [--effort N]

Columns: strict pieces; ratios of singular values, mean by volume and worst, and the share of the
volume above 10; the verdict of `verify`; seconds. Files that are refused have the message instead.
The last line tells how many files and pieces there were. The exit status is 1 if a result was not
verified, or if a command ended with anything but success or a message with status 2 or 3.
"""
import argparse
import os
import sys
import tempfile

import survey


def measure(options, path, folder):
    grid, report = os.path.join(folder, "p.vtk"), os.path.join(folder, "p.json")
    run = survey.call([options.starguard, "decompose", path, "-o", grid, "--report", report, "--balls",
                       "--effort", str(options.effort), "--json"])
    told = run["told"]
    if run["status"] != 0:
        return 0, run["status"] in (2, 3), [f"status {run['status']}: {told['error']['message']}"]
    verified = survey.verdict(options, path, report, grid)["verified"]
    balls = told["balls"]
    return len(told["pieces"]), verified == "yes", [
        len(told["pieces"]), f"{balls['mean']:.1f}", f"{balls['worst']:.2g}",
        f"{100 * balls.get('above_10', 0):.1f} %", verified, f"{run['seconds']:.1f}"]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("starguard")
    parser.add_argument("folder")
    parser.add_argument("--only", default="", help="this folder in FOLDER only")
    parser.add_argument("--every", type=int, default=1, help="each N-th file only")
    parser.add_argument("--effort", type=int, default=1)
    options = parser.parse_args()
    print("| model | pieces | mean | worst | above 10 | verified | s |")
    print("|---|--:|--:|--:|--:|---|--:|")
    files = pieces = wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for path in sorted(survey.find(options))[::options.every]:
            count, good, cells = measure(options, path, folder)
            files += count > 0
            pieces += count
            wrong += not good
            name = os.path.relpath(path, options.folder)
            shown = " | ".join(str(cell) for cell in cells).replace(path, os.path.basename(path))
            print(f"| {name} | {' '.join(shown.split())} |", flush=True)
    print(f"{files} files, {pieces} pieces, {wrong} wrong")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
