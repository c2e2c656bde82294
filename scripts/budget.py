#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds src, cli and include to the table in CONTRIBUTING.md: budget.py [--write]

For each room its lines and files; for all of them headers under 40 lines that one file uses (beside their own
source and tests), and functions of more than 8 parameters. Status 1 if any number is above the table's.
--write puts the numbers of today there."""
import os
import re
import subprocess
import sys
from collections import Counter

PAGE = "CONTRIBUTING.md"
SHORT, MANY = 40, 8
ROW = re.compile(r"^\| `([\w/]+)` \| ([\d,]+) \| ([\d,]+) \|$", re.M)
LIMITS = {"headers": re.compile(r"(Headers under \d+ lines with one user: )(\d+)"),
          "functions": re.compile(r"(Functions with more than \d+ parameters: )(\d+)")}


def room_of(path):
    """src/mesh/union counts as a room of its own, and so does src/star/certified."""
    folders = path.split("/")[1:-1] if path.startswith("src/") else [path.split("/")[0]]
    return "/".join(folders[:2]) if folders else "src"


def short_headers(texts):
    users = {}
    for path, text in texts.items():
        for name in re.findall(r'^#include "([^"]+)"', text, re.M):
            for header in (f"src/{name}", f"cli/{name}"):
                if header in texts and os.path.splitext(path)[0] != os.path.splitext(header)[0]:
                    users.setdefault(header, set()).add(path)
    return sorted(path for path, text in texts.items()
                  if path.endswith(".h") and not path.startswith("include/") and text.count("\n") < SHORT
                  and len(users.get(path, ())) < 2)


def long_functions(texts):
    found = []
    for path, text in texts.items():
        if not path.endswith((".c", ".h")):
            continue
        code = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
        for match in re.finditer(r"^\w[\w \*\n]*?\b(\w+)\(((?:[^(){};]|\([^()]*\))*)\)\s*\{", code, re.M):
            if re.sub(r"\([^()]*\)", "", match[2]).count(",") >= MANY:
                found.append(f"{path}: {match[1]}")
    return found


def main():
    names = subprocess.run(["git", "ls-files", "src", "cli", "include"], capture_output=True, text=True,
                           check=True).stdout.split()
    texts = {}
    for path in filter(os.path.exists, names):
        with open(path, encoding="utf-8") as file:
            texts[path] = file.read()
    lines, files = Counter(), Counter()
    for path, text in texts.items():
        for room in (room_of(path), "all"):
            lines[room] += text.count("\n")
            files[room] += 1
    found = {"headers": short_headers(texts), "functions": long_functions(texts)}

    with open(PAGE, encoding="utf-8") as file:
        page = file.read()
    if "--write" in sys.argv:
        rows = "\n".join(f"| `{room}` | {lines[room]:,} | {files[room]:,} |"
                         for room in sorted(lines, key=lambda room: (room == "all", room)))
        page = re.sub(r"(?:" + ROW.pattern[1:-1] + r"\n)+", rows.replace("\\", "") + "\n", page, count=1, flags=re.M)
        for key, pattern in LIMITS.items():
            page = pattern.sub(rf"\g<1>{len(found[key])}", page)
        with open(PAGE, "w", encoding="utf-8") as file:
            file.write(page)
        return 0

    budget = {room: (int(a.replace(",", "")), int(b.replace(",", ""))) for room, a, b in ROW.findall(page)}
    wrong = [f"{room} is not in the table" for room in lines if room not in budget]
    for room, (most_lines, most_files) in budget.items():
        if lines[room] > most_lines:
            wrong.append(f"{room} has {lines[room]:,} lines, {lines[room] - most_lines:,} above its budget")
        if files[room] > most_files:
            wrong.append(f"{room} has {files[room]} files, {files[room] - most_files} above its budget")
    for key, pattern in LIMITS.items():
        most = int(pattern.search(page)[2])
        if len(found[key]) > most:
            wrong.append(f"{len(found[key])} {key} of the kind that {PAGE} allows {most} of: " + ", ".join(found[key]))
    for line in wrong:
        print(f"budget: {line}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
