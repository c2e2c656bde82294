# SPDX-License-Identifier: Apache-2.0
"""Translates the public headers for cffi: the C declarations have one source.

    make_ffi.py INCLUDE_FOLDER OUTPUT.py

INCLUDE_FOLDER holds starguard/*.h. The output is what `import starguard` reads at run time: the
declarations in cffi's own form, which needs neither a compiler nor a parser then.
"""
import os
import re
import sys

import cffi


def without_comments(text):
    return re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL)


def headers_in_order(folder, name, seen):
    """The names of a header and of all that it includes, each after what it needs."""
    if name in seen:
        return []
    seen.add(name)
    with open(os.path.join(folder, name), encoding="utf-8") as file:
        included = re.findall(r'^#include "(\w+\.h)"', file.read(), flags=re.MULTILINE)
    order = []
    for other in included:
        order += headers_in_order(folder, other, seen)
    return order + [name]


def declarations(folder):
    """All declarations of the headers, without comments, macros and what is for C++ alone."""
    text = ""
    for name in headers_in_order(folder, "starguard.h", set()):
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            header = without_comments(file.read())
        header = re.sub(r"^#ifdef __cplusplus$.*?^#endif$", "", header, flags=re.DOTALL | re.MULTILINE)
        header = re.sub(r"^#.*$", "", header, flags=re.MULTILINE)
        text += re.sub(r"\bSTARG_API\b", "", header)
    return re.sub(r"\n\s*\n+", "\n", text)


def functions(folder):
    """The names of all public functions."""
    names = set()
    for name in headers_in_order(folder, "starguard.h", set()):
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            header = without_comments(file.read())
        for declaration in re.findall(r"^STARG_API([^;]*);", header, flags=re.MULTILINE):
            names.add(re.search(r"\b(starg_\w+)\s*\(", declaration).group(1))
    return names


def version(folder):
    """The version that the headers name."""
    with open(os.path.join(folder, "version.h"), encoding="utf-8") as file:
        numbers = re.findall(r"^#define STARG_VERSION_[A-Z]+ (\d+)$", file.read(), flags=re.MULTILINE)
    return ".".join(numbers)


def main(include, output):
    folder = os.path.join(include, "starguard")
    ffi = cffi.FFI()
    ffi.cdef(declarations(folder))
    ffi.set_source("starguard._ffi", None)
    ffi.emit_python_code(output)
    with open(output, "a", encoding="utf-8") as file:
        file.write(f'version = "{version(folder)}"\n')


if __name__ == "__main__":
    main(*sys.argv[1:])
