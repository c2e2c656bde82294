#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Seconds of each stage against model size and number of threads.

usage: scale.py STARGUARD [--commands NAME,...] [--sample NAME] [--sizes N,N,...]
                [--threads N,N,...] [--at N] [--results FILE] [--svg FOLDER] [--processor]

For samples of the given sizes: seconds of each stage of `check`, `guard` (99 % of the area),
`decompose` (without a search) and `search` (`decompose` by its defaults), processor seconds of the
whole command, and of `verify` of the guards, peak memory, and the slope of log seconds over log size
between the largest sizes. Processor seconds depend less on what else the machine does: --processor shows these alone.
Then, at one size, the same for each number of threads.
Tables are Markdown; FOLDER gets a log-log plot for each command. Finished runs are stored in FILE and
not repeated.
"""
import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile

PIECES = ["decompose", "-o", "pieces.vtk", "--report", "pieces.json", "--binary"]
COMMANDS = {
    "check": ["check"],
    "guard": ["guard", "-o", "guards.json", "--coverage", "0.99"],
    "decompose": [*PIECES, "--effort", "1"],
    "search": PIECES,
}
LEAST = 0.01  # seconds below which a stage is not listed
COLOURS = ("#1f6feb", "#d1495b", "#2e9e6b", "#b07d12", "#7b4bb3", "#0f8b8d", "#c2571a", "#66707f",
           "#a03e99", "#5a7d2a", "#8a5a44")


def processor_seconds(words, folder):
    """A finished process, and the processor time that it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def run(options, command, size, threads):
    with tempfile.TemporaryDirectory() as folder:
        model = os.path.join(folder, "model.off")
        subprocess.run([options.starguard, "sample", options.sample, "--vertices", str(size), "-o",
                        model, "--quiet"], check=True)
        done, processor = processor_seconds([options.starguard, *COMMANDS[command], model,
                                             "--threads", str(threads), "--json"], folder)
        told = json.loads(done.stdout)
        if done.returncode != 0:
            sys.exit(f"{command} at {size}: {told['error']['message']}")
        if command == "guard":
            checked, verify = processor_seconds([options.starguard, "verify", model, "guards.json",
                                                 "--threads", str(threads), "--json"], folder)
            if checked.returncode != 0:
                sys.exit(f"verify at {size}: {checked.stdout}")
    told["seconds"]["processor"] = processor
    if command == "guard":
        told["seconds"]["verify, processor"] = verify
    result = {"seconds": told["seconds"],
              "megabytes": told["memory"]["peak_resident_bytes"] / 2**20}
    if command == "guard":
        result["count"] = len(told["guards"])
    if "pieces" in told:
        result["count"] = len(told["pieces"])
        result["tetrahedra"] = told["tetrahedra"]
    return result


class Results:
    """Finished runs by command, size and threads."""

    def __init__(self, options):
        self.options = options
        self.runs = {}
        if options.results and os.path.exists(options.results):
            with open(options.results, encoding="utf-8") as file:
                for line in file:
                    known = json.loads(line)
                    self.runs[tuple(known["key"])] = known

    def get(self, *key):
        if key not in self.runs:
            self.runs[key] = dict(run(self.options, *key), key=list(key))
            if self.options.results:
                with open(self.options.results, "a", encoding="utf-8") as file:
                    file.write(json.dumps(self.runs[key]) + "\n")
        found = self.runs[key]
        if self.options.processor:
            seconds = {n: s for n, s in found["seconds"].items() if n.endswith("processor")}
            found = dict(found, seconds=seconds)
        return found


def stages_of(runs):
    """Stages that take time in the largest run, in order; what is of whole commands last."""
    last = [n for n in ("total", "processor", "verify, processor") if n in runs[-1]["seconds"]]
    names = [n for n in runs[-1]["seconds"] if n not in last and runs[-1]["seconds"][n] >= LEAST]
    return names + last


def slope(sizes, seconds):
    """Over the last factor of ten in size."""
    known = [(math.log(n), math.log(s)) for n, s in zip(sizes, seconds)
             if s >= LEAST and n >= sizes[-1] / 10]
    if len(known) < 2:
        return "-"
    return f"{(known[-1][1] - known[0][1]) / (known[-1][0] - known[0][0]):.2f}"


def cell(seconds):
    return "-" if seconds < LEAST else f"{seconds:.2f}" if seconds < 10 else f"{seconds:.0f}"


