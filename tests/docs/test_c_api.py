# SPDX-License-Identifier: Apache-2.0
"""The C reference that is made of the headers leaves no function out."""
import os
import re
import subprocess
import tempfile
import unittest

SOURCE = os.environ.get("STARGUARD_SOURCE", os.path.join(os.path.dirname(__file__), "..", ".."))


class Reference(unittest.TestCase):
    def test_complete(self):
        """By the compiler's list of declarations, which the script knows nothing of."""
        with tempfile.NamedTemporaryFile() as listing:
            subprocess.run(["gcc", "-x", "c", "-", "-fsyntax-only", "-I", f"{SOURCE}/include",
                            "-aux-info", listing.name], check=True,
                           input=b"#include <starguard/starguard.h>\n")
            lines = [line for line in listing.read().decode().split("\n")
                     if "include/starguard/" in line]
        names = {re.search(r"\b(\w+) \(", line.split("*/", 1)[1]).group(1) for line in lines}
        self.assertGreater(len(names), 100)
        with tempfile.NamedTemporaryFile() as page:
            subprocess.run([os.path.join(SOURCE, "scripts", "c-api.py"), page.name], check=True)
            text = page.read().decode()
        self.assertEqual(names - set(re.findall(r"\b(starg_\w+)\(", text)), set())
        self.assertTrue(text.startswith("# C reference\n"))

    def test_readme(self):
        """The program of the README compiles."""
        with open(f"{SOURCE}/README.md", encoding="utf-8") as file:
            text = re.search(r"```c\n(.*?)```", file.read(), re.S).group(1)
        head, body = text.split("\n", 1)
        program = f"#include <stdio.h>\n{head}\nint main(void) {{\n{body}\nreturn 0;\n}}\n"
        run = subprocess.run(["gcc", "-x", "c", "-", "-fsyntax-only", "-Wall", "-Werror", "-I",
                              f"{SOURCE}/include"], input=program.encode(), capture_output=True,
                             check=False)
        self.assertEqual(run.returncode, 0, run.stderr.decode())


if __name__ == "__main__":
    unittest.main(verbosity=2)
