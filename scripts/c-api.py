#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Generates the C reference from the comments of the public headers. Usage: c-api.py OUTPUT.md

A header is a comment about itself, then blocks separated by empty lines: an optional comment and the
declarations that it describes. "/* ---- name ---- */" starts a section."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADERS = ROOT / "include" / "starguard"

HEAD = """# C reference

Made from the headers in `include/starguard/` by `scripts/c-api.py`. `#include <starguard/starguard.h>`
takes in all of them; each also stands alone, as C11 and as C++11. How a program is compiled and
linked stands in [examples](../examples/README.md).

Rules that hold for every call:

- Calls that can fail return a `starg_status`, 0 for success; `starg_context_error` has the detail:
  what, where (indices), and what to do. Outputs come last and are NULL after a failure.
- Every `..._free` takes NULL. An object is freed before the context that it was made with.
- One thread at a time uses a context. Finished objects never change and may be shared by threads.
- Options are structs that `..._options_default` fills; NULL in their place means the defaults.
- Arrays of points are count x 3 doubles, of faces count x 3 indices, from 0.
- The same input, options and seed give the same result at any number of threads.
"""


def plain(comment):
    """The text of a comment, paragraphs as single lines."""
    text = re.sub(r"^/\*\s*|\s*\*/$", "", comment.strip())
    lines = [re.sub(r"^\s*\* ?", "", line).strip() for line in text.split("\n")]
    paragraphs = re.split(r"\n\s*\n", "\n".join(lines))
    return "\n\n".join(" ".join(part.split()) for part in paragraphs)


def without_frame(text):
    """The text between the includes and the end of the include guard."""
    text = re.sub(r"#ifdef __cplusplus\n.*?#endif\n", "", text, flags=re.S)
    text = re.sub(r"^#(ifndef STARGUARD_|define STARGUARD_\w+_H|include).*\n", "", text, flags=re.M)
    return re.sub(r"#endif\s*$", "", text)


def blocks(text):
    """(comment, declarations) of each block; either may be empty."""
    token = re.compile(r"/\*.*?\*/|[^;{/#]*\{[^}]*\}[^;]*;|[^;{/#]*;|#[^\n]*\n(?:[^\n]*\\\n[^\n]*\n)*",
                       re.S)
    comment, code, end = "", "", 0
    for match in token.finditer(text):
        gap = "\n\n" in text[end:match.start()] + match.group()[:2]
        piece, end = match.group().strip("\n"), match.end()
        if piece.startswith("/*") and not text[:match.start()].split("\n")[-1].strip():
            if comment or code:
                yield comment, code
            comment, code = piece, ""
        elif gap and code:
            yield comment, code
            comment, code = "", piece.strip()
        else:
            code += (" " if piece.startswith("/*") else "\n" if code else "") + piece.strip()
    if comment or code:
        yield comment, code


def section(path):
    text = path.read_text(encoding="utf-8")
    about, rest = text.split("*/", 1)
    yield f"\n## {path.name}\n"
    yield plain(about + "*/") + "\n"
    for comment, code in blocks(without_frame(rest)):
        title = re.fullmatch(r"/\* -+ (.*?) -+ \*/", comment)
        if title:
            yield f"\n### {title.group(1)}\n"
            comment = ""
        if code:
            if "STARG_API " in code:
                code = re.sub(r"^ {10}", "", code.replace("STARG_API ", ""), flags=re.M)
            yield f"```c\n{code}\n```\n"
        if comment:
            yield plain(comment) + "\n"


def document():
    names = [name for name in re.findall(r'#include "(\w+\.h)"',
                                         (HEADERS / "starguard.h").read_text(encoding="utf-8"))]
    parts = [HEAD, "\n" + " · ".join(f"[{n[:-2]}](#{n.replace('.', '')})" for n in names) + "\n"]
    for name in names:
        parts += section(HEADERS / name)
    return "\n".join(part.rstrip("\n") + "\n" for part in parts).replace("\n\n\n", "\n\n")


if __name__ == "__main__":
    pathlib.Path(sys.argv[1]).write_text(document(), encoding="utf-8")
