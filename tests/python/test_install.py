# SPDX-License-Identifier: Apache-2.0
"""`pip install .` from a checkout, and the example of the README with what it has installed."""
import importlib.util
import os
import re
import subprocess
import sys
import unittest

import starguard
from support import SOURCE, Case, main


def example():
    """The Python code of the README."""
    with open(os.path.join(SOURCE, "README.md"), encoding="utf-8") as file:
        return re.findall(r"^```python\n(.*?)^```$", file.read(), flags=re.DOTALL | re.MULTILINE)


@unittest.skipUnless(all(importlib.util.find_spec(name) for name in ("pip", "setuptools", "wheel")),
                     "pip, setuptools or wheel is not installed")
class Install(Case):
    def install(self):
        """Installs into a folder of its own, with the library that is built already."""
        environment = {**os.environ, "PYTHONPATH": ""}
        before = set(os.listdir(SOURCE))
        subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index",
                        "--no-build-isolation", "--no-cache-dir", "--target", "site",
                        "--disable-pip-version-check", "--root-user-action=ignore",
                        os.path.abspath(SOURCE)], check=True, env=environment)
        self.assertEqual(set(os.listdir(SOURCE)), before, "files are left beside the sources")
        return {**environment, "PYTHONPATH": os.path.abspath("site")}

    def test_it_works_where_it_is_installed(self):
        environment = self.install()
        files = set(os.listdir("site/starguard"))
        self.assertLessEqual({"_ffi.py", "py.typed", "__init__.py"}, files)
        libraries = {re.sub(r"\.so\..*", "", file) for file in files if ".so." in file}
        self.assertEqual(libraries, {"libstarguard", "libstarguard-shapes"})
        self.assertFalse([name for name in files if name.startswith("_starguard")])
        self.assertIn(f"starguard-{starguard.__version__}.dist-info", os.listdir("site"))
        blocks = example()
        self.assertEqual(len(blocks), 1)
        starguard.sample("l-room", vertices=500).write("model.off")
        told = subprocess.run([sys.executable, "-B", "-c", "import starguard; print(starguard.__file__)\n"
                               + blocks[0]], check=True, env=environment, capture_output=True,
                              text=True).stdout.splitlines()
        self.assertEqual(os.path.dirname(told[0]), os.path.abspath("site/starguard"))
        self.assertRegex(told[1], r"^1 guards, lower bound 1$")
        self.assertTrue(told[-1].startswith("verified: True"), told)


if __name__ == "__main__":
    main()
