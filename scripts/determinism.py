#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Compares every result file made with 1, 2, 7 and 32 threads, by programs of different compilers at
different optimization levels: the bytes must be the same.

Usage: determinism.py [--threads N,...] PROGRAM...      (default: 1,2,7,32)
       determinism.py --matrix FOLDER [--threads N,...]

The second form builds the programs itself, below FOLDER: gcc and clang, each at -O0, -O2 and
-O3 -march=native. Prints a table of hashes; status 1 if a file differs, with its name.

Compared are all files that the commands below write; databases as the text that SQLite dumps; and the
output of --json, except for the keys that docs/formats.md reserves for data about the run."""
import argparse
import hashlib
import json
import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

JOBS = int(os.environ.get("JOBS", os.cpu_count()))  # concurrent builds and runs
ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

# Data about the run (docs/formats.md).
OF_THE_RUN = ("seconds", "memory", "ranks")

# All commands write into one folder, in this order.
COMMANDS = [
    "sample horse --vertices 600 -o horse.off",
    "sample horse --vertices 600 --pose 2 -o pose.off",
    "sample cat --vertices 700 -o cat_0.ply",
    "sample cat --vertices 700 --pose 1 -o cat_1.ply",
    "sample gallery --vertices 500 -o gallery_0.obj",
    "sample knot --vertices 600 -o knot_0.stl",
    "sample octopus --vertices 500 -o octopus.off",
    "check knot_0.stl --marks check.ply",
    "repair knot_0.stl -o repaired.off",
    "kernel octopus.off",
    "skeleton horse.off -o skeleton.obj --nodes 150 --picture skeleton.png",
    "skeleton gallery_0.obj -o skeleton.cg",
    "skeleton knot_0.stl -o skeleton.vtk",
    "guard horse.off -o pilp.json --coarsest 300 --step 150 --refine-lines 300000 "
    "--picture guards.png --marks guards.ply",
    "guard horse.off -o ilp.json --method ilp --count 200",
    "guard cat_0.ply -o greedy.json --method greedy --candidates medial",
    "guard gallery_0.obj -o lattice.json --method ilp --candidates interior --faces whole --count 200",
    "guard gallery_0.obj -o cameras.json --method greedy --cone 90 --count 60 --redundancy 2",
    "guard octopus.off -o part.json --coverage 0.95 --target vertices --visibility sweep --count 100 "
    "--no-refine",
    "guard octopus.off -o range.json --method ilp --visibility bvh --range 0.5 --clearance 0.01 "
    "--count 100 --max-nodes 50",
    "guard gallery_0.obj -o proved.json --prove --prove-work 300000 --certificate proved.txt",
    "verify horse.off pilp.json ilp.json",
    "visible gallery_0.obj --from 0.5,0.5,0.5 -o visible.ply --engine contours",
    "decompose octopus.off -o strict.vtk --report strict.json --effort 300",
    "decompose gallery_0.obj -o binary.vtk --binary --report binary.json --effort 100",
    "decompose octopus.off -o paper.vtk --report paper.json --mode paper --density 3",
    "verify octopus.off strict.vtk strict.json",
    "describe horse.off -o horse.json --detail 300 --effort 60 --histograms histograms.svg",
    "describe pose.off -o pose.json --detail 300 --effort 60 --reconstruct looks.ply",
    "match horse.json pose.json",
    "map cat_0.ply octopus.off -o map.json",
    "sample maze --vertices 60 -o maze.off",
    "sample comb --vertices 60 -o comb.off",
    "map --solid maze.off comb.off -o limbs.vtu",
    "morph cat_0.ply octopus.off --map map.json --frames 4 -o star --glb star.glb",
    "morph horse.off pose.off --frames 4 -o arap --method arap",
    "morph horse.off pose.off --frames 3 -o guarded --guards --candidates 100",
    "morph horse.off pose.off --frames 3 -o linear --method linear",
    "export pilp.json --model horse.off -o guards.glb",
    "export strict.vtk strict.json -o pieces.vtu --model octopus.off",
    "export skeleton.obj --model horse.off -o bones.ply",
    "view pilp.json skeleton.obj --model horse.off -o page.html",
    "db create shapes.db",
    "db add shapes.db cat_0.ply cat_1.ply gallery_0.obj knot_0.stl",
    "db query shapes.db octopus.off",
    "db matrix shapes.db -o matrix.csv --picture matrix.png",
    "db matrix shapes.db -o spectra.csv --distance shape-dna",
    "db evaluate shapes.db --classes by-prefix -o recall.csv --picture recall.svg",
]

BUILDS = [(compiler, flags) for compiler in ("gcc", "clang")
          for flags in ("-O0", "-O2", "-O3 -march=native")]


class Failure(Exception):
    """A command or a build that failed."""


def of_the_result(text):
    """The output of --json without data about the run."""
    report = json.loads(text)
    for key in OF_THE_RUN:
        report.pop(key, None)
    return json.dumps(report, indent=1, ensure_ascii=False).encode()


def run(program, folder, line, threads):
    words = [program, *line.split(), "--json", "--threads", str(threads)]
    process = subprocess.run(words, cwd=folder, capture_output=True, stdin=subprocess.DEVNULL,
                             check=False)
    if process.returncode == 3 and line.startswith("view"):
        return None  # built without the viewer (docs/viewer.md)
    if process.returncode != 0:
        raise Failure(f"{' '.join(words)}: status {process.returncode}\n{process.stderr.decode()}")
    return of_the_result(process.stdout)


def contents(path):
    if not path.endswith(".db"):
        with open(path, "rb") as file:
            return file.read()
    connection = sqlite3.connect(path)
    text = "\n".join(connection.iterdump())
    connection.close()
    return text.encode()


def results(program, threads):
    """Runs all commands in a new folder: {name: bytes} of what they wrote and reported."""
    found = {}
    with tempfile.TemporaryDirectory(prefix="starguard-determinism-") as folder:
        for number, line in enumerate(COMMANDS):
            report = run(program, folder, line, threads)
            if report is not None:
                found[f"report {number:02} of {' '.join(line.split()[:2])}"] = report
        for place, _, names in os.walk(folder):
            for name in names:
                path = os.path.join(place, name)
                found[os.path.relpath(path, folder)] = contents(path)
    return found


def first_difference(a, b):
    """Where two texts start to differ, for the message."""
    at = next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
    return f"byte {at}: {a[at:at + 60]!r} and {b[at:at + 60]!r}"


def short(data):
    return hashlib.sha256(data).hexdigest()[:12] if data is not None else "-"


def print_table(names, columns):
    width = max(map(len, names))
    print(" " * width, *(f"[{i + 1}]".rjust(12) for i in range(len(columns))))
    for name in names:
        print(name.ljust(width), *(short(column.get(name)) for _, column in columns))
    for i, (title, _) in enumerate(columns):
        print(f"[{i + 1}] {title}")


def compare(programs, threads):
    """All results of all programs at all numbers of threads; returns the differences as lines of text."""
    runs = [(title, program, count) for title, program in programs for count in threads]
    with ThreadPoolExecutor(JOBS) as pool:
        found = pool.map(lambda run: results(*run[1:]), runs)
        columns = [(f"{title}, {count} threads", column)
                   for (title, _, count), column in zip(runs, found)]
    names = sorted({name for _, column in columns for name in column})
    print_table(names, columns)
    differing = []
    for name in names:
        first = columns[0][1].get(name)
        for title, column in columns[1:]:
            if column.get(name) != first:
                differing.append(f"{name} differs: {columns[0][0]} and {title}: "
                                 f"{first_difference(first or b'', column.get(name) or b'')}")
                break
    return len(names), differing


def build(folder, compiler, flags):
    """The program of one compiler and its flags."""
    place = os.path.abspath(os.path.join(folder, (compiler + flags).replace(" ", "")))
    debug = flags == "-O0"  # otherwise some files, the most important ones, are always compiled at -O3
    commands = [
        ["cmake", "-G", "Ninja", "-S", ROOT, "-B", place, f"-DCMAKE_C_COMPILER={compiler}",
         "-DSTARGUARD_TESTS=OFF", f"-DCMAKE_BUILD_TYPE={'Debug' if debug else 'None'}",
         f"-DCMAKE_C_FLAGS={flags}"],
        ["cmake", "--build", place, "--target", "starguard_cli", "-j",
         str(JOBS)],
    ]
    for words in commands:
        process = subprocess.run(words, capture_output=True, text=True, check=False)
        if process.returncode != 0:
            raise Failure(f"{' '.join(words)}:\n{process.stdout[-3000:]}{process.stderr[-3000:]}")
    return f"{compiler} {flags}", os.path.join(place, "starguard")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("programs", nargs="*", metavar="PROGRAM")
    parser.add_argument("--threads", default="1,2,7,32", metavar="N,...")
    parser.add_argument("--matrix", metavar="FOLDER")
    options = parser.parse_args()
    programs = [(path, os.path.abspath(path)) for path in options.programs]
    if (options.matrix is None) == (not programs):
        parser.error("name programs, or a folder for --matrix")
    try:
        if options.matrix is not None:
            programs = [build(options.matrix, *entry) for entry in BUILDS
                        if shutil.which(entry[0]) is not None]
        count, differing = compare(programs, [int(n) for n in options.threads.split(",")])
    except Failure as failure:
        sys.exit(f"determinism: {failure}")
    for line in differing:
        print(line, file=sys.stderr)
    if differing:
        sys.exit(f"determinism: {len(differing)} of {count} results are not the same everywhere")
    print(f"determinism: {count} results, the same everywhere")


if __name__ == "__main__":
    main()
