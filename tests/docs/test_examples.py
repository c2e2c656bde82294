# SPDX-License-Identifier: Apache-2.0
"""Every example of every command's help, run as it stands there."""
import json
import re
import shutil
import subprocess
import unittest

from fixtures import PROGRAM, Fixtures, quick

TABLE = json.loads(subprocess.run([PROGRAM, "help", "--json"], check=True,
                                  capture_output=True).stdout)

# What stands ready before the examples of a command, made by other commands.
BEFORE = {
    "match": ["cp models/cat.json models/dog.json ."],
    "verify": ["starguard guard model.off -o guards.json --method greedy",
               "cp guards.json ilp.json; cp guards.json greedy.json",
               "starguard decompose model.off -o pieces.vtk --report pieces.json --effort 100"],
    "view": ["cp model.off horse.off", "starguard skeleton horse.off -o skeleton.vtk",
             "starguard decompose horse.off -o pieces.vtk --report pieces.json --effort 100",
             "starguard morph horse_0.off horse_1.off --frames 3 -o frames --method linear",
             "starguard map --solid room.off --to ball -o map.vtu",
             "starguard db create shapes.db", "starguard db add shapes.db model.off"],
    "export": ["cp model.off horse.off"],
    "db add": ["starguard db create shapes.db"],
    **{f"db {name}": ["cp models/ready.db shapes.db"]
       for name in ["remove", "list", "query", "matrix", "evaluate"]},
}


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fixtures = Fixtures()
        cls.addClassCleanup(cls.fixtures.close)

    def run_examples(self, command):
        text = command["examples"]
        lines = [line for line in text.replace("\\\n", " ").split("\n") if not line.startswith("#")]
        own = [line for line in lines if f"starguard {command['name']}" in line]
        self.assertGreaterEqual(len(lines), 2, "too few examples")
        self.assertGreaterEqual(len(own), 1, "no example of the command itself")
        folder = self.fixtures.use(command["name"], *BEFORE.get(command["name"], []))
        for line in lines:
            if "| jq" in line and shutil.which("jq") is None:
                print(f"skipped, no jq: {line}")
                continue
            self.fixtures.shell(folder, quick(line))

    def test_comments(self):
        """Examples are commands with a line before the first that says what is done."""
        for command in TABLE["commands"]:
            self.assertTrue(command["examples"].startswith("# "), command["name"])
            self.assertNotRegex(command["examples"], r"\n\n|\n$")


def add_test(command):
    name = "test_" + re.sub(r"\W", "_", command["name"])
    setattr(Examples, name, lambda self: self.run_examples(command))


for entry in TABLE["commands"]:
    add_test(entry)

if __name__ == "__main__":
    unittest.main(verbosity=2)
