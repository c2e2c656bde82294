# SPDX-License-Identifier: Apache-2.0
"""view --report: a sheet to hand over. Its pictures show what is there, its tables are those of the files."""
import base64
import json
import math
import re
import struct
import zlib
from html.parser import HTMLParser

import halls
from support import Case, main
from test_cameras import ROOM, room
from test_scenes import box, off

# One looks at the far wall of the room, beyond its range, one at the near wall, two down.
POSES = "1 1.5 3  1 0 0\n7 1.5 3  1 0 0\n4 2.5 3  0 -1 -1\n4.6 2.5 3  0 -1 -1\n"
FOV, RANGE = (90, 60), 4


def pixels(png):
    """Width, height, and rows of bytes, three for each pixel."""
    at, data = 8, b""
    while at < len(png):
        size, kind = struct.unpack(">I4s", png[at:at + 8])
        body = png[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height = struct.unpack(">II", body[:8])
        data += body if kind == b"IDAT" else b""
        at += 12 + size
    raw, rows, before = zlib.decompress(data), [], bytes(3 * width)
    for y in range(height):
        line = raw[y * (3 * width + 1):(y + 1) * (3 * width + 1)]
        assert line[0] == 4  # Paeth
        row = bytearray(3 * width)
        for k in range(3):
            left, corner, band = 0, 0, bytearray()
            for value, up in zip(line[1 + k::3], before[k::3]):
                if up == corner:
                    guess = left
                elif left == corner:
                    guess = up
                else:
                    from_left, from_up = abs(up - corner), abs(left - corner)
                    from_corner = abs(left + up - 2 * corner)
                    guess = (left if from_left <= from_up and from_left <= from_corner else
                             up if from_up <= from_corner else corner)
                left, corner = (value + guess) & 255, up
                band.append(left)
            row[k::3] = band
        rows.append(row)
        before = row
    return width, height, rows


class Page(HTMLParser):
    """Tables by the heading above them, as rows of texts; pictures; tags."""

    def __init__(self, text):
        super().__init__()
        self.tables, self.images, self.tags, self.texts = {}, [], set(), []
        self.open, self.heading = [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.open.append(tag)
        if tag == "image":
            kind, data = dict(attrs)["href"].split(",")
            assert kind == "data:image/png;base64"
            self.images.append(base64.b64decode(data, validate=True))
        elif tag == "h2":
            self.heading = ""
        elif tag == "tr":
            self.tables.setdefault(self.heading, []).append([])
        elif tag in ("td", "th"):
            self.tables[self.heading][-1].append("")

    def handle_endtag(self, tag):
        while self.open and self.open.pop() != tag:
            pass

    def handle_data(self, data):
        self.texts.append(data)
        if "h2" in self.open:
            self.heading += data
        if "td" in self.open or "th" in self.open:
            self.tables[self.heading][-1][-1] += data


def turn(q, v):
    """v turned by a quaternion, by the matrix."""
    x, y, z, w = q
    rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))
    return [sum(a * b for a, b in zip(row, v)) for row in rows]


def axes(d):
    """Right of a direction of length 1, and above; y is up, and z if it looks along y."""
    length = math.hypot(d[0], d[2])
    right = [-d[2] / length, 0, d[0] / length] if length > 1e-9 else [math.copysign(1, d[1]), 0, 0]
    return right, [right[1] * d[2] - right[2] * d[1], right[2] * d[0] - right[0] * d[2],
                   right[0] * d[1] - right[1] * d[0]]


