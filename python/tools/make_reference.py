# SPDX-License-Identifier: Apache-2.0
"""Writes the reference of the Python package from its docstrings. The package must be importable.

    make_reference.py OUTPUT.md
"""
import inspect
import re
import sys
import textwrap

import starguard

HEAD = """# Python reference

Made from the docstrings of the package (`help(starguard.guard)` prints the same). What all calls
share is in [python.md](python.md).

"""

SECTIONS = {
    "Meshes and solids": ["mesh", "solid", "catalogue"],
    "Guards": ["guards", "visibility", "covers", "kernels", "skeletons"],
    "Pieces": ["pieces", "tetra"],
    "Verification": ["verification"],
    "Comparing shapes": ["descriptors", "databases"],
    "Maps and morphs": ["morphs", "solidmaps"],
    "Pictures, pages, files for others": ["pictures", "views"],
    "Errors": ["errors"],
}


def text_of(value):
    """A docstring, with its examples in a block of code."""
    lines, text, inside = inspect.getdoc(value).splitlines(), [], False
    for line in lines:
        if line.startswith(">>> ") and not inside:
            text.append("```pycon")
            inside = True
        elif not line.strip() and inside:
            text.append("```")
            inside = False
        text.append(line)
    return "\n".join(text + ["```"] * inside)


class Plain(str):
    """An annotation, shown without quotation marks."""

    __repr__ = str.__str__


def signature_of(value):
    signature = inspect.signature(value)
    parameters = [p.replace(annotation=Plain(p.annotation)) if isinstance(p.annotation, str) else p
                  for p in signature.parameters.values() if p.name != "self"]
    returns = signature.return_annotation
    if isinstance(returns, str):
        returns = Plain(returns) if returns != "None" else inspect.Signature.empty
    return str(signature.replace(parameters=parameters, return_annotation=returns))


def code(name, value):
    """A call as it is written, in a block of code of which no line is too long."""
    call = name + signature_of(value)
    if len(call) > 96:
        call = textwrap.fill(call, 96, subsequent_indent="    ", break_long_words=False)
    return f"```python\n{call}\n```\n"


def attributes_of(kind):
    """The attributes of a class with the comments that stand above or behind them in its source."""
    rows, comment = [], []
    for line in inspect.getsource(kind).splitlines():
        above = re.match(r"\s+#: (.*)", line)
        field = re.match(r"\s+(?:self\.)?([a-z]\w*): ([^=#]+?)(?: = .*?)?(?:  #: (.*))?(?: \($)?$", line)
        if above:
            comment.append(above.group(1))
        elif field and (line.startswith("    " + field.group(1)) or comment or field.group(3)):
            said = " ".join(comment) or field.group(3) or ""
            rows.append(f"- `{field.group(1)}` ({field.group(2)})" + (f": {said}" if said else ""))
            comment = []
        elif line.strip():
            comment = []
    return "\n".join(rows) + "\n" if rows else ""


def members_of(name, kind):
    """The methods and properties of a class."""
    for member, value in vars(kind).items():
        if member.startswith("_"):
            continue
        if isinstance(value, property):
            yield f"#### `{name}.{member}`\n\n{text_of(value)}\n"
        elif isinstance(value, (classmethod, staticmethod)):
            yield (f"#### `{name}.{member}()`\n\n{code(f'{name}.{member}', getattr(kind, member))}\n"
                   f"{text_of(getattr(kind, member))}\n")
        elif inspect.isfunction(value):
            yield f"#### `{name}.{member}()`\n\n{code(f'{name}.{member}', value)}\n{text_of(value)}\n"


def entry(name, value):
    """All about one public name."""
    if inspect.isfunction(value):
        return f"### `{name}()`\n\n{code(name, value)}\n{text_of(value)}\n"
    own = vars(value).get("__init__")
    built = own is not None and "__dataclass_fields__" not in vars(value) and not issubclass(value, Exception)
    parts = [f"### `{name}`\n", code(name, value) if built else "", text_of(value) + "\n",
             attributes_of(value), *members_of(name, value)]
    return "\n".join(part for part in parts if part)


def reference():
    """The whole reference."""
    parts = [HEAD]
    for title, modules in SECTIONS.items():
        parts.append(f"## {title}\n")
        names = [name for name in starguard.__all__ if getattr(getattr(starguard, name), "__module__", "")
                 in {f"starguard.{module}" for module in modules}]
        functions = [n for n in names if inspect.isfunction(getattr(starguard, n))]
        classes = [n for n in names if inspect.isclass(getattr(starguard, n))]
        parts += [entry(name, getattr(starguard, name)) for name in functions + classes]
    return "\n".join(parts)


def main(path):
    text = reference()
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
