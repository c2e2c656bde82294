#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cameras in a procedural office building, taken as a soup: a view of 90 by 60 degrees, a range of 8,
at most 75 degrees from the normal, 95 % of the weighted area that can be seen; ceilings count a
quarter. Prints cameras and their proven bound, processor seconds and memory.

    bench/office.py STARGUARD [--vertices N] [--verify]"""
import argparse
import json
import pathlib
import resource
import subprocess
import tempfile

OPTIONS = ["--soup", "--from", "1,1,6.5", "--cell", "0.25", "--fov", "90,60", "--range", "8",
           "--incidence", "75", "--coverage", "0.95", "--threads", "2"]


def weights(model: pathlib.Path) -> tuple[int, str]:
    """A quarter for faces that look down, else 1."""
    lines = model.read_text().split("\n")
    vertices, faces, _ = map(int, lines[1].split())
    points = [tuple(map(float, line.split())) for line in lines[2:2 + vertices]]
    rows = []
    for line in lines[2 + vertices:2 + vertices + faces]:
        a, b, c = (points[int(word)] for word in line.split()[1:])
        y = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2])
        rows.append("0.25" if y < -1e-12 else "1")
    return faces, "\n".join(rows) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--vertices", default="500000")
    parser.add_argument("--verify", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        model, listed = pathlib.Path(folder, "office.off"), pathlib.Path(folder, "weights.txt")
        result = pathlib.Path(folder, "office.json")
        subprocess.run([arguments.program, "sample", "office", "--vertices", arguments.vertices, "-o",
                        str(model), "--quiet"], check=True)
        faces, text = weights(model)
        listed.write_text(text)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([arguments.program, "guard", str(model), *OPTIONS, "--weights",
                               str(listed), "-o", str(result), "--json", "--quiet"],
                              stdout=subprocess.PIPE, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        told = json.loads(done.stdout)
        print(f"{faces:,} faces: {len(told['guards'])} cameras of {told['candidates']:,} candidates, at "
              f"least {told['lower_bound']} needed; {100 * told['coverage']['area']:.1f} % of the weighted "
              f"area")
        print(f"processor seconds {after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime:.0f}"
              f", memory {told['memory']['peak_resident_bytes'] / 1e9:.2f} GB")
        for stage, taken in told["seconds"].items():
            print(f"  {stage:14} {taken:7.1f} s")
        if arguments.verify:
            subprocess.run([arguments.program, "verify", str(model), str(result)], check=True)


if __name__ == "__main__":
    main()
