# SPDX-License-Identifier: Apache-2.0
"""What the tests of the Python package share: scratch folders, small models, the command line."""
import os
import subprocess
import tempfile
import unittest

import starguard

SOURCE = os.environ.get("STARGUARD_SOURCE", os.path.join(os.path.dirname(__file__), "..", ".."))
PROGRAM = os.environ.get("STARGUARD", "build/starguard")
SANITIZE = os.environ.get("STARGUARD_SANITIZE")
# Limits on processor time grow with it: programs under a sanitizer, or that count lines, are several times slower.
SLOWNESS = int(os.environ.get("STARGUARD_SLOWNESS", "1"))

VERTICES = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
FACES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


class Case(unittest.TestCase):
    """A test in a scratch folder of its own."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = scratch.name
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.folder)

    def cli(self, *words, status=0):
        """Runs the command line in the scratch folder; what it printed."""
        done = subprocess.run([os.path.abspath(os.path.join(self.start, PROGRAM)), *map(str, words)],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stdout

    start = os.getcwd()

    def read(self, name):
        with open(name, "rb") as file:
            return file.read()

    def fails(self, kind, says, function, *arguments, **options):
        """Calls what must raise `kind` with a message that holds `says`; the exception."""
        with self.assertRaises(kind) as caught:
            function(*arguments, **options)
        self.assertIs(type(caught.exception), kind)
        self.assertIsInstance(caught.exception, starguard.Error)
        self.assertIn(says, str(caught.exception))
        return caught.exception


def main():
    unittest.main(verbosity=2)
