#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The art gallery problem itself: guards that see every point, and bounds for every place.

    bench/points.py [--program PROGRAM] [--most VERTICES] [--work N] [--every N] [GROUP...]

A line for each model of folders of ../shared/data (or of the samples, without that folder): vertices,
guards that see every face by its corners, guards that see every point and the bound for these wherever
guards stand (--prove), the share of the area that is not decided, processor seconds of one thread, and
whether an independent check agrees. The last line counts what is closed."""
import argparse
import json
import pathlib
import resource
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT.parent / "shared" / "data"
GROUPS = ["solids", "table2", "retrieval_shrec07"]
SAMPLES = ["horse", "dog", "octopus", "bearing", "table", "l-room", "gallery", "labyrinth", "plate", "eight", "star"]


def run(command: list) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([*map(str, command), "--quiet", "--threads", "1"], stderr=subprocess.PIPE, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip())
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def vertices(program: str, model: pathlib.Path) -> int:
    said = subprocess.run([program, "check", str(model), "--json"], capture_output=True, text=True).stdout
    return json.loads(said)["model"]["vertices"]


def measure(wanted, model: pathlib.Path, folder: pathlib.Path) -> tuple:
    faces, points = folder / "faces.json", folder / "points.json"
    run([wanted.program, "guard", model, "-o", faces])
    took = run([wanted.program, "guard", model, "-o", points, "--target", "points", "--prove",
                "--prove-work", wanted.work])
    found = json.loads(points.read_text())
    checked = subprocess.run([wanted.program, "verify", str(model), str(points), "--quiet"],
                             capture_output=True).returncode == 0 if wanted.verify else None
    return (len(json.loads(faces.read_text())["guards"]), len(found["guards"]),
            found.get("lower_bound_everywhere", 0), found["coverage"]["points"]["open"],
            found["coverage"]["points"]["complete"], took, checked)


def models(wanted, folder: pathlib.Path) -> list:
    if wanted.samples or not DATA.is_dir():
        made = [folder / f"{name}.off" for name in SAMPLES]
        for path in made:
            subprocess.run([wanted.program, "sample", path.stem, "--vertices", "1000", "-o", str(path), "--quiet"],
                           check=True)
        return made
    return [path for group in wanted.groups for path in sorted((DATA / group).glob("*.off"))][::wanted.every]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build" / "starguard"))
    parser.add_argument("--most", type=int, default=3000)
    parser.add_argument("--work", type=int, default=90000000)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--samples", action="store_true")
    parser.add_argument("--verify", action="store_true")
    parser.add_argument("groups", nargs="*", default=GROUPS)
    wanted = parser.parse_args()
    gaps = []
    print("| model | vertices | faces by corners | every point | bound | open | seconds | checked |\n"
          "|---|--:|--:|--:|--:|--:|--:|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for model in models(wanted, folder):
            try:
                size = vertices(wanted.program, model)
                if size > wanted.most:
                    continue
                faces, points, bound, left, complete, took, checked = measure(wanted, model, folder)
            except (RuntimeError, KeyError, ValueError) as error:
                print(f"| {model.stem} | {str(error)[:80]} | | | | | | |", flush=True)
                continue
            gaps.append(points - bound if complete else None)
            said = "" if checked is None else "yes" if checked else "**no**"
            print(f"| {model.stem} | {size} | {faces} | {points} | {bound} | {left:.1g} | {took:.1f} | {said} |",
                  flush=True)
    done = [gap for gap in gaps if gap is not None]
    print(f"\n{len(gaps)} models: {len(done)} seen point by point, {sum(gap == 0 for gap in done)} closed, "
          f"{sum(gap <= 1 for gap in done)} within one guard.")


if __name__ == "__main__":
    main()
