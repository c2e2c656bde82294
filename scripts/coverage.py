#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Line coverage of the tests by folder.

Usage: coverage.py BUILD

BUILD is a build with STARGUARD_COVERAGE in which tests have run. Prints a table, and the files with the
most lines not reached. Status 1 if coverage is too low: below 95 % of the lines of geometry, cover and
star, or below 90 % of all lines."""
import collections
import json
import os
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LEAST = {"src/geometry": 95, "src/cover": 95, "src/star": 95, "all": 90}
WORST = 10  # files to list


def files_of(build):
    words = ["gcovr", "-r", ROOT, "--object-directory", build, "--filter", f"{ROOT}/src/",
             "--filter", f"{ROOT}/cli/", "--gcov-ignore-parse-errors", "--json-summary", "-", build]
    done = subprocess.run(words, cwd=build, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return json.loads(done.stdout)["files"]


def folder_of(name):
    parts = name.split("/")
    return "/".join(parts[:2]) if parts[0] == "src" else parts[0]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    files = files_of(os.path.abspath(sys.argv[1]))
    folders = collections.defaultdict(lambda: [0, 0])
    for file in files:
        for name in (folder_of(file["filename"]), "all"):
            folders[name][0] += file["line_total"]
            folders[name][1] += file["line_covered"]
    short = []
    print("| folder | lines | reached | % |\n|---|--:|--:|--:|")
    for name, (total, covered) in sorted(folders.items(), key=lambda item: (item[0] == "all", item[0])):
        percent = 100 * covered / total
        print(f"| {name} | {total:,} | {covered:,} | {percent:.1f} |")
        if percent < LEAST.get(name, 0):
            short.append(f"{name}: {percent:.1f} % of the lines, {LEAST[name]} asked")
    print("\nNot reached, most first:")
    for file in sorted(files, key=lambda f: f["line_covered"] - f["line_total"])[:WORST]:
        print(f"  {file['line_total'] - file['line_covered']:3} of {file['line_total']:4}  "
              f"{file['filename']}")
    missing = [name for name in LEAST if name not in folders]
    for line in short + [f"{name}: no lines at all" for name in missing]:
        print(line, file=sys.stderr)
    return 1 if short or missing else 0


if __name__ == "__main__":
    sys.exit(main())