def print_table(head, columns, runs, last, sizes=None):
    print("| " + " | ".join([head, *columns, *([last] if last else [])]) + " |")
    print("|---" * (1 + len(columns) + (1 if last else 0)) + "|")
    for stage in stages_of(runs):
        seconds = [r["seconds"].get(stage, 0) for r in runs]
        cells = [stage, *map(cell, seconds)]
        if last == "slope":
            cells.append(slope(sizes, seconds))
        elif last:
            cells.append(f"{seconds[0] / seconds[-1]:.2f}" if seconds[-1] >= LEAST else "-")
        print("| " + " | ".join(cells) + " |")
    megabytes = [f"{r['megabytes']:.0f}" for r in runs]
    print("| " + " | ".join(["MB", *megabytes, *([""] if last else [])]) + " |")
    if "count" in runs[0]:
        what = "pieces" if "tetrahedra" in runs[0] else "guards"
        print("| " + " | ".join([what, *(str(r["count"]) for r in runs),
                                 *([""] if last else [])]) + " |")
    if "tetrahedra" in runs[0]:
        print("| " + " | ".join(["tetrahedra written", *(f"{r['tetrahedra']:,}" for r in runs),
                                 *([""] if last else [])]) + " |")
    print()


def draw(path, title, sizes, runs):
    """Log-log plot: a line for each stage, labelled at its end."""
    width, height, left, right, top, bottom = 860, 520, 60, 190, 46, 44
    low, high = math.log10(LEAST), math.log10(max(max(r["seconds"].values()) for r in runs)) + 0.1
    first, last = math.log10(sizes[0]), math.log10(sizes[-1])

    def at(size, seconds):
        x = left + (math.log10(size) - first) / (last - first) * (width - left - right)
        y = height - bottom - (math.log10(seconds) - low) / (high - low) * (height - top - bottom)
        return x, y

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
           f'font-family="sans-serif" font-size="13">',
           f'<rect width="{width}" height="{height}" fill="white"/>',
           f'<text x="{left}" y="24" font-size="16">{title}</text>']
    for power in range(math.ceil(low), math.floor(high) + 1):
        y = at(sizes[0], 10.0**power)[1]
        out.append(f'<path d="M{left} {y:.1f}H{width - right}" stroke="#ddd"/>'
                   f'<text x="{left - 8}" y="{y + 4:.1f}" text-anchor="end">{10.0**power:g} s</text>')
    for size in sizes:
        x = at(size, 1)[0]
        out.append(f'<path d="M{x:.1f} {top}V{height - bottom}" stroke="#eee"/>'
                   f'<text x="{x:.1f}" y="{height - bottom + 20}" text-anchor="middle">'
                   f'{size:,}</text>')
    ends = []
    for stage, colour in zip(stages_of(runs), COLOURS * 2):
        if stage in ("total", "processor"):
            colour = "#111"
        line = [at(n, r["seconds"][stage]) for n, r in zip(sizes, runs)
                if r["seconds"].get(stage, 0) >= LEAST]
        out.append('<polyline fill="none" stroke-width="%s" stroke="%s" points="%s"/>' % (
            3 if colour == "#111" else 1.8, colour, " ".join(f"{x:.1f},{y:.1f}" for x, y in line)))
        ends.append([line[-1][1], stage, colour])
    ends.sort()
    for i in range(1, len(ends)):  # keep labels apart
        ends[i][0] = max(ends[i][0], ends[i - 1][0] + 15)
    for y, stage, colour in ends:
        out.append(f'<text x="{width - right + 8}" y="{y + 4:.1f}" fill="{colour}">{stage}</text>')
    out.append("</svg>")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(out) + "\n")


def numbers(text):
    return [int(float(word)) for word in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("starguard", type=os.path.abspath)  # commands run in other folders
    parser.add_argument("--commands", type=lambda text: text.split(","), default=list(COMMANDS))
    parser.add_argument("--sample", default="horse")
    parser.add_argument("--sizes", type=numbers, default=numbers("1e3,3e3,1e4,3e4,1e5,3e5,1e6"))
    parser.add_argument("--threads", type=numbers, default=[1, 2])
    parser.add_argument("--at", type=int, default=100000, help="size for the table of threads")
    parser.add_argument("--results")
    parser.add_argument("--svg")
    parser.add_argument("--processor", action="store_true")
    options = parser.parse_args()
    results = Results(options)
    for command in options.commands:
        runs = [results.get(command, size, max(options.threads)) for size in options.sizes]
        print_table(f"`{command}`, s", [f"{n:,}" for n in options.sizes], runs, "slope",
                    options.sizes)
        if options.svg:
            shown = "processor seconds" if options.processor else "seconds of each stage"
            draw(os.path.join(options.svg, f"scale_{command}.svg"),
                 f"starguard {command}: {shown} by vertices", options.sizes, runs)
    for command in options.commands:
        runs = [results.get(command, options.at, count) for count in options.threads]
        print_table(f"`{command}`, {options.at:,} vertices", [f"{n} thread" + "s" * (n > 1) for n in options.threads],
                    runs, "times as fast")


if __name__ == "__main__":
    main()
