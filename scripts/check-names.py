#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finds names of files of this tree that are gone: in comments of sources, and in pages.

A name is any word like folder/name.c, with an ending of sources, scripts or pages. It must be the end of the
path of a tracked file, or one that the build makes.
"""
import os
import re
import subprocess
import sys

ENDINGS = "c|h|cpp|py|sh|mjs|js|md|cmake"
NAME = re.compile(rf"(?<![\w./$*<>{{}}-])((?:\.\./|[\w.-]+/)*[A-Za-z_][\w.-]*\.(?:{ENDINGS}))(?![\w*/.-]*\w)")
COMMENTS = {"c": r"/\*.*?\*/|//[^\n]*", "py": r'#[^\n]*|""".*?"""', "sh": r"#[^\n]*", "js": r"/\*.*?\*/|//[^\n]*",
            "cmake": r"#[^\n]*"}
COMMENTS.update(h=COMMENTS["c"], cpp=COMMENTS["c"], mjs=COMMENTS["js"], txt=COMMENTS["cmake"])
MADE = {"fields.md", "c-api.md", "python-api.md", "_keywords.py", "_declarations.py", "viewer.c", "BUNDLED.md"}
LINKED = re.compile(r"\]\([^)]*\b(?:fields|c-api|python-api)\.md")  # only a build has these pages
PLATFORM = re.compile(r"(std\w+|math|omp|errno|zlib|sys/\w+|fnmatch|float|mpi|sqlite3|jansson)\.h|three\.js|[Nn]ode\.js")
WORDS = re.compile(r"[A-Z]+\.\w+|program\.c|folder/name\.c|CbcCbcParam\.cpp")  # that stand for any, or are of others
LEFT_OUT = ("docs/releases/", "CHANGELOG.md", "tests/fuzz/corpus/")  # history may name what is gone


def words_of(path, text):
    """The text that speaks of files."""
    ending = path.rsplit(".", 1)[-1]
    if ending == "md":
        return re.sub(r"```.*?```|https?://\S+", lambda m: "\n" * m[0].count("\n"), text, flags=re.S)
    found = re.compile(COMMENTS.get(ending, r"(?!)"), re.S)
    kept, last = [], 0
    for match in found.finditer(text):
        kept += ["\n" * text.count("\n", last, match.start()), match[0]]
        last = match.end()
    return re.sub(r"https?://\S+", "", "".join(kept))


def main():
    os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
    tracked = subprocess.run(["git", "ls-files"], check=True, capture_output=True, text=True).stdout.split("\n")
    ends = {"/".join(parts[i:]) for path in tracked for parts in [path.split("/")] for i in range(len(parts))}
    bad = 0
    for path in tracked:
        if path.startswith(LEFT_OUT) or not re.search(rf"\.({ENDINGS}|txt)$", path) or not os.path.isfile(path):
            continue
        with open(path, encoding="utf-8") as file:
            text = words_of(path, file.read())
        for number, line in enumerate(text.split("\n"), 1):
            for name in NAME.findall(line):
                plain = re.sub(r"^(\.\.?/)+", "", name)
                if plain in ends or plain.rsplit("/", 1)[-1] in MADE or PLATFORM.fullmatch(plain) or WORDS.fullmatch(plain):
                    continue
                print(f"{path}:{number}: there is no {name}", file=sys.stderr)
                bad += 1
            if LINKED.search(line) and path.endswith(".md"):
                print(f"{path}:{number}: a link to a page that only a build makes", file=sys.stderr)
                bad += 1
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
