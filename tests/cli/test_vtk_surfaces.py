# SPDX-License-Identifier: Apache-2.0
"""Surfaces in VTK files, legacy and XML, as ParaView, PyVista and meshio write them: the same solid in every form."""
import base64
import itertools
import random
import struct
import unittest
import zlib

from support import Case, main

try:
    import vtk
except ImportError:
    vtk = None

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


def field(binary):
    """What belongs to the file as a whole, as ParaView writes it."""
    return (b"FIELD FieldData 2\nTIME 1 1 double\n" + numbers([0.5], "d", binary) + b"METADATA\nINFORMATION 0\n\n"
            + b"CYCLE 2 3 int\n" + numbers(range(6), "i", binary))


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
    out = head("POLYDATA", binary, "5.1" if offsets else "3.0") + (field(binary) if strips else b"") + points(binary)
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
    out = head("UNSTRUCTURED_GRID", binary, "5.1" if offsets else "3.0") + field(binary) + points(binary)
    return out + cells("CELLS", lists, binary, offsets) + f"CELL_TYPES {len(lists)}\n".encode() + numbers(
        [1] + [9] * len(QUADS), "i", binary)


class XmlFile:
    """A .vtp file by hand: storage ascii, binary, raw or base64 (the last two appended)."""

    def __init__(self, storage="ascii", compressed=False, order="<", header="I", reals="d", ints="q", block=64):
        self.storage, self.compressed, self.order, self.header = storage, compressed, order, header
        self.reals, self.ints, self.block = reals, ints, block
        self.appended, self.pieces = b"", b""

    def stored(self, data):
        """Bytes as they stand in the file, with their header."""
        head = struct.Struct(self.order + self.header)
        if not self.compressed:
            parts = [head.pack(len(data)) + data]
        else:
            blocks = [data[i:i + self.block] for i in range(0, len(data), self.block)]
            packed = [zlib.compress(b) for b in blocks]
            numbers_ = [len(blocks), self.block, len(data) % self.block, *map(len, packed)]
            parts = [b"".join(map(head.pack, numbers_ if blocks else [0])), b"".join(packed)]
        return b"".join(parts if self.storage == "raw" else map(base64.b64encode, parts))

    def array(self, name, kind, values, more=""):
        kinds = {"d": "Float64", "f": "Float32", "q": "Int64", "i": "Int32", "I": "UInt32", "h": "Int16", "B": "UInt8",
                 "s": "String"}
        tag = f'<DataArray type="{kinds[kind]}" Name="{name}" {more}'
        if self.storage == "ascii":
            return f'{tag} format="ascii">\n{" ".join(map(str, values))}\n</DataArray>\n'.encode()
        data = struct.pack(f"{self.order}{len(values)}{'B' if kind == 's' else kind}", *values)
        if self.storage == "binary":
            return f'{tag} format="binary">\n  '.encode() + self.stored(data) + b"\n</DataArray>\n"
        offset = len(self.appended)
        self.appended += self.stored(data)
        return f'{tag} format="appended" offset="{offset}"/>\n'.encode()

    def cells(self, section, lists):
        ends = list(itertools.accumulate(map(len, lists)))
        return (f"<{section}>\n".encode() + self.array("connectivity", self.ints, [n for c in lists for n in c])
                + self.array("offsets", self.ints, ends) + f"</{section}>\n".encode())

    def piece(self, corners, polys=(), strips=(), lines=(), data=()):
        """`data`: names with a kind and a value for each cell, in the order lines, polygons, strips."""
        text = (f'<Piece NumberOfPoints="{len(corners)}" NumberOfVerts="0" NumberOfLines="{len(lines)}" '
                f'NumberOfStrips="{len(strips)}" NumberOfPolys="{len(polys)}">\n<CellData>\n').encode()
        for name, kind, values in data:
            text += self.array(name, kind, values)
        text += b"</CellData>\n<Points>\n" + self.array("Points", self.reals, [c for p in corners for c in p],
                                                       'NumberOfComponents="3"') + b"</Points>\n"
        text += self.cells("Lines", lines) + self.cells("Strips", strips) + self.cells("Polys", polys)
        self.pieces += text + b"</Piece>\n"
        return self

    def text(self):
        word = {"I": "UInt32", "Q": "UInt64"}[self.header]
        order = {"<": "LittleEndian", ">": "BigEndian"}[self.order]
        compressor = 'compressor="vtkZLibDataCompressor"' if self.compressed else ""
        out = (f'<?xml version="1.0"?>\n<!-- a box <with> tags -->\n<VTKFile type="PolyData" version="1.0" '
               f'byte_order="{order}" header_type="{word}" {compressor}>\n<PolyData>\n').encode()
        out += self.pieces + b"</PolyData>\n"
        if self.appended:
            encoding = "raw" if self.storage == "raw" else "base64"
            out += f'<AppendedData encoding="{encoding}">\n _'.encode() + self.appended + b"\n</AppendedData>\n"
        return out + b"</VTKFile>\n"