class Sheet(Case):
    def setUp(self):
        super().setUp()
        self.write("room.obj", room(1))

    def page(self, *words):
        told = self.run_json("view", *words, "--report", "-o", "sheet.html")
        self.assertEqual(told["shown"]["guards"], len(json.loads(self.read(words[0]))["guards"]))
        text = self.read("sheet.html").decode()
        page = Page(text)
        self.assertNotIn("script", page.tags)
        self.assertNotIn("://", text.replace("http://www.w3.org", ""))
        return page

    def plan(self, *more):
        self.write("poses.txt", POSES)
        self.run_text("guard", "room.obj", "--keep", "poses.txt", "--fov", "90,60", "--range", str(RANGE), *more,
                      "--patch", "0.4", "--max-guards", "1", "--count", "30", "-o", "g.json", "--quiet")
        return json.loads(self.read("g.json"))

    def test_picture_shows_obstacles(self):
        """A crate is drawn in a colour that the room has not, also where sheets have two sides."""
        self.write("crate.off", off(box((2, 0.1, 2), (3, 1, 3))))
        brown = []
        for words in [(), ("--obstacles", "crate.off"), ("--obstacles", "crate.off", "--soup", "--two-sided")]:
            self.run_text("guard", "room.obj", "--fov", "90,60", "--see", "floor", *words, "-o", "p.json",
                          "--picture", "p.png", "--effort", "quick", "--count", "40")
            _, _, rows = pixels(self.read("p.png"))
            brown.append(sum(row[i] > row[i + 2] + 12 and row[i + 1] > row[i + 2]
                             for row in rows for i in range(0, len(row), 3)))
        self.assertLess(brown[0], 2000) # guards
        self.assertGreater(min(brown[1:]), 10000, brown)

    def test_lenses(self):
        """Pixels are in colour where a ray from the camera meets what it sees: in its range."""
        self.plan()
        page = self.page("g.json")
        told, grey = 0, 0
        for (width, height, rows), line in zip(map(pixels, page.images[1:]), POSES.splitlines()):
            self.assertAlmostEqual(width / height, math.tan(math.pi / 4) / math.tan(math.pi / 6), delta=0.01)
            p, d = (list(map(float, line.split()))[k:k + 3] for k in (0, 3))
            d = [x / math.hypot(*d) for x in d]
            right, above = axes(d)
            for i in range(1, 24):
                for j in range(1, 24):
                    x, y = (i + 0.4) / 24, (j + 0.4) / 24
                    way = [d[k] + (2 * x - 1) * right[k] + (1 - 2 * y) * math.tan(math.pi / 6) * above[k]
                           for k in range(3)]
                    steps = [((ROOM[6][k] if way[k] > 0 else 0) - p[k]) / way[k] for k in range(3) if way[k]]
                    distance = min(steps) * math.hypot(*way)
                    # patches are seen whole: near a limit it is not told
                    if abs(distance - RANGE) < 0.8 or min(x, y, 1 - x, 1 - y) < 0.2:
                        continue
                    at = 3 * int(x * width)
                    pixel = rows[int(y * height)][at:at + 3]
                    self.assertEqual(max(pixel) - min(pixel) > 18, distance < RANGE, (line, i, j, pixel))
                    told += distance < RANGE
                    grey += distance > RANGE
        self.assertGreater(min(told, grey), 30)

    def test_plan(self):
        """Places of the floor have the colour of the number of cameras that see them."""
        result = self.plan("--see", "floor")
        width, height, rows = pixels(self.page("g.json").images[0])
        scale = (width - 80) / 8
        self.assertAlmostEqual(height, 80 + 6 * scale, delta=1)
        colors = {0: (178, 24, 43), 1: (253, 219, 150), 2: (146, 197, 222), 3: (67, 132, 190)}
        found = set()
        for i in range(40):
            for k in range(30):
                x, z = 0.2 * i + 0.09, 0.2 * k + 0.09
                least = most = 0
                for guard in result["guards"]:
                    sees = [self.sees(guard, (x + a, 0, z + b)) for a in (-0.5, 0, 0.5) for b in (-0.5, 0, 0.5)]
                    least += all(sees)
                    most += any(sees)
                if least != most:
                    continue  # a patch may reach beyond the edge
                at = 3 * int(40 + x * scale)
                pixel = rows[int(40 + z * scale)][at:at + 3]
                near = min(colors, key=lambda c: sum(abs(a - b) for a, b in zip(
                    [v / max(pixel) for v in pixel], [v / max(colors[c]) for v in colors[c]])))
                self.assertEqual(near, min(least, 3), (x, z, pixel))
                found.add(near)
        self.assertGreaterEqual(found, {0, 1, 2})

    def sees(self, guard, p):
        """In the pyramid, which has y up, and in range."""
        line, d = [a - b for a, b in zip(p, guard["position"])], guard["direction"]
        d = [x / math.hypot(*d) for x in d]
        right, above = axes(d)
        ahead, across, up = (sum(a * b for a, b in zip(line, axis)) for axis in (d, right, above))
        return 0 <= p[0] <= 8 and 0 <= p[2] <= 6 and math.hypot(*line) <= RANGE and ahead > 0 and \
            abs(across) <= ahead and abs(up) <= ahead * math.tan(math.pi / 6)

    def test_tables(self):
        """What stands in the sheet is what --table, --summary and --poses say."""
        self.write("poses.txt", "1 1.5 3 1 0 0 0 1 1\n7 1.5 3 1 0 0 0 0 1\n4 2.5 3 0 -1 -1 0 1 0\n4 1 3 0 -1 0 1 0 0\n")
        self.run_text("guard", "room.obj", "--keep", "poses.txt", "--fov", "90,60", "--range", "6", "--resolution",
                      "1920,1080", "--max-guards", "2", "--count", "100", "-o", "g.json", "--poses", "p.csv", "--table", "t.csv",
                      "--summary", "s.csv", "--quiet")
        tables = self.page("g.json").tables
        lines = {name: [row.split(",") for row in self.read(name).decode().splitlines()]
                 for name in ("p.csv", "t.csv", "s.csv")}
        poses = [dict(zip(lines["p.csv"][0], map(float, row))) for row in lines["p.csv"][1:]]
        self.assertEqual(len(tables["Poses"]) - 1, len(poses))
        for told, row in zip(poses, tables["Poses"][1:]):
            self.assertEqual(row[1], "stays" if told["guard"] < 4 else "")
            numbers = [float(x.rstrip("°")) for x in row[2:]]
            names = ("x", "y", "z", "pan", "tilt", "roll", "qx", "qy", "qz", "qw")
            for name, number in zip(names, numbers):
                self.assertAlmostEqual(number, told[name], delta=0.006 + 1e-5 * abs(told[name]))
            # the angles turn the camera as the quaternion does
            q = [told[name] for name in ("qx", "qy", "qz", "qw")]
            pan, tilt, roll = (math.radians(told[name]) for name in ("pan", "tilt", "roll"))
            ahead = [math.cos(tilt) * math.sin(pan), math.sin(tilt), -math.cos(tilt) * math.cos(pan)]
            level = [math.cos(pan), 0, math.sin(pan)]
            above = [-math.sin(tilt) * math.sin(pan), math.cos(tilt), math.sin(tilt) * math.cos(pan)]
            right = [math.cos(roll) * a - math.sin(roll) * b for a, b in zip(level, above)]
            for a, b in zip(turn(q, (0, 0, -1)) + turn(q, (1, 0, 0)), ahead + right):
                self.assertAlmostEqual(a, b, places=6)
        self.assertEqual([round(told["roll"]) for told in poses[:4]], [45, 90, 0, 0])
        self.assertEqual(round(poses[3]["pan"]), 90)
        cameras = [row for row in lines["s.csv"] if row[0] == "camera"]
        for told, row in zip(cameras, tables["What each camera sees"][1:]):
            self.assertAlmostEqual(float(row[2]), float(told[3]), delta=1e-4 * float(told[3]))
            self.assertAlmostEqual(float(row[3].split()[0]), 100 * float(told[4]), delta=0.06)
            self.assertAlmostEqual(float(row[4]), float(told[5]), delta=1e-4 * float(told[5]))
            self.assertAlmostEqual(float(row[5]), float(told[6]), delta=1e-4 * float(told[6]))
        groups = {row[1]: row for row in lines["s.csv"] if row[0] == "group"}
        self.assertEqual({row[0] for row in tables["Groups of faces"][1:]}, set(groups) | {"all"})
        for row in tables["Groups of faces"][1:-1]:
            for shown, told in zip(row[2:], groups[row[0]][7:]):
                self.assertAlmostEqual(float(shown.split()[0]), 100 * float(told), delta=0.1)
        faces = tables["Faces"][1:]
        self.assertEqual([row[4].split(", ") for row in faces], [row[6].split(" ") for row in lines["t.csv"][1:]])

    def test_names_are_text(self):
        self.write("room.obj", room(1).replace("g door", "g <b>&\"x"))
        self.plan()
        page = self.page("g.json")
        self.assertNotIn("b", page.tags)
        self.assertIn("<b>&\"x", [row[0] for row in page.tables["Groups of faces"]])

    def test_all_around(self):
        """Without directions there is a plan and no lens; the command says what was needed."""
        self.run_text("guard", "room.obj", "--require", "door=2", "--require", "0-1=2", "-o", "g.json", "--quiet")
        page = self.page("g.json")
        self.assertEqual(len(page.images), 1)
        self.assertIn("The cameras look all around.", "".join(page.texts))
        command = page.tables["Summary"][-1][1]
        self.assertIn("--require 0-1,4-5=2", command)
        self.run_text(*command.replace("g.json", "again.json").split()[1:])
        self.assertEqual(self.read("again.json"), self.read("g.json"))

    def test_refused(self):
        self.sample("l-room", 500, "m.off")
        self.run_text("decompose", "m.off", "-o", "p.vtk", "--report", "p.json", "--effort", "9")
        for words in (["p.vtk", "p.json"], ["m.off"]):
            self.usage_error("view", *words, "--report", "-o", "x.html", says="one GUARDS.json")

    def test_hall(self):
        """Twelve cameras of a hall; the same bytes at any number of threads."""
        self.write("hall.obj", halls.obj())
        self.write("stay.txt", halls.STAY)
        self.run_text("guard", "hall.obj", "--keep", "stay.txt", "--fov", "90,60", "--max-guards", "10", "--patch", "4",
                      "--effort", "quick", "--count", "40", "-o", "g.json", "--quiet")
        page = self.page("g.json")
        self.assertEqual(len(page.images), 13)
        self.assertTrue(re.fullmatch("12: 2 stay, 10 are new.*", page.tables["Summary"][1][1]))
        first = self.read("sheet.html")
        self.run_text("view", "g.json", "--report", "-o", "sheet.html", "--threads", "1")
        self.assertEqual(first, self.read("sheet.html"))


if __name__ == "__main__":
    main()
