#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Unions of the self-intersecting models of a folder and its subfolders.

usage: unions.py STARGUARD FOLDER

A Markdown row for each closed surface whose faces intersect or touch, also if only repair closes it: pairs
before, faces in, of them kept and cut, faces out, pairs of touching faces after, rounds, rounding, processor
seconds (including reading, checks and writing). Fails if pairs are left.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile

ENDINGS = (".off", ".obj", ".ply", ".stl")
TITLES = ("model", "pairs", "touching", "faces", "kept", "cut", "faces after", "touching after", "rounds", "rounding", "s")


def run(options, *words):
    done = subprocess.run([options.starguard, *words, "--json", "--quiet"], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, check=False)
    return done.returncode, json.loads(done.stdout) if done.stdout else {}


def count(report, kind):
    return report.get("findings", {}).get(kind, {}).get("count", 0)


def models(folder):
    for place, folders, names in os.walk(folder):
        folders.sort()
        for name in sorted(names):
            if name.lower().endswith(ENDINGS):
                yield os.path.join(place, name)


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure(options, model, result):
    """The cells of a model, or None if it needs no union."""
    before = run(options, "check", model)[1]
    pairs, touching = count(before, "self_intersections"), count(before, "self_contacts")
    if pairs + touching == 0:
        return None
    start = processor_seconds()
    status, report = run(options, "repair", model, "-o", result, "--union")
    used = processor_seconds() - start
    name = os.path.relpath(model, options.folder)
    if status != 0:
        return [name, pairs, touching, before["model"]["faces"], f"status {status}", "-", "-", "-", "-", "-", f"{used:.1f}"]
    after, told = run(options, "check", result)[1], report["repair"]
    if count(after, "self_intersections") > 0 or not after["usable"]:
        sys.exit(f"{name}: the union is no solid, or intersects itself")
    faces = before["model"]["faces"]
    return [name, pairs, touching, faces, faces - told["faces_dropped"], told["faces_cut"], after["model"]["faces"],
            count(after, "self_contacts"), told["union_rounds"], f"{told['rounding']:.0e}", f"{used:.1f}"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("starguard")
    parser.add_argument("folder")
    options = parser.parse_args()
    print("| " + " | ".join(TITLES) + " |\n|---|" + "--:|" * (len(TITLES) - 1))
    with tempfile.TemporaryDirectory() as folder:
        for model in models(options.folder):
            cells = measure(options, model, os.path.join(folder, "union.off"))
            if cells is not None:
                print("| " + " | ".join(map(str, cells)) + " |", flush=True)


if __name__ == "__main__":
    main()
