# SPDX-License-Identifier: Apache-2.0
"""The instance library: docs/instances.csv holds what the recipes make, bounds do not exceed guards, and a
result of the table can be had again."""
import csv
import hashlib
import importlib.util
import json
import pathlib

from support import Case, main

ROOT = pathlib.Path(__file__).resolve().parents[2]


def library():
    spec = importlib.util.spec_from_file_location("instances", ROOT / "bench" / "instances.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Instances(Case):
    def setUp(self):
        super().setUp()
        with (ROOT / "docs" / "instances.csv").open(newline="") as file:
            self.rows = {row["name"]: row for row in csv.DictReader(file)}
        self.recipes = library().instances()

    def test_table(self):
        self.assertEqual(set(self.rows), set(self.recipes))
        for row in self.rows.values():
            for target in ("points", "faces", "vertices"):
                guards, bound = row[f"{target}_guards"], row[f"{target}_bound"]
                if guards and bound:
                    self.assertLessEqual(int(bound), int(guards), row["name"])
            # whoever sees every point sees every vertex
            if row["points_guards"]:
                self.assertLessEqual(int(row["vertices_bound"]), int(row["points_guards"]), row["name"])

    def test_files(self):
        """Coordinates of cubes are whole, so these are the same bytes everywhere."""
        for name in ("polycube-30-0", "polycube-200-9", "maze-60-3", "maze-200-0", "comb-100-5", "spikes-30-2"):
            kind, pose, size = self.recipes[name]
            self.run_text("sample", kind, "--pose", str(pose), "--vertices", str(size), "-o", "i.off")
            self.assertEqual(hashlib.sha256(self.read("i.off")).hexdigest(), self.rows[name]["sha256"], name)

    def test_result(self):
        kind, pose, size = self.recipes["maze-30-0"]
        self.run_text("sample", kind, "--pose", str(pose), "--vertices", str(size), "-o", "i.off")
        self.run_text("guard", "i.off", "-o", "i.json", "--target", "points", "--prove")
        found = json.loads(self.read("i.json"))
        self.assertEqual(len(found["guards"]), int(self.rows["maze-30-0"]["points_guards"]))
        self.assertEqual(found["lower_bound_everywhere"], int(self.rows["maze-30-0"]["points_bound"]))


if __name__ == "__main__":
    main()
