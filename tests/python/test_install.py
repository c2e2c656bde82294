# SPDX-License-Identifier: Apache-2.0
"""`pip install .` from a checkout, and the example of the README with what it has installed."""
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import unittest

import starguard
from support import SOURCE, Case, main


def example():
    """The Python code of the README."""
    with open(os.path.join(SOURCE, "README.md"), encoding="utf-8") as file:
        return re.findall(r"^```python\n(.*?)^```$", file.read(), flags=re.DOTALL | re.MULTILINE)


@unittest.skipUnless(importlib.util.find_spec("pip"), "pip is not installed")
class Install(Case):
    def install(self):
        """Installs into a folder of its own, with the library that is built already, offline."""
        environment = {**os.environ, "PYTHONPATH": ""}
        before = set(os.listdir(SOURCE))
        subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index",
                        "--no-cache-dir", "--target", "site",
                        "--disable-pip-version-check", "--root-user-action=ignore",
                        os.path.abspath(SOURCE)], check=True, env=environment)
        self.assertEqual(set(os.listdir(SOURCE)), before, "files are left beside the sources")
        return {**environment, "PYTHONPATH": os.path.abspath("site")}

    def test_it_works_where_it_is_installed(self):
        environment = self.install()
        files = set(os.listdir("site/starguard"))
        self.assertLessEqual({"_declarations.py", "py.typed", "__init__.py"}, files)
        libraries = {re.sub(r"\.so\..*", "", file) for file in files if ".so." in file}
        self.assertEqual(libraries, {"libstarguard", "libstarguard-shapes"})
        self.assertFalse([name for name in files if name.startswith("_starguard")])
        info = os.path.join("site", f"starguard-{starguard.__version__}.dist-info")
        self.assertLessEqual({"METADATA", "RECORD", "WHEEL", "licenses"}, set(os.listdir(info)))
        blocks = example()
        self.assertEqual(len(blocks), 1)
        starguard.sample("l-room", vertices=500).write("model.off")
        told = subprocess.run([sys.executable, "-B", "-c", "import starguard; print(starguard.__file__)\n"
                               + blocks[0]], check=True, env=environment, capture_output=True,
                              text=True).stdout.splitlines()
        self.assertEqual(os.path.dirname(told[0]), os.path.abspath("site/starguard"))
        self.assertRegex(told[1], r"^1 guards, lower bound 1$")
        self.assertTrue(told[-1].startswith("verified: True"), told)

    def test_what_is_missing_is_named(self):
        """Neither a compiler nor libraries are found: one line says which packages to install."""
        os.mkdir("bin")
        environment = {**os.environ, "PATH": os.path.abspath("bin"), "PKG_CONFIG_LIBDIR": self.folder}
        environment.pop("STARGUARD_BUILD")
        done = subprocess.run([sys.executable, "-B", "-c", "import backend; backend.build_wheel('.')"],
                              env={**environment, "PYTHONPATH": os.path.join(SOURCE, "python", "tools")},
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for package in ("cmake", "gcc", "g++", "pkg-config"):
            self.assertIn(f" {package}", done.stderr)
        os.symlink(shutil.which("pkg-config"), "bin/pkg-config")
        done = subprocess.run([sys.executable, "-B", "-c", "import backend; print(backend.missing_packages())"],
                              env={**environment, "PYTHONPATH": os.path.join(SOURCE, "python", "tools")},
                              capture_output=True, text=True, check=True)
        self.assertIn("coinor-libcbc-dev", done.stdout)

    def test_without_numpy(self):
        """The message names it."""
        done = subprocess.run([sys.executable, "-B", "-c", "import sys; sys.modules['numpy'] = None\n"
                               "import starguard"], capture_output=True, text=True, check=False)
        self.assertIn("ImportError: starguard needs NumPy", done.stderr)


if __name__ == "__main__":
    main()
