# SPDX-License-Identifier: Apache-2.0
"""A hall as planners have them: floor, walls, doors, ceiling and racks, in metres, as OBJ or GLB."""
import json
import struct

# Lines of the lattice that floor, walls and ceiling are cut along; doors lie between some of them.
XS, YS, ZS = (0, 8, 12, 20, 28, 32, 40), (0, 3, 7), (0, 10, 13, 24)
DOORS = {("z", 0, 1, 0), ("z", 0, 4, 0), ("x", 1, 0, 1)}  # which side, low or high, cells across and up
# Racks in two rows, a lane between them.
RACKS = [(x, 0.1, z, x + 10, 4.5, z + 1.5) for x in (3, 15, 27) for z in (4, 8)] + \
        [(x, 0.1, z, x + 10, 3, z + 1.5) for x in (3, 15, 27) for z in (15, 19)]
LANE = (0.5, -1, 10.2, 39.5, 8, 13.8)
STAY = "1 6.5 1  1 -0.7 0.6\n39 6.5 23  -1 -0.7 -0.6\n"


def quads():
    """Of each group its quads, with their fronts towards the air."""
    out = {name: [] for name in ("floor", "ceiling", "walls", "doors")}
    for i in range(len(XS) - 1):
        for k in range(len(ZS) - 1):
            (a, b), (c, d) = XS[i:i + 2], ZS[k:k + 2]
            out["floor"].append([(a, 0, c), (b, 0, c), (b, 0, d), (a, 0, d)])
            out["ceiling"].append([(a, 7, c), (a, 7, d), (b, 7, d), (b, 7, c)])
    for axis, cells in (("z", XS), ("x", ZS)):
        for high in (0, 1):
            for i in range(len(cells) - 1):
                for j in range(len(YS) - 1):
                    (a, b), (c, d) = cells[i:i + 2], YS[j:j + 2]
                    at = (ZS if axis == "z" else XS)[-1 if high else 0]
                    quad = [(a, c), (b, c), (b, d), (a, d)]
                    quad = [(s, t, at) if axis == "z" else (at, t, s) for s, t in quad]
                    turned = (axis == "z") != bool(high)
                    group = "doors" if (axis, high, i, j) in DOORS else "walls"
                    out[group].append(quad[::-1] if turned else quad)
    for n, (x0, y0, z0, x1, y1, z1) in enumerate(RACKS):
        p = [(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)]
        sides = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
        out[f"rack {n}"] = [[p[c] for c in side] for side in sides]
    return {name: [quad[::-1] for quad in faces] for name, faces in out.items()}


def obj():
    lines, number = [], {}
    for name, faces in quads().items():
        lines.append("g " + name.replace(" ", "_"))
        for quad in faces:
            for p in quad:
                if p not in number:
                    number[p] = len(number) + 1
                    lines.append("v " + " ".join(str(float(x)) for x in p))
            lines.append("f " + " ".join(str(number[p]) for p in quad))
    return "\n".join(lines) + "\n"


def glb():
    """A node for each group, with vertices of its own, as modelling programs write them."""
    blob, nodes, meshes, accessors, views = b"", [], [], [], []
    for name, faces in quads().items():
        points = [p for quad in faces for p in quad]
        corners = [4 * q + c for q in range(len(faces)) for c in (0, 1, 2, 0, 2, 3)]
        for data, count, kind, component in (
                (struct.pack(f"<{3 * len(points)}f", *(x for p in points for x in p)), len(points), "VEC3", 5126),
                (struct.pack(f"<{len(corners)}I", *corners), len(corners), "SCALAR", 5125)):
            views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
            accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": count, "type": kind})
            if kind == "VEC3":
                accessors[-1].update({way: [least(p[k] for p in points) for k in range(3)]
                                      for way, least in (("min", min), ("max", max))})
            blob += data
        meshes.append({"primitives": [{"attributes": {"POSITION": len(accessors) - 2},
                                       "indices": len(accessors) - 1}]})
        nodes.append({"name": name, "mesh": len(meshes) - 1})
    told = json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}],
                       "nodes": nodes, "meshes": meshes, "accessors": accessors, "bufferViews": views,
                       "buffers": [{"byteLength": len(blob)}]}).encode()
    told += b" " * (-len(told) % 4)
    return struct.pack("<4sIIII", b"glTF", 2, 12 + 8 + len(told) + 8 + len(blob), len(told), 0x4E4F534A) + told + \
        struct.pack("<II", len(blob), 0x004E4942) + blob
