#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The instance library of the art gallery problem in 3D (docs/instances.md).

    bench/instances.py list
    bench/instances.py make FOLDER [--program PROGRAM]
    bench/instances.py run [--program PROGRAM] [--work N] [--csv FILE] [NAME...]
    bench/instances.py public FOLDER [--program PROGRAM] [--work N] [--csv FILE]
    bench/instances.py tell [--csv FILE]

list prints the instances with their recipes; make writes them as OFF files and compares their hashes with
those of docs/instances.csv; run searches guards and bounds for each, by points, faces and vertices, and
writes a table, in which a result that FILE has already is kept where it is better; public does the same
for the closed, embedded solids of 20 to 5,000 vertices among a folder's OFF files; tell counts what is
solved. N is the budget of a proof in
tests of a vertex against a box, about a microsecond each."""
import argparse
import csv
import hashlib
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TABLE = ROOT / "docs" / "instances.csv"
TARGETS = {"points": ["--target", "points"], "faces": ["--faces", "whole"], "vertices": ["--target", "vertices"]}
COLUMNS = ["name", "sample", "pose", "size", "sha256", "vertices", "faces"] + [
    f"{target}_{what}" for target in TARGETS for what in ("guards", "bound", "seconds")] + ["work"]


def instances() -> dict:
    """Name to sample, pose and wanted vertices."""
    of_cubes = {f"{kind}-{size}-{member}": (kind, member, size) for kind in ("polycube", "maze", "comb", "spikes")
                for size in (30, 60, 100, 200) for member in range(10)}
    parts = {f"{kind}-500-{member}": (kind, member, 500) for kind in ("bearing", "table", "tool", "vase")
             for member in range(5)}
    animals = {f"{kind}-{size}-{pose}": (kind, pose, size)
               for kind in ("horse", "dog", "cat", "bird", "human", "octopus")
               for size, pose in ((500, 0), (500, 2), (1500, 0))}
    return of_cubes | parts | animals


def make(program: str, recipe: tuple, path: pathlib.Path) -> str:
    """Writes the instance; returns its hash."""
    kind, pose, size = recipe
    subprocess.run([program, "sample", kind, "--pose", str(pose), "--vertices", str(size), "-o", str(path), "--quiet"],
                   check=True)
    return hashlib.sha256(path.read_bytes()).hexdigest()


def guard(program: str, path: pathlib.Path, target: str, work: int) -> tuple:
    """Guards, bound and processor seconds; no guards where the result is not complete."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "guards.json"
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run([program, "guard", str(path), *TARGETS[target], "--prove", "--prove-work", str(work), "-o",
                        str(out), "--threads", "1", "--quiet"], check=True, stderr=subprocess.DEVNULL)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        found = json.loads(out.read_text())
    coverage = found["coverage"]
    complete = coverage["points"]["complete"] if target == "points" else not coverage.get(
        "uncovered_vertices" if target == "vertices" else "uncovered_faces")
    return len(found["guards"]) if complete else None, found.get("lower_bound_everywhere"), seconds


def measure(program: str, path: pathlib.Path, work: int) -> dict:
    said = json.loads(subprocess.run([program, "check", str(path), "--json"], capture_output=True, check=True).stdout)
    row = {"vertices": said["model"]["vertices"], "faces": said["model"]["faces"], "work": work}
    for target in TARGETS:
        guards, bound, seconds = guard(program, path, target, work)
        row |= {f"{target}_guards": guards, f"{target}_bound": bound, f"{target}_seconds": f"{seconds:.1f}"}
    return row


def better(old: dict, new: dict) -> dict:
    """The fewest guards and the highest bound of two runs on the same file."""
    out = dict(new)
    for target in TARGETS:
        for what, choose in (("guards", min), ("bound", max)):
            key = f"{target}_{what}"
            known = [int(row[key]) for row in (old, new) if row.get(key) not in (None, "")]
            out[key] = choose(known) if known else ""
    return out


def follow(row: dict) -> dict:
    """Who sees every face whole sees every point, and who sees every point sees every vertex: so guards
    of one version serve the next, and bounds of that hold for the former."""
    out = dict(row)
    for more, less in (("faces", "points"), ("points", "vertices")):
        known = [int(out[f"{t}_guards"]) for t in (more, less) if str(out[f"{t}_guards"] or "")]
        if str(out[f"{more}_guards"] or ""):
            out[f"{less}_guards"] = min(known)
    for more, less in (("points", "vertices"), ("faces", "points")):
        known = [int(out[f"{t}_bound"]) for t in (more, less) if str(out[f"{t}_bound"] or "")]
        if known:
            out[f"{more}_bound"] = max(known)
    return out


