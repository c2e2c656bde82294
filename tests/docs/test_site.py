# SPDX-License-Identifier: Apache-2.0
"""The site (scripts/site.py): every page is in it, no link is dead, nothing is loaded from elsewhere."""
import importlib.util
import os
import re
import subprocess
import sys
import tempfile
import unittest

from fixtures import PROGRAM, SOURCE

BUILD = os.environ.get("STARGUARD_BUILD", os.path.dirname(PROGRAM))
SCRIPT = os.path.join(SOURCE, "scripts", "site.py")


def script():
    spec = importlib.util.spec_from_file_location("starguard_site", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Check(unittest.TestCase):
    """The check itself finds what is wrong."""

    def messages(self, text):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "a.html"), "w", encoding="utf-8") as file:
                file.write(text)
            return script().check(folder)[0]

    def test_sound(self):
        self.assertEqual(self.messages('<h1 id="x">x</h1><a href="#x"></a><a href="a.html#x"></a>'
                                       '<a href="https://example.org"></a>'), [])

    def test_dead(self):
        self.assertEqual(len(self.messages('<a href="b.html"></a><a href="#y"></a><img src="c.png">'
                                           '<script src="https://example.org/d.js"></script>')), 4)


@unittest.skipUnless(importlib.util.find_spec("mkdocs"), "mkdocs is not installed: scripts/install-deps.sh site")
class Site(unittest.TestCase):
    def test_site(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-B", SCRIPT, BUILD, folder], capture_output=True, text=True,
                                  check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            for name in ("index.html", "docs/cameras.html", "docs/fields.html", "docs/c-api.html", "CHANGELOG.html"):
                self.assertTrue(os.path.exists(os.path.join(folder, name)), name)
            with open(os.path.join(folder, "search", "main.js"), encoding="utf-8") as file:
                index = file.read()
            self.assertRegex(index, r'"location": "docs/cameras.html#sensors"')
            with open(os.path.join(folder, "search.html"), encoding="utf-8") as file:
                self.assertTrue(re.search(r'src="[^"]*search/lunr\.js".*src="[^"]*search/main\.js"', file.read(), re.S))


if __name__ == "__main__":
    unittest.main(verbosity=2)
