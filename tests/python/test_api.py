# SPDX-License-Identifier: Apache-2.0
"""Is the package complete, typed, and made of the headers as they are?"""
import dataclasses
import glob
import importlib.util
import inspect
import os
import re
import shutil
import subprocess
import sys
import unittest

import starguard
from starguard import _library
from support import SOURCE, Case, main

INCLUDE = os.path.join(SOURCE, "include")
PACKAGE = os.path.join(SOURCE, "python", "starguard")


def make_declarations():
    """The translator of the headers, as a module."""
    spec = importlib.util.spec_from_file_location("make_declarations",
                                                  os.path.join(SOURCE, "python", "tools", "make_declarations.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def table():
    """The counterpart of each C function, or "- reason"."""
    entries = {}
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "api.txt"),
              encoding="utf-8") as file:
        for line in file:
            if line.strip() and not line.startswith("#"):
                name, counterpart = line.split(None, 1)
                if name in entries:
                    raise AssertionError(f"{name} stands in the table twice")
                entries[name] = counterpart.strip()
    return entries


def has_attribute(owner, name):
    """Does a class have it: as a member, a field of a dataclass, or set by a method?"""
    if hasattr(owner, name):
        return True
    if dataclasses.is_dataclass(owner):
        return name in {field.name for field in dataclasses.fields(owner)}
    return re.search(rf"\bself\.{name}\b", inspect.getsource(owner)) is not None


class Completeness(Case):
    def test_every_c_function_is_in_the_table(self):
        declared = make_declarations().functions(os.path.join(INCLUDE, "starguard"))
        self.assertGreater(len(declared), 150)
        self.assertEqual(sorted(declared), sorted(table()))

    def test_the_count_of_functions_is_that_of_the_macro(self):
        uses = 0
        for header in glob.glob(os.path.join(INCLUDE, "starguard", "*.h")):
            with open(header, encoding="utf-8") as file:
                uses += len(re.findall(r"^STARG_API ", file.read(), flags=re.MULTILINE))
        self.assertEqual(uses, len(table()))

    def test_counterparts_exist(self):
        for function, counterpart in table().items():
            if counterpart.startswith("-"):
                self.assertGreater(len(counterpart), 20, f"{function}: the reason is missing")
                continue
            with self.subTest(function=function):
                owner, _, attribute = counterpart.partition(".")
                self.assertTrue(hasattr(starguard, owner), counterpart)
                if attribute:
                    self.assertTrue(has_attribute(getattr(starguard, owner), attribute), counterpart)

    def test_counterparts_are_called(self):
        sources = ""
        for module in glob.glob(os.path.join(PACKAGE, "*.py")):
            with open(module, encoding="utf-8") as file:
                sources += file.read()
        for function, counterpart in table().items():
            if not counterpart.startswith("-"):
                with self.subTest(function=function):
                    self.assertRegex(sources, rf"\blib\.{function}\b")

    def test_the_library_exports_every_function(self):
        for function in table():
            self.assertTrue(callable(getattr(_library.lib, function)))


class Declarations(Case):
    def test_declarations_are_those_of_the_headers(self):
        made = os.path.join(self.folder, "_declarations.py")
        make_declarations().main(INCLUDE, made)
        installed = os.path.join(os.path.dirname(starguard.__file__), "_declarations.py")
        with open(made, encoding="utf-8") as a, open(installed, encoding="utf-8") as b:
            self.assertEqual(a.read(), b.read())

    def structs(self):
        """The names of the structs that have members, with their members."""
        found = {}
        for kind in _library._declared.STRUCTS:
            fields = _library.ffi.typeof(kind).fields
            if fields:
                found[kind] = list(fields)
        return found

    @unittest.skipUnless(shutil.which("cc"), "there is no C compiler")
    def test_structs_are_laid_out_as_the_compiler_does(self):
        structs = self.structs()
        self.assertGreater(len(structs), 30)
        expected, lines = [], []
        for kind, members in structs.items():
            lines.append(f'printf("%zu\\n", sizeof({kind}));')
            expected.append(_library.ffi.sizeof(kind))
            for member in members:
                lines.append(f'printf("%zu\\n", offsetof({kind}, {member}));')
                expected.append(_library.ffi.offsetof(kind, member))
        with open("layout.c", "w", encoding="utf-8") as file:
            file.write("#include <stdio.h>\n#include <starguard/starguard.h>\nint main(void) {\n"
                       + "\n".join(lines) + "\nreturn 0;\n}\n")
        subprocess.run(["cc", f"-I{INCLUDE}", "layout.c", "-o", "layout"], check=True)
        printed = subprocess.run(["./layout"], check=True, capture_output=True, text=True).stdout
        self.assertEqual([int(word) for word in printed.split()], expected)

    def test_version(self):
        self.assertEqual(self.cli("--version").split()[-1], starguard.__version__)


class Names(Case):
    def test_all_is_what_there_is(self):
        public = {name for name, value in vars(starguard).items()
                  if not name.startswith("_") and not inspect.ismodule(value)}
        self.assertEqual(public | {"__version__"}, set(starguard.__all__))

    def test_everything_is_explained_and_every_function_has_an_example(self):
        for name in starguard.__all__:
            value = getattr(starguard, name)
            if not inspect.isclass(value) and not inspect.isfunction(value):
                continue
            with self.subTest(name=name):
                self.assertTrue(value.__doc__ and value.__doc__.strip())
                if inspect.isfunction(value):
                    self.assertIn(">>> ", value.__doc__)
                else:
                    for member, method in vars(value).items():
                        if inspect.isfunction(method) and not member.startswith("_"):
                            self.assertTrue(method.__doc__, f"{name}.{member}")

    def test_positions_of_parameters_are_few(self):
        """Options are named, so that more of them can be added anywhere."""
        for name in starguard.__all__:
            value = getattr(starguard, name)
            if inspect.isfunction(value):
                kinds = [p.kind for p in inspect.signature(value).parameters.values()]
                self.assertLessEqual(kinds.count(inspect.Parameter.POSITIONAL_OR_KEYWORD), 4, name)


class Types(Case):
    def test_marked_as_typed(self):
        self.assertTrue(os.path.exists(os.path.join(os.path.dirname(starguard.__file__), "py.typed")))

    @unittest.skipUnless(shutil.which("mypy"), "mypy is not installed")
    def test_mypy_has_nothing_to_say(self):
        package = os.path.dirname(starguard.__file__)  # has the types of options, which the build makes
        with open("user.py", "w", encoding="utf-8") as file:
            file.write("import starguard\n"
                       "mesh = starguard.sample('dog')\n"
                       "guards: starguard.Guards = starguard.guard(mesh, max_guards=3)\n"
                       "starguard.guard(mesh, max_gaurds=3)  # type: ignore[call-arg]\n"
                       "starguard.guard(mesh, method='best')  # type: ignore[arg-type]\n"
                       "bound: int = guards.lower_bound\n"
                       "pieces = starguard.decompose(mesh, mode='strict')\n"
                       "kept: bool = pieces.tetra.surface_kept\n")
        done = subprocess.run(
            ["mypy", "--strict", "--enable-incomplete-feature=Unpack", "--python-executable",
             sys.executable, "--cache-dir", os.path.join(self.folder, "cache"), "--exclude", "_declarations",
             package, "user.py"],
            capture_output=True, text=True, env={**os.environ, "MYPYPATH": os.path.dirname(package)},
            check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    main()