def read(path: pathlib.Path) -> dict:
    if not path.exists():
        return {}
    with path.open(newline="") as file:
        return {row["name"]: row for row in csv.DictReader(file)}


def write(path: pathlib.Path, rows: dict) -> None:
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n", extrasaction="ignore", restval="")
        writer.writeheader()
        writer.writerows(rows.values())


def public(program: str, folder: str) -> list:
    """The usable files of a folder."""
    chosen = []
    for path in sorted(pathlib.Path(folder).glob("*.off")):
        said = subprocess.run([program, "check", str(path), "--json"], capture_output=True, text=True)
        report = json.loads(said.stdout) if said.returncode == 0 else {}
        if report.get("usable") and report.get("embedded") and 20 <= report["model"]["vertices"] <= 5000:
            chosen.append((path.stem, path, None))
    return chosen


def tell(rows: list) -> None:
    """What is solved, by kind."""
    print("| kind | instances | points: solved | gap at most 1 | faces: solved | vertices: solved |")
    print("|---|--:|--:|--:|--:|--:|")
    kinds = list(dict.fromkeys(row["sample"] for row in rows)) + ["all"]
    for kind in kinds:
        chosen = [row for row in rows if kind in (row["sample"], "all")]
        gaps = {target: [int(row[f"{target}_guards"]) - int(row[f"{target}_bound"]) for row in chosen
                         if str(row[f"{target}_guards"]) and str(row[f"{target}_bound"])] for target in TARGETS}
        closed = {target: sum(gap == 0 for gap in gaps[target]) for target in TARGETS}
        print(f"| {kind} | {len(chosen)} | {closed['points']} | {sum(gap <= 1 for gap in gaps['points'])} "
              f"| {closed['faces']} | {closed['vertices']} |")


def run(wanted, chosen: list) -> None:
    """`chosen`: name, path or None, recipe or None."""
    rows = read(wanted.csv)
    with tempfile.TemporaryDirectory() as folder:
        for name, path, recipe in chosen:
            path = path or pathlib.Path(folder) / f"{name}.off"
            digest = make(wanted.program, recipe, path) if recipe else hashlib.sha256(path.read_bytes()).hexdigest()
            kind, pose, size = recipe or (path.parent.name, "", "")
            try:
                row = measure(wanted.program, path, wanted.work)
            except subprocess.CalledProcessError as failure:
                print(f"{name}: {failure}", file=sys.stderr)
                continue
            row |= {"name": name, "sample": kind, "pose": pose, "size": size, "sha256": digest}
            same = rows.get(name, {}).get("sha256") == digest
            rows[name] = follow(better(rows[name], row) if same else row)
            write(wanted.csv, rows)
            print(name, *(f"{target} {row[f'{target}_guards']}/{row[f'{target}_bound']}" for target in TARGETS),
                  flush=True)
    tell([row for name, row in rows.items() if name in {name for name, _, _ in chosen}])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["list", "make", "run", "public", "tell"])
    parser.add_argument("names", nargs="*")
    parser.add_argument("--program", default=str(ROOT / "build" / "starguard"))
    parser.add_argument("--work", type=int, default=2000000)
    parser.add_argument("--csv", type=pathlib.Path)
    wanted = parser.parse_intermixed_args()
    known = instances()
    if wanted.what == "list":
        for name, (kind, pose, size) in known.items():
            print(f"{name:16} starguard sample {kind} --pose {pose} --vertices {size} -o {name}.off")
        return 0
    if wanted.what == "make":
        folder, others, table = pathlib.Path(wanted.names[0]), 0, read(TABLE)
        folder.mkdir(parents=True, exist_ok=True)
        for name, recipe in known.items():
            digest = make(wanted.program, recipe, folder / f"{name}.off")
            if digest != table.get(name, {}).get("sha256"):
                print(f"{name}: another file than in {TABLE.name}", file=sys.stderr)
                others += 1
        print(f"{len(known)} instances, {others} differ from the table")
        return others > 0
    if wanted.what == "tell":
        tell(list(read(wanted.csv or TABLE).values()))
        return 0
    if wanted.what == "public":
        wanted.csv = wanted.csv or pathlib.Path("public.csv")
        run(wanted, public(wanted.program, wanted.names[0]))
        return 0
    wanted.csv = wanted.csv or TABLE
    run(wanted, [(name, None, known[name]) for name in wanted.names or known])
    return 0


if __name__ == "__main__":
    sys.exit(main())
