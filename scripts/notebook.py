#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A page as a notebook: its Python blocks are the cells of code. Usage: notebook.py PAGE.md NOTEBOOK.ipynb"""
import json
import re
import sys


def cells(text):
    """The cells of a page, texts and code in turn."""
    found = []
    for i, part in enumerate(re.split(r"^```python\n(.*?)^```$", text, flags=re.S | re.M)):
        lines = part.strip("\n").splitlines(keepends=True)
        if not lines:
            continue
        cell = {"cell_type": "code" if i % 2 else "markdown", "id": f"cell-{len(found)}", "metadata": {},
                "source": lines}
        found.append({**cell, "execution_count": None, "outputs": []} if i % 2 else cell)
    return found


def notebook(page):
    with open(page, encoding="utf-8") as file:
        text = file.read()
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return json.dumps({"cells": cells(text), "metadata": {"kernelspec": kernel}, "nbformat": 4,
                       "nbformat_minor": 5}, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    with open(sys.argv[2], "w", encoding="utf-8") as out:
        out.write(notebook(sys.argv[1]))
