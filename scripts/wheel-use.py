# SPDX-License-Identifier: Apache-2.0
"""What a user of the wheel does, and whether all native code came from it. Usage: wheel-use.py README.md

Writes guards.json and pieces.vtk into the current folder, to be compared with those of another build.
"""
import ctypes
import os
import re
import sqlite3  # noqa: F401, Python's own: must not stand in for the one of the wheel
import sys
import tempfile  # noqa: F401, loads bzip2 and LZMA

import numpy  # noqa: F401

ALLOWED = re.compile(r"/(ld-linux|libc|libm|libpthread|libdl|librt|libgcc_s|libstdc\+\+|libutil)[-.]")


class Object(ctypes.Structure):
    """The beginning of dl_phdr_info."""

    _fields_ = [("address", ctypes.c_size_t), ("name", ctypes.c_char_p)]


def native_libraries():
    """The paths of all libraries in this process, by the loader (a clean root may have no /proc)."""
    found = set()

    @ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(Object), ctypes.c_size_t, ctypes.c_void_p)
    def note(loaded, _size, _data):
        found.add(os.fsdecode(loaded[0].name or b""))
        return 0

    ctypes.CDLL(None).dl_iterate_phdr(note, None)
    return {path for path in found if path.startswith("/")}


BEFORE = native_libraries()
import starguard  # noqa: E402  (pylint: disable=wrong-import-position)


def main(readme):
    with open(readme, encoding="utf-8") as file:
        example, = re.findall(r"^```python\n(.*?)^```$", file.read(), flags=re.DOTALL | re.MULTILINE)
    room = starguard.sample("gallery", vertices=1000)
    room.write("model.off")
    exec(compile(example, "README.md", "exec"), {})  # integer programs: CBC
    guards = starguard.guard(room)
    guards.write("guards.json", "model.off")
    starguard.decompose(room, effort=50).write("pieces.vtk")
    shapes = [starguard.sample(name, vertices=500) for name in ("dog", "cat")]
    for kind in ("star", "shape-dna", "d2"):  # Spectra, LDL
        print(kind, starguard.match(*shapes, kind))
    for name, shape in zip(("dog", "cat"), shapes):
        shape.write(f"{name}.off")
    with starguard.Database.create("shapes.db") as database:  # SQLite
        print(len(database.add(["dog.off", "cat.off"])), "models in a database")
    starguard.write_picture("room.png", room)  # zlib
    folder = os.path.dirname(starguard.__file__)
    foreign = sorted(path for path in native_libraries() - BEFORE
                     if not path.startswith(folder) and not ALLOWED.search(path)
                     and "/python3" not in path)
    if foreign:
        sys.exit(f"native code that did not come with the wheel: {foreign}")
    print(f"Python {sys.version.split()[0]}, starguard {starguard.__version__} in {folder}: fine")


main(*sys.argv[1:])
