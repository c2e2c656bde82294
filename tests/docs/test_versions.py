# SPDX-License-Identifier: Apache-2.0
"""All that names the version agrees, and `make release` refuses where something does not."""
import os
import re
import shutil
import subprocess
import tempfile
import unittest

SOURCE = os.environ["STARGUARD_SOURCE"]
PROGRAM = os.environ["STARGUARD"]
NAMED = ["CMakeLists.txt", "examples/CMakeLists.txt", "CITATION.cff", "CHANGELOG.md", "include/starguard/version.h"]


class Versions(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = scratch.name
        for name in [*NAMED, "scripts/release.sh", "docs/releases"]:
            target = os.path.join(self.folder, name)
            os.makedirs(os.path.dirname(target), exist_ok=True)
            copy = shutil.copytree if os.path.isdir(os.path.join(SOURCE, name)) else shutil.copy
            copy(os.path.join(SOURCE, name), target)
        self.version = subprocess.run([PROGRAM, "--version"], check=True, capture_output=True,
                                      text=True).stdout.split()[1]

    def agree(self):
        return subprocess.run(["sh", "scripts/release.sh", "versions"], cwd=self.folder, capture_output=True,
                              text=True, check=False)

    def test_they_agree(self):
        done = self.agree()
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_difference_is_refused(self):
        for name in NAMED:
            path = os.path.join(self.folder, name)
            with open(path, encoding="utf-8") as file:
                before = file.read()
            other = before.replace(self.version, "7.7.7").replace(self.version[:3], "7.7")
            if name.endswith(".h"):
                other = re.sub(r"(VERSION_PATCH) \d+", r"\1 77", before)
            self.assertNotEqual(other, before, name)
            with open(path, "w", encoding="utf-8") as file:
                file.write(other)
            done = self.agree()
            self.assertEqual(done.returncode, 1, name)
            self.assertIn(name if not name.endswith(".h") else "CMakeLists.txt", done.stderr)
            with open(path, "w", encoding="utf-8") as file:
                file.write(before)
        shutil.rmtree(os.path.join(self.folder, "docs", "releases"))
        self.assertIn("docs/releases", self.agree().stderr)

    def test_the_citation_is_complete(self):
        with open(os.path.join(SOURCE, "CITATION.cff"), encoding="utf-8") as file:
            text = file.read()
        keys = set(re.findall(r"^([a-z-]+):", text, flags=re.MULTILINE))
        self.assertLessEqual({"cff-version", "title", "message", "authors", "version", "references"}, keys)
        try:
            import yaml
        except ImportError:
            return
        read = yaml.safe_load(text)
        self.assertEqual(read["version"], self.version)
        self.assertEqual(read["references"][0]["authors"][0]["family-names"], "Yu")


if __name__ == "__main__":
    unittest.main(verbosity=2)