# a prism over an L: two faces have six corners and a reflex one
ELL = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (0, 2)]
ELL_POINTS = [(x, y, z) for z in (0, 2) for x, y in ELL]
ELL_FACES = [(3, 2, 1, 0, 5, 4), (9, 10, 11, 6, 7, 8)] + [(i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6) for i in range(6)]


def characters(*names):
    return [c for name in names for c in name.encode() + b"\0"]


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
        for name in ("quads.vtk", "strips.vtk"):
            self.run_text("view", name, "-o", "v.html")
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

    # ---- XML ----

    def test_xml_storage(self):
        """All ways to store arrays, in all sizes of numbers."""
        ways = itertools.product(("ascii", "binary", "raw", "base64"), (False, True), "<>", "IQ", ("dq", "fi", "fI"))
        for storage, compressed, order, header, (reals, ints) in ways:
            file = XmlFile(storage, compressed, order, header, reals, ints)
            self.write("a.vtp", file.piece(ELL_POINTS, ELL_FACES, lines=[(0, 1, 2), (3, 4)]).text())
            result = self.run_json("check", "a.vtp")
            self.assertAlmostEqual(result["volume"], 8, 9, (storage, compressed, order, header, reals, ints))
            self.assertEqual((result["model"]["vertices"], result["model"]["faces"]), (12, 20))

    def test_xml_strips_and_pieces(self):
        """Two boxes in two pieces, one of a strip and polygons, and a piece of nothing."""
        moved = [(x + 5, y, z) for x, y, z in POINTS]
        for storage in ("ascii", "raw"):
            file = XmlFile(storage).piece(POINTS, REST, [STRIP]).piece([]).piece(moved, QUADS)
            self.write("noname", file.text())
            result = self.run_json("check", "noname")
            self.assertAlmostEqual(result["volume"], 4, 9)
            self.assertEqual((result["model"]["vertices"], result["model"]["faces"]), (16, 24))
        self.run_text("guard", "noname", "-o", "g.json")
        self.run_text("verify", "noname", "g.json")
        self.run_text("view", "noname", "-o", "v.html")

    def test_xml_names(self):
        """Numbers and names of cells are words for --see; cells are lines, then polygons, then strips."""
        names = characters("wire", "floor", "the roof", "walls")
        for storage, compressed in (("ascii", False), ("binary", True), ("raw", False)):
            file = XmlFile(storage, compressed)
            self.write("a.vtp", file.piece(POINTS, REST, [STRIP], [(0, 1)], [
                ("room", "h", (9, 1, 2, 3)), ("part", "s", names), ("flag", "B", (1, 0, 255, 0))]).text())
            for word, area in (("floor", 1), ("the roof", 1), ("walls", 8), ("room=3", 8), ("flag=255", 1), ("room", 10)):
                self.run_text("guard", "a.vtp", "--see", word, "-o", "g.json", "--table", "t.csv")
                areas = [float(line.split(",")[2]) for line in self.read("t.csv").decode().splitlines()[1:]]
                self.assertAlmostEqual(sum(areas), area, 9, word)
            said = self.run_text("guard", "a.vtp", "--see", "cellar", "-o", "g.json", status=1)[1]
            for word in ("room", "flag", "floor", "the roof", "walls"):
                self.assertIn(word, said)

    @unittest.skipUnless(vtk, "python3-vtk9 is not installed: VTK writes no file")
    def test_xml_by_vtk(self):
        poly = vtk.vtkPolyData()
        corners = vtk.vtkPoints()
        corners.SetDataTypeToDouble()
        for p in ELL_POINTS:
            corners.InsertNextPoint(p)
        poly.SetPoints(corners)
        faces = vtk.vtkCellArray()
        for cell in ELL_FACES:
            faces.InsertNextCell(len(cell), cell)
        poly.SetPolys(faces)
        part = vtk.vtkStringArray()
        part.SetName("part")
        for i in range(8):
            part.InsertNextValue("floor" if i == 0 else "other")
        poly.GetCellData().AddArray(part)
        writer = vtk.vtkXMLPolyDataWriter()
        writer.SetInputData(poly)
        writer.SetFileName(self.path("a.vtp"))
        writer.SetBlockSize(128)
        for mode, packing, encode, header, order in itertools.product(
                ("Ascii", "Binary", "Appended"), ("None", "ZLib"), (0, 1), (32, 64), (0, 1)):
            getattr(writer, "SetDataModeTo" + mode)()
            getattr(writer, "SetCompressorTypeTo" + packing)()
            writer.SetEncodeAppendedData(encode)
            writer.SetHeaderType(header)
            writer.SetByteOrder(order)
            self.assertEqual(writer.Write(), 1)
            self.assertAlmostEqual(self.run_json("check", "a.vtp")["volume"], 8, 9, (mode, packing, encode, header, order))
            self.run_text("guard", "a.vtp", "--see", "floor", "-o", "g.json", "--quiet")
        for packing in ("LZ4", "LZMA"):
            getattr(writer, "SetCompressorTypeTo" + packing)()
            writer.Write()
            self.assertIn(f"compressed by vtk{packing}", self.run_text("check", "a.vtp", status=2)[1])

    def test_xml_written(self):
        """Marks and meshes written as .vtp: read by this reader, and by VTK where there is one."""
        self.write("a.vtp", XmlFile().piece(ELL_POINTS, ELL_FACES).text())
        self.run_text("repair", "a.vtp", "-o", "b.vtp")
        self.run_text("repair", "b.vtp", "-o", "b.off")
        self.run_text("repair", "a.vtp", "-o", "a.off")
        self.assertEqual(self.read("a.off"), self.read("b.off"))
        open_ = [f for f in ELL_FACES if f != (3, 2, 1, 0, 5, 4)]
        self.write("open.vtp", XmlFile().piece(ELL_POINTS, open_).text())
        self.run_text("check", "open.vtp", "--marks", "m.vtp", status=2)
        self.run_text("visible", "a.vtp", "--from", "2.5,0.5,1", "--from", "0.5,1.5,1", "-o", "s.vtp")
        self.run_text("guard", "a.vtp", "-o", "g.json", "--marks", "g.vtp")
        points = self.run_json("visible", "a.vtp", "--from", "2.5,0.5,1", "--from", "0.5,1.5,1")["points"]
        first = [0 if f in points[0]["faces"] else 1 if f in points[1]["faces"] else -1 for f in range(20)]
        self.assertEqual(set(first), {0, 1})
        for name in ("m.vtp", "s.vtp", "g.vtp"):
            self.assertIn(b'Name="color"', self.read(name))
        for word, wanted in (("mark=0", first.count(0)), ("mark=1", first.count(1))):
            self.run_text("guard", "s.vtp", "--see", word, "-o", "g.json", "--table", "t.csv")
            self.assertEqual(len(self.read("t.csv").splitlines()), wanted + 1)
        if vtk is None:
            return
        reader = vtk.vtkXMLPolyDataReader()
        reader.SetFileName(self.path("s.vtp"))
        reader.Update()
        marks = reader.GetOutput().GetCellData().GetArray("mark")
        self.assertEqual([marks.GetValue(i) for i in range(20)], first)
        sizes = vtk.vtkMassProperties()
        sizes.SetInputConnection(reader.GetOutputPort())
        self.assertAlmostEqual(sizes.GetVolume(), 8, 9)
        reader.SetFileName(self.path("m.vtp"))
        reader.Update()
        marks = reader.GetOutput().GetCellData().GetArray("mark")
        self.assertEqual({marks.GetValue(i) for i in range(16)}, {-1, 0})

    def test_xml_refused(self):
        """What is no surface, or does not fit together, is said with the line."""
        good = XmlFile().piece(ELL_POINTS, ELL_FACES).text().decode()
        raw = XmlFile("raw", True).piece(ELL_POINTS, ELL_FACES).text()
        for old, new, says in (
                ('"PolyData"', '"UnstructuredGrid"', "UnstructuredGrid"), ('"PolyData"', '"PPolyData"', "in one file"),
                ('NumberOfPolys="8"', 'NumberOfPolys="9"', "has 8 numbers, but its piece needs 9"),
                ('NumberOfPoints="12"', 'NumberOfPoints="11"', "has 36 numbers, but its piece needs 33"),
                ('NumberOfPoints="12"', 'NumberOfPoints="1e9"', "a count that a file can hold"),
                ("6 12 16", "6 12 11", "do not end one after another"), ("3 2 1 0 5 4", "3 2 1 0 5 12", "point 12"),
                ("3 2 1 0 5 4", "3 2 1 0 5 -1", "point -1"), ('"offsets"', '"onsets"', "no array offsets"),
                ("</Points>", "</Point>", "did not begin"), ("</VTKFile>", "", "within an element"),
                ("LittleEndian", "MiddleEndian", "MiddleEndian"), ("UInt32", "UInt16", "UInt16"),
                ("Float64", "Bit", "Bit"), ('format="ascii"', 'format="lzip"', "lzip"),
                ("0 0 0 3 0 0", "0 0 zero 3 0 0", "zero"), ("0 0 0 3 0 0", "0 0 nan 3 0 0", "finite")):
            self.assertIn(old, good)
            self.write("a.vtp", good.replace(old, new))
            said = self.run_text("check", "a.vtp", status=2)[1]
            self.assertIn(says, said, (old, new))
            self.assertIn("line", said)
        start = raw.index(b" _") + 2
        for at, bytes_ in ((start, b"\xff\xff\xff\x7f"), (start + 4, b"\xff\xff\xff\x7f"), (start + 16, b"\0")):
            self.write("a.vtp", raw[:at] + bytes_ + raw[at + len(bytes_):])
            self.assertIn("array", self.run_text("check", "a.vtp", status=2)[1])
        for offset in (b"99999999", b"-8", b"9223372036854775807", str(len(raw) - start).encode()):
            self.write("a.vtp", raw.replace(b'offset="0"', b'offset="' + offset + b'"'))
            self.assertIn("array", self.run_text("check", "a.vtp", status=2)[1])

    def test_xml_bomb(self):
        """A block that swells a thousandfold takes no memory before its size is compared."""
        file = XmlFile("raw", True, block=1 << 30)
        file.stored = lambda data: struct.pack("<4I", 1, 1 << 30, 0, 9) + b"123456789"
        self.write("a.vtp", file.piece(ELL_POINTS, ELL_FACES).text())
        self.assertIn("impossible sizes", self.run_text("check", "a.vtp", status=2)[1])

    def test_xml_damaged(self):
        dice = random.Random(4)
        texts = [XmlFile(storage, compressed).piece(POINTS, REST, [STRIP], [(0, 1)], [("part", "s", characters(*"abcd"))])
                 .text() for storage in ("ascii", "binary", "raw", "base64") for compressed in (False, True)]
        for text in texts:
            for _ in range(25):
                bytes_ = bytearray(text)
                for _ in range(dice.randrange(0, 5)):
                    bytes_[dice.randrange(len(bytes_))] = dice.randrange(256)
                cut = dice.choice((len(bytes_), dice.randrange(1, len(bytes_))))
                self.write("m.vtp", bytes(bytes_[:cut]))
                with self.start("guard", "m.vtp", "--see", "a", "-o", "g.json") as process:
                    _, errors = process.communicate()
                self.assertIn(process.returncode, (0, 1, 2), errors)


if __name__ == "__main__":
    main()
