#!/usr/bin/env python3
"""Guards every surface file of a folder, verifies each result, and prints a line a file.

usage: walk.py STARGUARD FOLDER [--method pilp|ilp|greedy] [--time-limit S] [--only SUBFOLDER]

The exit status is 1 when a file outside nasty/ was not guarded and verified, or a file in nasty/
ended in anything but a verified result or a clear message with status 2 within 30 seconds.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time

ENDINGS = (".off", ".obj", ".ply", ".stl")


def run(command, limit):
    start = time.monotonic()
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=limit)
        return done.returncode, time.monotonic() - start, done.stdout, done.stderr
    except subprocess.TimeoutExpired:
        return "timeout", time.monotonic() - start, "", ""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("starguard")
    parser.add_argument("folder")
    parser.add_argument("--method", default="pilp")
    parser.add_argument("--time-limit", default="60")
    parser.add_argument("--only", default="")
    options = parser.parse_args()
    files = []
    for base, _, names in os.walk(os.path.join(options.folder, options.only)):
        files += [os.path.join(base, n) for n in names if n.lower().endswith(ENDINGS)]
    failed = guarded = refused = 0
    print(f"{'file':42} {'status':>7} {'verify':>6} {'seconds':>8} {'guards':>6} {'bound':>5} "
          f"{'optimal':>7} {'faces':>9} {'area':>9} {'hidden':>6} {'MB':>5}")
    with tempfile.TemporaryDirectory() as folder:
        result = os.path.join(folder, "guards.json")
        for path in sorted(files):
            name = os.path.relpath(path, options.folder)
            nasty = name.startswith("nasty")
            status, seconds, out, err = run(
                [options.starguard, "guard", path, "-o", result, "--json", "--method",
                 options.method, "--time-limit", options.time_limit], 600)
            if status == 0:
                with open(result, encoding="utf-8") as file:
                    found = json.load(file)
                verdict = run([options.starguard, "verify", path, result, "--quiet"], 600)[0]
                told = json.loads(out)
                memory = told["memory"]["peak_resident_bytes"] / 2**20
                cover = found["coverage"]
                print(f"{name:42} {status:>7} {verdict:>6} {seconds:8.2f} "
                      f"{len(found['guards']):6} {found['lower_bound']:5} "
                      f"{'yes' if found['optimal'] else 'no':>7} {cover['faces']:9.6f} "
                      f"{cover['area']:9.6f} {len(cover['uncovered_faces']):6} {memory:5.0f}",
                      flush=True)
                guarded += 1
                failed += verdict != 0 or (nasty and seconds > 30)
            else:
                print(f"{name:42} {status:>7} {'-':>6} {seconds:8.2f} {err.strip()[:90]}",
                      flush=True)
                refused += 1
                failed += not (nasty and status == 2 and seconds < 30)
    print(f"{guarded} guarded, {refused} refused, {failed} failed")
    sys.exit(failed != 0)


if __name__ == "__main__":
    main()
