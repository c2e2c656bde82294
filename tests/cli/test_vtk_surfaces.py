# SPDX-License-Identifier: Apache-2.0
"""Surfaces in legacy VTK files, as ParaView, PyVista and meshio write them: the same solid as the OFF file."""
import random
import struct

from support import Case, main

POINTS = [(x, y, z) for z in (0, 2) for y in (0, 1) for x in (0, 1)]
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
# the six sides: a strip for four of them, polygons for the others
STRIP, REST = (4, 0, 5, 1, 7, 3, 6, 2, 4, 0), [(0, 2, 3, 1), (4, 5, 7, 6)]


def numbers(values, kind, binary):
    if not binary:
        return (" ".join(str(v) for v in values) + "\n").encode()
    return struct.pack(f">{len(values)}{kind}", *values) + b"\n"


def head(dataset, binary, version):
    return f"# vtk DataFile Version {version}\na box\n{'BINARY' if binary else 'ASCII'}\nDATASET {dataset}\n".encode()


def points(binary):
    flat = [c for p in POINTS for c in p]
    return f"POINTS {len(POINTS)} double\n".encode() + numbers([float(c) for c in flat], "d", binary)


def cells(keyword, lists, binary, offsets):
    if not offsets:
        flat = [n for cell in lists for n in (len(cell), *cell)]
        return f"{keyword} {len(lists)} {len(flat)}\n".encode() + numbers(flat, "i", binary)
    starts, flat = [0], [n for cell in lists for n in cell]
    for cell in lists:
        starts.append(starts[-1] + len(cell))
    return (f"{keyword} {len(starts)} {len(flat)}\nOFFSETS vtktypeint64\n".encode() + numbers(starts, "q", binary)
            + b"CONNECTIVITY vtktypeint64\n" + numbers(flat, "q", binary))


def polydata(binary, offsets, strips):
    out = head("POLYDATA", binary, "5.1" if offsets else "3.0") + points(binary)
    if offsets:
        out += b"METADATA\nINFORMATION 0\n\n"
    out += cells("LINES", [(0, 1)], binary, offsets)
    if strips:
        out += cells("POLYGONS", REST, binary, offsets) + cells("TRIANGLE_STRIPS", [STRIP], binary, offsets)
    else:
        out += cells("POLYGONS", QUADS, binary, offsets)
    return out + b"CELL_DATA 6\nSCALARS room int 1\nLOOKUP_TABLE default\n" + numbers(range(6), "i", binary)


def grid(binary, offsets):
    lists = [(0,)] + QUADS
    out = head("UNSTRUCTURED_GRID", binary, "5.1" if offsets else "3.0") + points(binary)
    return out + cells("CELLS", lists, binary, offsets) + f"CELL_TYPES {len(lists)}\n".encode() + numbers(
        [1] + [9] * len(QUADS), "i", binary)


class Surfaces(Case):
    def volume(self, name):
        return self.run_json("check", name)["volume"]

    def test_kinds(self):
        for binary in (False, True):
            for offsets in (False, True):
                for name, text in {"quads": polydata(binary, offsets, False), "strips": polydata(binary, offsets, True),
                                   "grid": grid(binary, offsets)}.items():
                    self.write(f"{name}.vtk", text)
                    self.assertAlmostEqual(self.volume(f"{name}.vtk"), 2, 9, (name, binary, offsets))
        self.run_text("guard", "strips.vtk", "-o", "g.json")
        self.run_text("decompose", "strips.vtk", "-o", "p.vtk")
        self.run_text("check", "p.vtk", status=2)  # tetrahedra are no surface

    def test_damaged(self):
        dice = random.Random(3)
        for text in (polydata(False, True, True), polydata(True, True, True), polydata(True, False, False),
                     grid(True, False)):
            for _ in range(25):
                bytes_ = bytearray(text)
                for _ in range(dice.randrange(1, 4)):
                    bytes_[dice.randrange(len(bytes_))] = dice.randrange(256)
                self.write("m.vtk", bytes(bytes_[:dice.randrange(len(bytes_) // 2, len(bytes_) + 1)]))
                with self.start("check", "m.vtk") as process:
                    _, errors = process.communicate()
                self.assertIn(process.returncode, (0, 2), errors)


if __name__ == "__main__":
    main()
