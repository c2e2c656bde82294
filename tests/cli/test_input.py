# SPDX-License-Identifier: Apache-2.0
"""Bad input: a message and status 2, never a crash, a hang or an output."""
import os
import unittest

import support
from support import TETRAHEDRON

COMMANDS = [["check"], ["repair", "-o", "out.off"], ["visible", "--from", ".1,.1,.1"],
            ["guard", "-o", "g.json"]]


class BadFiles(support.Case):
    def reject(self, name, says, element=None):
        names = self.names()
        for command, *options in COMMANDS:
            out, err = self.run_text(command, name, *options, status=2)
            self.assertEqual(out, "")
            self.assertIn(says, err)
        detail = self.run_json("check", name, status=2)["error"]
        self.assertIn(says, detail["message"])
        self.assertEqual(detail["exit_status"], 2)
        if element is not None:
            self.assertEqual((detail["element"], detail["indices"]), element)
        self.assertEqual(self.names(), names)

    def test_missing(self):
        self.reject("none.off", "No such file")
        self.reject("none.off/x", "No such file")

    def test_directory(self):
        self.reject(".", "directory")

    def test_empty(self):
        self.write("e.off", "")
        self.reject("e.off", "empty")
        _, err = self.run_text("check", "-", status=2)
        self.assertIn("standard input", err)

    def test_three_gigabytes(self):
        self.write("big.off", "OFF\n")
        os.truncate(self.path("big.off"), 3 << 30)
        self.reject("big.off", "larger than")

    def test_unreadable(self):
        if os.geteuid() == 0:
            raise unittest.SkipTest("root reads everything")
        self.write("m.off", TETRAHEDRON)
        os.chmod(self.path("m.off"), 0)
        self.reject("m.off", "Permission denied")

    def test_no_format(self):
        self.write("x.txt", "hello\n")
        self.reject("x.txt", "unknown format")
        self.write("zero", b"\0" * 1000)
        self.reject("zero", "unknown format")

    def test_lines_are_named(self):
        self.write("m.off", TETRAHEDRON.replace("0 0 1", "0 0 x"))
        self.reject("m.off", "line 6", ("line", [6]))
        self.write("m.off", TETRAHEDRON.replace("3 1 2 3", "3 1 2 9"))
        self.reject("m.off", "line 10", ("line", [10]))
        self.write("m.off", "\n".join(TETRAHEDRON.splitlines()[:7]))
        self.reject("m.off", "m.off")

    def test_numbers(self):
        for word in ["nan", "inf", "1e100", "-1e300"]:
            self.write("m.off", TETRAHEDRON.replace("0 0 1", f"0 0 {word}"))
            for command, *options in COMMANDS:
                self.run_text(command, "m.off", *options, status=2)
        self.assertEqual(self.names(), ["m.off"])

    def test_scales(self):
        for scale in ["1e-60", "1e90"]:
            text = TETRAHEDRON.replace("1 0 0", f"{scale} 0 0").replace("0 1 0", f"0 {scale} 0")
            text = text.replace("0 0 1\n", f"0 0 {scale}\n")
            self.write("m.off", text)
            self.run_text("check", "m.off")
            part = float(scale) / 10
            report = self.run_json("visible", "m.off", "--from", ",".join([repr(part)] * 3))
            self.assertEqual(report["points"][0]["faces"], [0, 1, 2, 3])
            self.assertAlmostEqual(report["points"][0]["area"], 1)
            self.run_text("guard", "m.off", "-o", "g.json", "--count", "10")
            self.run_text("verify", "m.off", "g.json")


if __name__ == "__main__":
    support.main()
