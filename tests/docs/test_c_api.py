"""docs/c-api.md is what the headers say, and leaves no function out."""
import os
import re
import subprocess
import tempfile
import unittest

SOURCE = os.environ.get("STARGUARD_SOURCE", os.path.join(os.path.dirname(__file__), "..", ".."))


class Reference(unittest.TestCase):
    def test_current(self):
        run = subprocess.run([os.path.join(SOURCE, "scripts", "c-api.py"), "--check"],
                             capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)

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
        with open(f"{SOURCE}/docs/c-api.md", encoding="utf-8") as file:
            told = set(re.findall(r"\b(starg_\w+)\(", file.read()))
        self.assertEqual(names - told, set())

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
