#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cameras that stay, in twenty rooms: of all of a finished plan, and of every second one.

    bench/keep.py [--program PROGRAM]

The rooms of bench/rooms.py, as they are and half as large again. Each is guarded (the plan), then once more
with all cameras of the plan kept, then with every second one. A line for each room: cameras of the plan,
cameras added to all, seconds of that, and cameras of the third in sum. With all kept none may be added, and
with half of them no more than one in sum: else the status is 1."""
import argparse
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

import rooms


def guard(program: str, folder: pathlib.Path, *more: str) -> tuple:
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([program, "guard", folder / "room.obj", *rooms.SENSOR, *more, "-o", folder / "g.json", "--quiet",
                    "--threads", "1"], check=True)
    took = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    return json.loads((folder / "g.json").read_text())["guards"], took


def poses(guards: list) -> str:
    return "".join(" ".join(map(repr, g["position"] + g["direction"] + g["up"])) + "\n" for g in guards)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(rooms.ROOT / "build" / "starguard"))
    program = parser.parse_args().program
    failed = 0
    print("| room | plan | s | added to all | s | with half of it | s |\n|---|--:|--:|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for scale in (1, 1.5):
            for room, (plan, boxes) in rooms.ROOMS.items():
                larger = [(x * scale, y * scale) for x, y in plan]
                spread = [tuple(x * scale if k % 3 < 2 else x for k, x in enumerate(box)) for box in boxes]
                rooms.write(folder / "room.obj", rooms.room(larger, spread))
                full, took = guard(program, folder)
                (folder / "all.txt").write_text(poses(full))
                (folder / "half.txt").write_text(poses(full[::2]))
                again, at_once = guard(program, folder, "--keep", folder / "all.txt")
                half, rest = guard(program, folder, "--keep", folder / "half.txt")
                failed += len(again) > len(full) or len(half) > len(full) + 1
                print(f"| {room}, {scale} | {len(full)} | {took:.1f} | {len(again) - len(full)} | {at_once:.1f} "
                      f"| {len(half)} | {rest:.1f} |", flush=True)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
