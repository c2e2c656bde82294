# SPDX-License-Identifier: Apache-2.0
"""Every result file has the same bytes at 1 and at 7 threads, and the comparison sees a difference.
The whole matrix of threads, compilers and optimisation is scripts/determinism.py --matrix."""
import os
import re
import stat
import subprocess
import sys
import unittest

import support

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts"))
import determinism  # noqa: E402


# What is put in the commands without STARGUARD_LONG: the same is done with less. Of 520 vertices: spectra are taken
# of a surface of 2,000 at least, so one of 500 is subdivided twice.
QUICK = [(r"--vertices \d{3,}", "--vertices 520"), (r"--refine-lines \d+", "--refine-lines 60000"),
         (r"--count \d+", "--count 60"), (r"--range 0\.5 ", "--range 0.7 ")]


def quick(command):
    for pattern, words in [] if support.LONG else QUICK:
        command = re.sub(pattern, words, command)
    return command


class SameBytes(support.Case):
    def setUp(self):
        super().setUp()
        self.addCleanup(setattr, determinism, "COMMANDS", determinism.COMMANDS)

    def test_threads(self):
        determinism.COMMANDS = [quick(command) for command in determinism.COMMANDS]
        program = os.path.abspath(support.PROGRAM)
        count, differing = determinism.compare([("this build", program)], [1, 7])
        self.assertEqual(differing, [])
        self.assertGreater(count, 80)

    def test_differences_are_seen(self):
        """A program that adds a blank to one file at 7 threads is found out, by the file's name."""
        program = self.write("liar", f"""#!/bin/sh
{os.path.abspath(support.PROGRAM)} "$@" || exit $?
case "$*" in *ilp.json*--threads\\ 7) printf ' ' >>ilp.json ;; esac
""")
        os.chmod(self.path(program), stat.S_IRWXU)
        determinism.COMMANDS = ["sample horse --vertices 500 -o horse.off",
                                "guard horse.off -o ilp.json --method ilp --count 20"]
        count, differing = determinism.compare([("liar", self.path(program))], [1, 7])
        self.assertEqual(count, 4)
        self.assertEqual(len(differing), 1)
        self.assertIn("ilp.json differs", differing[0])

    def test_failures_are_told(self):
        script = os.path.join(os.path.dirname(determinism.__file__), "determinism.py")
        process = subprocess.run([sys.executable, "-B", script, "/bin/false"], capture_output=True,
                                 text=True, check=False)
        self.assertEqual(process.returncode, 1)
        self.assertIn("status 1", process.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
