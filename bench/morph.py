#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures morphs: a row for each pair and method, and the means at the end.

usage: morph.py STARGUARD [--shared FOLDER] [--frames N] [--samples-only] [--only WORD]
                [--methods star,arap,...]

Pairs are the samples in two poses and, if the shared data is available, poses from it, and different
animals with the landmarks in bench/landmarks; for these the map's time and distortion are first printed
to standard error. Columns: pairs of intersecting faces at both ends (independent of the method), on the
way (summed over the frames between) and at t = 0.5, flipped faces, and the largest and mean drift of
the volume.
"""
import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile

METHODS = ["star", "arap", "linear", "spherical"]
SAMPLES = ["horse", "dog", "cat", "giraffe", "dinosaur", "bird", "human", "octopus"]
POSES = [("tosca_wolf0", "tosca_wolf2"), ("camel_0", "camel_1"), ("cat_reference", "cat_01"),
         ("cat_reference", "cat_05"), ("lion_reference", "lion_01"), ("lion_reference", "lion_05")]
ANIMALS = [("cat0", "dog0"), ("cat0", "wolf0"), ("wolf0", "dog0"), ("wolf0", "horse0"),
           ("david0", "michael0"), ("victoria0", "david0"), ("horse0", "centaur0")]
LANDMARKS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "landmarks")


def run(program, *words):
    done = subprocess.run([program, *words, "--json"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}: {done.stderr.strip() or done.stdout.strip()}")
    return json.loads(done.stdout)


def seconds(program, *words):
    """Processor time of the child alone."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    report = run(program, *words)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return report, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def make_map(arguments, folder, a, b):
    """Maps one animal to another, prints statistics, and returns the map's file."""
    models = os.path.join(arguments.shared, "data", "tosca_paper")
    files = [os.path.join(models, f + ".off") for f in (a, b)]
    out = os.path.join(folder, f"{a}_{b}.json")
    report, took = seconds(arguments.starguard, "map", *files, "--landmarks",
                           os.path.join(LANDMARKS, f"{a}_{b}.txt"), "-o", out)
    print(f"map {a} {b}: {report['landmarks']} landmarks, angles "
          f"{report['mean_angle_distortion']:.2f}, areas {report['mean_area_distortion']:.2f}, "
          f"{took:.1f} s", file=sys.stderr, flush=True)
    return *files, "--map", out


def pairs(arguments, folder):
    """Names, and their command-line arguments."""
    for name in SAMPLES:
        files = [os.path.join(folder, f"{name}_{pose}.off") for pose in (0, 1)]
        for pose, file in enumerate(files):
            run(arguments.starguard, "sample", name, "--pose", str(pose), "-o", file)
        yield name, files
    poses = os.path.join(arguments.shared, "data", "poses")
    if not arguments.samples_only and os.path.isdir(poses):
        for a, b in POSES:
            yield f"{a} {b}", [os.path.join(poses, f + ".off") for f in (a, b)]
        for a, b in ANIMALS:
            if arguments.only in f"{a} {b}":
                yield f"{a} {b}", make_map(arguments, folder, a, b)


def measure(arguments, folder, words, method):
    report = run(arguments.starguard, "morph", *words, "--frames", str(arguments.frames),
                 "--method", method, "-o", os.path.join(folder, "frames"))
    between = report["frames"][1:-1]
    drifts = [abs(f["volume_drift"]) for f in between]
    return {"guards": len(report["guards"]),
            "intersections": sum(f["intersections"] for f in between),
            "half": between[len(between) // 2]["intersections"],
            "ends": [report["frames"][i]["intersections"] for i in (0, -1)],
            "flipped": sum(f["inverted"] for f in between),
            "drift": max(drifts), "mean": sum(drifts) / len(drifts)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("starguard")
    parser.add_argument("--shared", default="../shared")
    parser.add_argument("--frames", type=int, default=11)
    parser.add_argument("--samples-only", action="store_true")
    parser.add_argument("--methods", default=",".join(METHODS))
    parser.add_argument("--only", default="", help="pairs whose names hold this word")
    arguments = parser.parse_args()
    if arguments.frames < 3 or arguments.frames % 2 == 0:
        parser.error("--frames must be odd and 3 or more, so that t = 0.5 is one of them")
    methods = arguments.methods.split(",")
    rows = []
    print("| pair | method | guards | ends | intersections | at t = 0.5 | flipped | volume drift | "
          "mean |")
    print("|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name, words in pairs(arguments, folder):
            if arguments.only not in name:
                continue
            for method in methods:
                row = measure(arguments, folder, words, method)
                rows.append((method, row))
                print(f"| {name} | {method} | {row['guards'] or ''} | {row['ends'][0]}, "
                      f"{row['ends'][1]} | {row['intersections']} | {row['half']} | "
                      f"{row['flipped']} | {100 * row['drift']:.2f} % | {100 * row['mean']:.2f} % |",
                      flush=True)
    for method in methods:
        own = [row for m, row in rows if m == method]
        means = {key: sum(row[key] for row in own) / len(own) for key in own[0] if key != "ends"}
        print(f"| mean | {method} |  |  | {means['intersections']:.1f} | {means['half']:.1f} | "
              f"{means['flipped']:.1f} | {100 * means['drift']:.2f} % | {100 * means['mean']:.2f} % |")


if __name__ == "__main__":
    main()
