# SPDX-License-Identifier: Apache-2.0
"""The libraries export the functions that the public headers declare: all of them, nothing else."""
import os
import re
import subprocess
import tempfile
import unittest

SOURCE = os.environ["STARGUARD_SOURCE"]
BUILD = os.environ["STARGUARD_BUILD"]
GCC = "gcc"  # whatever compiled the library: only gcc lists declarations


def declared():
    """Every function that the compiler finds declared in include/starguard, marked or not."""
    with tempfile.TemporaryDirectory() as folder:
        listing = os.path.join(folder, "declarations")
        unit = b"#include <starguard/starguard.h>\n"
        subprocess.run([GCC, "-x", "c", "-", "-fsyntax-only", "-I", f"{SOURCE}/include",
                        "-aux-info", listing], input=unit, check=True)
        with open(listing, encoding="utf-8") as file:
            lines = [line for line in file if "include/starguard/" in line]
    return {re.search(r"\b(\w+) \(", line.split("*/", 1)[1]).group(1) for line in lines}


def exported(library, *options):
    text = subprocess.run([os.environ["NM"], *options, "-g", "--defined-only",
                           os.path.join(BUILD, library)],
                          check=True, capture_output=True, text=True).stdout
    rows = [line.split() for line in text.splitlines()]
    return {row[2].split("@")[0] for row in rows if len(row) == 3}


def linker_made(name):
    """What linkers and sanitizers add."""
    return name.startswith("__asan_") or name.startswith("__odr_asan") or name in {
        "_init", "_fini", "__bss_start", "_edata", "_end"}


class Symbols(unittest.TestCase):
    def setUp(self):
        self.declared = declared()
        self.assertGreater(len(self.declared), 100)

    def check(self, *listings):
        """Each function is in one of the two libraries; what else they export is private."""
        names = [{name for name in listing if not linker_made(name)} for listing in listings]
        self.assertEqual(names[0] & names[1], set(), "exported twice")
        names = {name for name in names[0] | names[1] if not name.startswith("starg_private_")}
        self.assertEqual(self.declared - names, set(), "declared but not exported")
        self.assertEqual(names - self.declared, set(), "exported but not declared")

    def test_shared(self):
        self.check(exported("libstarguard.so", "-D"), exported("libstarguard-shapes.so", "-D"))

    def test_static(self):
        self.check(exported("libstarguard.a"), exported("libstarguard-shapes.a"))

    def test_every_header_is_included(self):
        with open(f"{SOURCE}/include/starguard/starguard.h", encoding="utf-8") as file:
            included = set(re.findall(r'#include "(\w+\.h)"', file.read()))
        headers = set(os.listdir(f"{SOURCE}/include/starguard"))
        self.assertEqual(headers - included, {"starguard.h", "export.h"})

    def test_soname(self):
        for name in "libstarguard", "libstarguard-shapes":
            text = subprocess.run(["readelf", "-d", os.path.join(BUILD, f"{name}.so")], check=True,
                                  capture_output=True, text=True).stdout
            self.assertRegex(text, rf"SONAME.*\[{name}\.so\.\d+(\.\d+)?\]")
            self.assertNotRegex(text, r"\((RPATH|RUNPATH|TEXTREL)\)")


if __name__ == "__main__":
    unittest.main(verbosity=2)
