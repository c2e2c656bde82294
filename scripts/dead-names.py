#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Names of files of this project, in comments and pages, that no file has: dead-names.py"""
import os
import re
import subprocess
import sys

COMMENTS = {".c": r"/\*.*?\*/", ".h": r"/\*.*?\*/", ".cpp": r"/\*.*?\*/|//[^\n]*", ".py": r'#[^\n]*|""".*?"""',
            ".sh": r"#[^\n]*", ".mjs": r"/\*.*?\*/|//[^\n]*", ".js": r"/\*.*?\*/|//[^\n]*", ".md": r".*"}
NAME = re.compile(r"(?<![\w./*<>{}$-])(?:[\w-]+/)*[\w-]+\.(?:c|h|cpp|py|sh|mjs|md)\b(?![\w*.(-])")
EXAMPLES = {"program.c"}  # of the reader; names in capitals stand for any
HISTORY = ("CHANGELOG.md", "docs/releases/", "docs/decisions/")  # tell of what was


def made_while_building():
    """Files that docs/README.md lists."""
    with open("docs/README.md", encoding="utf-8") as page:
        return set(re.findall(r"[\w/-]+\.\w+", page.read().split("## Made while building")[1].split("\n## ")[0]))


def main():
    tracked = subprocess.run(["git", "ls-files"], capture_output=True, text=True, check=True).stdout.split("\n")
    ends = {"/".join(path.split("/")[i:]) for path in tracked for i in range(path.count("/") + 1)}
    made = made_while_building()
    dead = 0
    for path in tracked:
        pattern = COMMENTS.get(os.path.splitext(path)[1])
        if pattern is None or path.startswith(HISTORY):
            continue
        with open(path, encoding="utf-8") as file:
            text = file.read()
        for comment in re.finditer(pattern, text, re.S):
            for name in NAME.finditer(comment[0]):
                known = name[0] in ends or name[0].removeprefix("build/docs/") in made | EXAMPLES
                if known or name[0].split("/")[-1].split(".")[0].isupper():
                    continue
                line = text.count("\n", 0, comment.start() + name.start()) + 1
                print(f"{path}:{line}: no file is called {name[0]}")
                dead += 1
    return dead > 0


if __name__ == "__main__":
    sys.exit(main())
