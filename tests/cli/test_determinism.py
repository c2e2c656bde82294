# SPDX-License-Identifier: Apache-2.0
"""Every result file has the same bytes at 1 and at 7 threads, and the comparison sees a difference.
The whole matrix of threads, compilers and optimisation is scripts/determinism.py --matrix."""
import os
import stat
import subprocess
import sys
import unittest

import support

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts"))
import determinism  # noqa: E402


class SameBytes(support.Case):
    def test_threads(self):
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
        before = determinism.COMMANDS
        self.addCleanup(setattr, determinism, "COMMANDS", before)
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
