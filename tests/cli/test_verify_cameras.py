# SPDX-License-Identifier: Apache-2.0
"""verify refuses 1,000 forged plans of cameras: poses that stay, zones, tilt, density, needs, tables, curves."""
import copy
import csv
import io
import json
import random
from concurrent.futures import ThreadPoolExecutor

from support import LONG, Case, main
from test_cameras import room

SENSOR = ("--fov", "90,60", "--range", "6")
# Keys that no claim is about, with another value of each: they pass.
NO_CLAIMS = {
    ("options", "significance"): 0.2, ("options", "coarsest"): 4999,
    ("candidates",): 99999,  # more than there were
    ("model", "file"): "elsewhere.obj",
}


class Forged(Case):
    def setUp(self):
        super().setUp()
        self.rng = random.Random(7)
        self.write("room.obj", room(1))
        self.write("stay.txt", "0.5 2.8 0.5 1 -0.5 1\n7.5 2.8 5.5 -1 -0.5 -1\n")

    def plan(self, *words):
        self.run_text("guard", "room.obj", *SENSOR, "--keep", "stay.txt", *words, "-o", "g.json", "--table", "t.csv",
                      "--summary", "s.csv", "--curve", "c.csv", "--quiet", "--threads", "1", "--effort", "quick", "--count", "60")
        out, _ = self.verify("g.json", "t.csv", "s.csv", "c.csv")
        self.assertIn("verified", out)
        return json.loads(self.read("g.json"))

    def verify(self, result, faces, summary, curve, status=0, keep="stay.txt"):
        return self.run_text("verify", "room.obj", result, "--keep", keep, "--table", faces, "--summary", summary,
                             "--curve", curve, "--threads", "1", status=status)

    def lines(self, name):
        return list(csv.reader(io.StringIO(self.read(name).decode())))

    # ---- of the result: each changes it and returns what it did ----

    def kept(self, result):
        return [i for i, guard in enumerate(result["guards"]) if guard["kept"]]

    def added(self, result):
        return [i for i, guard in enumerate(result["guards"]) if not guard["kept"]]

    def forge_place(self, result):
        i = self.rng.choice(self.kept(result))
        k = self.rng.randrange(3)
        result["guards"][i]["position"][k] += self.rng.choice((-1, 1)) * 10 ** self.rng.uniform(-12, -1)

    def forge_look(self, result):
        guard = result["guards"][self.rng.choice(self.kept(result))]
        guard["direction"][self.rng.randrange(3)] += self.rng.choice((-1, 1)) * 10 ** self.rng.uniform(-12, -1)

    def forge_up(self, result):
        guard = result["guards"][self.rng.choice(self.kept(result))]
        guard["up"][self.rng.choice((0, 2))] += 10 ** self.rng.uniform(-9, -1)

    def forge_flag(self, result):
        guard = self.rng.choice(result["guards"])
        guard["kept"] = not guard["kept"]

    def forge_told(self, result):
        result["options"]["kept"] += self.rng.choice((-1, 1, 2))

    def forge_order(self, result):
        i, j = self.rng.choice(self.kept(result)), self.rng.choice(self.added(result))
        guards = result["guards"]
        guards[i], guards[j] = guards[j], guards[i]

    def forge_zone(self, result):
        """A box that leaves a camera that was added out, or takes it in."""
        p = result["guards"][self.rng.choice(self.added(result))]["position"]
        if self.rng.random() < 0.5:
            r = [self.rng.uniform(0.01, 0.5) for _ in range(6)]
            box = [p[k] - r[k] for k in range(3)] + [p[k] + r[3 + k] for k in range(3)]
            result["scene"].setdefault("zones", []).append({"excludes": True, "box": box})
        else:
            k = self.rng.randrange(3)
            low = [-1.0, -1.0, -1.0]
            low[k] = p[k] + self.rng.uniform(1e-6, 0.3)
            zones = [zone for zone in result["scene"].get("zones", []) if zone["excludes"]]
            result["scene"]["zones"] = zones + [{"excludes": False, "box": low + [9.0, 9.0, 9.0]}]

    def forge_tilt(self, result):
        i = self.rng.choice(self.added(result))
        x, y, z = result["guards"][i]["direction"]
        if self.rng.random() < 0.5:
            result["guards"][i]["direction"] = [x, abs(y) + self.rng.uniform(0, 2), z]
        else:
            result["options"]["tilt"] = [self.rng.uniform(1, 40), 89]

    def forge_density(self, result):
        if self.rng.random() < 0.5:
            result["options"]["density"] = self.rng.choice((400, 900, 3000, "identify"))
        else:
            result["options"]["resolution"][0] *= self.rng.uniform(0.01, 0.15)

    def forge_needs(self, result):
        kind = self.rng.randrange(3)
        if kind == 0:
            result["coverage"]["met_needs"] += self.rng.choice((-2, -1, 1))
        elif kind == 1:
            need = self.rng.choice(result["scene"]["needs"])
            need[1] = self.rng.randrange(len(result["guards"]) + 1, 1000)
        else:
            need = self.rng.choice(result["scene"]["needs"])
            need[2:] = [self.rng.uniform(3000, 1e6)]

    def forge_counts(self, result):
        kind = self.rng.randrange(4)
        if kind == 0:
            self.rng.choice(result["guards"])["faces"] += self.rng.choice((-1, 1, 2))
        elif kind == 1:
            result["coverage"]["area"] *= 1 + self.rng.choice((-1, 1)) * 10 ** self.rng.uniform(-7, -1)
        elif kind == 2:
            result["coverage"]["faces"] *= 1 - 10 ** self.rng.uniform(-7, -1)
        else:
            point = self.rng.choice(result["coverage"]["curve"])
            point[1] *= 1 - 10 ** self.rng.uniform(-7, -1)

    def forge_bound(self, result):
        result["lower_bound"] = len(self.added(result)) + self.rng.randrange(1, 5)

    # ---- of tables ----

    def forge_field(self, lines):
        """Another number, or another word, in one field."""
        while True:
            row = self.rng.randrange(1, len(lines))
            column = self.rng.randrange(len(lines[row]))
            text = lines[row][column]
            if text == "":
                lines[row][column] = self.rng.choice(("0", "x"))
            elif text.isdigit():
                lines[row][column] = str(int(text) + self.rng.randrange(1, 5))
            elif text[0].isdigit() and " " not in text:
                factor = 1 + self.rng.choice((-1, 1)) * 10 ** self.rng.uniform(-8, 0)
                if abs(float(text) * (factor - 1)) < 1e-6:
                    continue
                lines[row][column] = repr(float(text) * factor)
            else:
                lines[row][column] = text + self.rng.choice(("x", " 7", "s"))
            return

    def forge_rows(self, lines):
        kind, i = self.rng.randrange(4), self.rng.randrange(1, len(lines))
        if kind == 0:
            del lines[i]
        elif kind == 1:
            lines.insert(i, list(lines[i]))
        elif kind == 2:
            j = 1 + (i % (len(lines) - 1))
            lines[i], lines[j] = lines[j], lines[i]
        else:
            lines[i] = lines[i][:-1] if self.rng.random() < 0.5 else lines[i] + [""]

    def forge_head(self, lines):
        lines[0][self.rng.randrange(len(lines[0]))] += "s"

    def forge_curve(self, lines):
        kind, i = self.rng.randrange(3), self.rng.randrange(1, len(lines))
        if kind == 0:  # beyond its bound
            lines[i][1] = repr(float(lines[i][2]) + 10 ** self.rng.uniform(-7, -1))
        elif kind == 1:  # below what the cameras see
            lines[i][2] = repr(float(lines[i][1]) - 10 ** self.rng.uniform(-7, -1))
        else:
            lines[i][0] = str(self.rng.randrange(90, 99))

    RESULT = (forge_place, forge_look, forge_up, forge_flag, forge_told, forge_order, forge_zone, forge_tilt,
              forge_density, forge_needs, forge_counts, forge_bound)
    TABLE = {"t.csv": (forge_field, forge_rows, forge_head), "s.csv": (forge_field, forge_rows, forge_head),
             "c.csv": (forge_curve, forge_curve, forge_rows, forge_head)}

    def forge(self, number, result, tables):
        """Names of the files of a forged plan, and what was forged."""
        names = {"g.json": "g.json", "t.csv": "t.csv", "s.csv": "s.csv", "c.csv": "c.csv"}
        what = self.rng.choice(("g.json", "g.json", "g.json", "t.csv", "s.csv", "c.csv"))
        names[what] = f"{number}-{what}"
        if what == "g.json":
            own = copy.deepcopy(result)
            how = self.rng.choice(self.RESULT)
            how(self, own)
            self.write(names[what], json.dumps(own))
        else:
            own = copy.deepcopy(tables[what])
            how = self.rng.choice(self.TABLE[what])
            how(self, own)
            if own == tables[what]:
                return self.forge(number, result, tables)
            text = io.StringIO()
            csv.writer(text, lineterminator="\n").writerows(own)
            self.write(names[what], text.getvalue())
        return names, f"{what} {how.__name__}"

    def refuse(self, count, *words):
        result = self.plan(*words)
        tables = {name: self.lines(name) for name in ("t.csv", "s.csv", "c.csv")}
        forged = [self.forge(number, result, tables) for number in range(count)]

        def run(one):
            names, what = one
            with self.start("verify", "room.obj", names["g.json"], "--keep", "stay.txt", "--table", names["t.csv"],
                            "--summary", names["s.csv"], "--curve", names["c.csv"], "--threads", "1") as process:
                out, err = process.communicate()
            # what makes no sense is refused as it is read
            return what, process.returncode == 4 and b"FAILED" in out or process.returncode == 2 and b"valid" in err

        with ThreadPoolExecutor(2) as pool:
            told = list(pool.map(run, forged))
        self.assertEqual([what for what, failed in told if not failed], [])
        return {what for what, _ in told}

    def test_a_thousand(self):
        """Of each of two plans 500, or 60 without STARGUARD_LONG."""
        count = 500 if LONG else 60
        kinds = self.refuse(count, "--resolution", "1920,1080", "--density", "observe", "--tilt", "-60,0", "--without",
                            "3,-1,-1,5,4,7", "--require", "door=2,observe")
        kinds |= self.refuse(count, "--resolution", "1920,1080", "--density", "100", "--tilt", "-70,0", "--within",
                             "0,0.5,0,8,3,6", "--require", "floor=2", "--require", "door=1,130")
        self.assertEqual(len(kinds), len(self.RESULT) + sum(len(set(forgers)) for forgers in self.TABLE.values()))

    def test_no_claims(self):
        result = self.plan("--resolution", "1920,1080", "--density", "observe")
        for keys, value in NO_CLAIMS.items():
            own = copy.deepcopy(result)
            at = own
            for key in keys[:-1]:
                at = at[key]
            at[keys[-1]] = value
            self.write("same.json", json.dumps(own))
            self.verify("same.json", "t.csv", "s.csv", "c.csv")

    def test_what_stands_beside(self):
        self.plan()
        self.write("other.txt", "0.5 2.8 0.5 1 -0.5 1\n")
        out, _ = self.verify("g.json", "t.csv", "s.csv", "c.csv", status=4, keep="other.txt")
        self.assertIn("2 guards stay that were given (found: 1)", out)
        self.usage_error("verify", "room.obj", "g.json", "g.json", "--table", "t.csv", says="one GUARDS.json")
        _, err = self.run_text("verify", "room.obj", "g.json", "--table", "none.csv", status=2)
        self.assertIn("none.csv", err)
        out, _ = self.run_text("verify", "room.obj", "g.json", "--verbose")
        self.assertIn("not checked: that the guards that stay are those that were given", out)
        for bad in (b"", b"\0", b'"', b'face,"', b"a" * 5000, b"," * 99):
            self.write("bad.csv", bad)
            self.verify("g.json", "bad.csv", "bad.csv", "bad.csv", status=4)


if __name__ == "__main__":
    main()
