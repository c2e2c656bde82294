#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Guards and bounds over the candidates, for partial coverage and for limits on the guards.

usage: bounds.py STARGUARD FOLDER [--largest N] [--threads N]

For the N largest OFF files of a folder, by bytes: guards / bound at coverage 0.95 and 0.99; area seen
and its bound, in per cent, with --max-guards 3, 6 and 12; processor seconds of all five runs. The table
is Markdown; below it, how many gaps are at most one guard or a tenth, and how many areas are within 2 %.
"""
import argparse
import json
import os
import resource
import subprocess
import tempfile

COVERAGES = ("0.95", "0.99")
LIMITS = ("3", "6", "12")


def guard(options, model, result, *more):
    subprocess.run([options.starguard, "guard", model, "-o", result, "--quiet",
                    "--threads", str(options.threads), *more], check=True)
    with open(result, encoding="utf-8") as file:
        return json.load(file)


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def largest(options):
    files = [os.path.join(options.folder, name) for name in os.listdir(options.folder) if name.endswith(".off")]
    return sorted(files, key=lambda path: (-os.path.getsize(path), path))[:options.largest]


def measure(options, model, result, gaps, areas):
    cells = []
    start = processor_seconds()
    for coverage in COVERAGES:
        told = guard(options, model, result, "--coverage", coverage)
        count, bound = len(told["guards"]), told["lower_bound"]
        gaps.append(count - bound <= max(1, count // 10))
        cells.append(f"{count} / {bound}")
    for limit in LIMITS:
        told = guard(options, model, result, "--max-guards", limit)["coverage"]
        areas.append(told["area_bound"] <= 1.02 * told["area"])
        cells.append(f"{100 * told['area']:.2f} / {100 * told['area_bound']:.2f}")
    return cells + [f"{processor_seconds() - start:.1f}"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("starguard")
    parser.add_argument("folder")
    parser.add_argument("--largest", type=int, default=20)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    heads = ["model", *COVERAGES, *(f"{limit} guards" for limit in LIMITS), "seconds"]
    print("| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|")
    gaps, areas = [], []
    with tempfile.TemporaryDirectory() as folder:
        for model in largest(options):
            cells = measure(options, model, os.path.join(folder, "guards.json"), gaps, areas)
            print("| " + " | ".join([os.path.basename(model), *cells]) + " |", flush=True)
    print(f"\nGaps of at most 1 or 10 %: {sum(gaps)} of {len(gaps)}. Areas within 2 %: {sum(areas)} of {len(areas)}.")


if __name__ == "__main__":
    main()
