# SPDX-License-Identifier: Apache-2.0
"""Machines that nothing has been tested on are refused when CMake configures (docs/portability.md)."""
import os
import shutil
import subprocess
import tempfile
import unittest

SOURCE, CMAKE = os.environ["STARGUARD_SOURCE"], os.environ["CMAKE"]
REFUSED = {"i686-linux-gnu": "have 4 bytes", "x86_64-linux-gnux32": "have 4 bytes", "s390x-linux-gnu": "is BIG_ENDIAN"}


@unittest.skipUnless(shutil.which("clang"), "clang compiles for each of them without other packages")
class Machines(unittest.TestCase):
    def configure(self, target):
        """What CMake says. It tries compilers by libraries: no machine but this one has anything to link with."""
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run(
                [CMAKE, "-S", SOURCE, "-B", folder, "-DCMAKE_SYSTEM_NAME=Linux", "-DCMAKE_C_COMPILER=clang",
                 f"-DCMAKE_C_COMPILER_TARGET={target}", "-DCMAKE_TRY_COMPILE_TARGET_TYPE=STATIC_LIBRARY"],
                capture_output=True, text=True, check=False)
        self.assertNotEqual(done.returncode, 0, target)
        return " ".join(done.stderr.split())

    def test_refused(self):
        for target, reason in REFUSED.items():
            with self.subTest(target=target):
                said = self.configure(target)
                self.assertIn(f"{reason}: no test has run there", said)


if __name__ == "__main__":
    unittest.main()
