# SPDX-License-Identifier: Apache-2.0
"""How a wheel gets its tag (scripts/wheel.py), with libraries made for it; `make wheel` tries the whole."""
import contextlib
import importlib.util
import io
import os
import platform
import shutil
import subprocess
import unittest
import zipfile

from support import SOURCE, Case, main

MACHINE = platform.machine()


def module():
    spec = importlib.util.spec_from_file_location("wheel_script", os.path.join(SOURCE, "scripts", "wheel.py"))
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


wheel = module()


@unittest.skipUnless(shutil.which("cc") and shutil.which("readelf"), "there is no C compiler")
@unittest.skipUnless(platform.libc_ver()[0] == "glibc" and MACHINE in ("x86_64", "aarch64"), "not this system")
class Tag(Case):
    def library(self, text, *options, rpath="$ORIGIN"):
        os.makedirs("package", exist_ok=True)
        with open("a.c", "w", encoding="utf-8") as file:
            file.write(text)
        subprocess.run(["cc", "-shared", "-fPIC", "a.c", "-o", "package/libone.so", f"-Wl,-rpath,{rpath}",
                        *options], check=True)

    def tag(self):
        with contextlib.redirect_stdout(io.StringIO()):
            return wheel.tag("package")

    def test_old_symbols(self):
        self.library("#include <string.h>\nvoid *f(void *a, int n) { return memset(a, 1, n); }\n")
        self.assertEqual(self.tag(), f"manylinux_2_31_{MACHINE}")

    def test_a_new_symbol_needs_a_new_glibc(self):
        text = "#include <math.h>\ndouble f(double a, double b) { return hypot(a, b); }\n"
        if tuple(map(int, platform.libc_ver()[1].split("."))) < (2, 35):
            self.skipTest("hypot is old here")
        self.library(text, "-lm")
        self.assertEqual(self.tag(), f"manylinux_2_35_{MACHINE}")
        self.library(text, "-lm", "-include", os.path.join(SOURCE, "cmake", "glibc_2_34.h"))
        self.assertEqual(self.tag(), f"manylinux_2_31_{MACHINE}")

    def test_a_library_from_elsewhere(self):
        self.library("int deflateEnd(void *);\nint f(void *a) { return deflateEnd(a); }\n", "-lz")
        with self.assertRaisesRegex(SystemExit, "libz"):
            self.tag()

    def test_a_path_of_this_machine(self):
        self.library("int f(void) { return 1; }\n", rpath="/usr/lib/here")
        with self.assertRaisesRegex(SystemExit, "/usr/lib/here"):
            self.tag()


class Pack(Case):
    def test_same_files_same_bytes(self):
        os.makedirs("package/libs")
        for name in ("__init__.py", "libs/x.so", "left.stamp"):
            with open(f"package/{name}", "w", encoding="utf-8") as file:
                file.write(name)
        names = []
        for folder in ("a", "b"):
            os.mkdir(folder)
            names.append(os.path.join(folder, wheel.backend.pack("package", folder, "any", [("X", b"licence")])))
        self.assertEqual(*map(self.read, names))
        with zipfile.ZipFile(names[0]) as archive:
            inside = archive.namelist()
            record = archive.read(next(name for name in inside if name.endswith("RECORD"))).decode()
        self.assertIn("starguard/libs/x.so", inside)
        self.assertNotIn("starguard/left.stamp", inside)
        self.assertEqual({line.split(",")[0] for line in record.splitlines()}, set(inside))
        self.assertTrue(any(name.endswith("licenses/X") for name in inside))


if __name__ == "__main__":
    main()
