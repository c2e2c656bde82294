#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Strict pieces of all models of some folders, by one or two programs at the same effort: one table.

usage: pieces.py STARGUARD DATA [--than OTHER] [--groups cad,solids,table2] [--effort N]
       pieces.py STARGUARD DATA --quality [--prove] [--models solids/spot,...] [--effort N]
       pieces.py STARGUARD DATA --every [--results FILE] [--groups solids,...] [--effort N] [--more WORDS]
       pieces.py STARGUARD DATA --early SECONDS [--groups solids,...]

A row for each model where the programs differ, the surface is not kept, or `verify` fails; then the
sums: pieces, surfaces kept, seconds of processor time. OTHER is another build of the program.

With --quality a row for each model: pieces, with --prove the lower bound for all partitions and
whether it is met, the smallest dihedral angle that the model does not force and the median, the
smallest margin, the share of pieces whose margin is at least a thousandth, and seconds.

With --every a row for each file of each folder: vertices; whether `check` calls the surface embedded
and whether it is kept, or why not; pieces, lower bound, smallest angle and margin, seconds of processor
time and megabytes, and the verdict of `verify`. Rows are stored in FILE and not computed again. The
status is 1 if an embedded surface is not kept, a result is not verified, or a command ends in a way
that docs/cli.md does not know.

With --early a row for each model: pieces with that time limit, one thread, by the defaults, and their
ratio; it says something on quiet cores only. The tables are Markdown.
"""
import argparse
import glob
import json
import os
import resource
import subprocess
import tempfile


def spent():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def cut(program, verifier, model, effort):
    with tempfile.TemporaryDirectory() as folder:
        grid, report = os.path.join(folder, "p.vtk"), os.path.join(folder, "p.json")
        before = spent()
        done = subprocess.run([program, "decompose", model, "-o", grid, "--report", report, "--quiet",
                               "--effort", str(effort), "--seed", "1"], capture_output=True,
                              check=False)
        seconds = spent() - before
        if done.returncode:
            return {"pieces": 0, "kept": False, "seconds": seconds, "verified": False}
        verdict = subprocess.run([verifier, "verify", model, grid, report, "--quiet"],
                                 capture_output=True, check=False)
        with open(report, encoding="utf-8") as file:
            told = json.load(file)
    return {"pieces": len(told["pieces"]), "kept": told["surface"] == "kept", "seconds": seconds,
            "verified": verdict.returncode == 0}


def cells(run):
    return (f"{run['pieces'] or 'failed'} | {'kept' if run['kept'] else 'approximated'} | "
            f"{run['seconds']:.1f} | {'yes' if run['verified'] else 'NO'}")


def report_of(program, model, words):
    """What the report says, seconds of processor time, and whether all of it is verified."""
    with tempfile.TemporaryDirectory() as folder:
        grid, report, why = (os.path.join(folder, name) for name in ("p.vtk", "p.json", "c.txt"))
        proof = ["--certificate", why] if "--prove" in words else []
        before = spent()
        subprocess.run([program, "decompose", model, "-o", grid, "--report", report, "--quiet",
                        "--threads", "1", *words, *proof], check=True)
        seconds = spent() - before
        files = [grid, report] + ([why] if proof else [])
        verdict = subprocess.run([program, "verify", model, *files, "--quiet"], check=False)
        with open(report, encoding="utf-8") as file:
            return json.load(file), seconds, verdict.returncode == 0


def tell_quality(program, models, data, words):
    proof = "--prove" in words
    names = ["model", "pieces"] + ["lower bound", "optimal"] * proof + [
        "smallest angle", "of all", "median", "smallest margin", "margins >= 0.001", "seconds",
        "verified"]
    print("| " + " | ".join(names) + " |")
    print("|---" * len(names) + "|")
    for model in models:
        told, seconds, verified = report_of(program, model, words)
        margins = [piece["margin"] for piece in told["pieces"]]
        wide = sum(margin >= 1e-3 for margin in margins)
        row = [os.path.splitext(os.path.relpath(model, data))[0], str(len(margins))]
        if proof:
            row += [str(told["lower_bound"]), "yes" if told["optimal"] else "no"]
        row += [f"{told.get('smallest_angle_made', 0):.2g}", f"{told['smallest_angle']:.2g}",
                f"{told['median_angle']:.0f}", f"{min(margins):.1e}", f"{wide} of {len(margins)}",
                f"{seconds:.1f}", "yes" if verified else "NO"]
        print("| " + " | ".join(row) + " |", flush=True)


# ---- every file ----

SURFACES, SOLIDS = (".off", ".obj", ".ply", ".stl"), (".mesh", ".vtk", ".msh", ".node")
COLUMNS = ("model", "vertices", "embedded", "surface", "pieces", "lower bound", "smallest angle",
           "median", "smallest margin", "margins >= 0.001", "seconds", "MB", "verified")


def told_by(words):
    """Status, the --json report or what stands there instead, seconds of processor time."""
    before = spent()
    done = subprocess.run([*words, "--quiet", "--json"], capture_output=True, check=False, text=True)
    try:
        told = json.loads(done.stdout)
    except ValueError:
        told = {"error": {"message": done.stderr.strip()[-200:]}}
    return done.returncode, told, spent() - before


def embedding_of(program, model):
    """Whether faces meet in common edges and vertices only, and else what is wrong."""
    if model.lower().endswith(SOLIDS):
        return "tetrahedra"
    status, told, _ = told_by([program, "check", model])
    if "findings" not in told:
        return f"status {status}"
    if told["usable"] and told["embedded"]:
        return "yes"
    wrong = [f"{kind.replace('_', ' ')}: {found['count']:,}" for kind, found in told["findings"].items()
             if found.get("count", 0)]
    return "; ".join(wrong) or "no"


def surface_of(told):
    if told["surface"] == "kept" or "faces_kept" not in told:
        return told["surface"] if told["surface"] == "kept" else "filled"
    return f"union, {told['faces_kept']:,} faces kept"


def proof_for(embedding, words):
    """Bounds are for embedded surfaces only."""
    return [word for word in words if embedding == "yes" or not word.startswith("--prove")]


def row_of(program, model, words):
    embedding = embedding_of(program, model)
    row = {"embedded": embedding}
    with tempfile.TemporaryDirectory() as folder:
        grid, report, why = (os.path.join(folder, name) for name in ("p.vtk", "p.json", "c.txt"))
        words = proof_for(embedding, words)
        proof = ["--certificate", why] if "--prove" in words else []
        status, told, seconds = told_by([program, "decompose", model, "-o", grid, "--report", report,
                                         *words, *proof])
        row |= {"status": status, "seconds": round(seconds, 2)}
        if status:
            return row | {"surface": f"status {status}: {told['error']['message']}"}
        with open(report, encoding="utf-8") as file:
            pieces = [piece["margin"] for piece in json.load(file)["pieces"]]
        files = [grid, report] + ([why] if proof else [])
        verdict, _, _ = told_by([program, "verify", model, *files])
    return row | {"vertices": told["model"].get("vertices", 0), "surface": surface_of(told),
                  "pieces": len(pieces), "bound": told.get("lower_bound"),
                  "angle": told.get("smallest_angle_made"), "median": told["median_angle"],
                  "margin": min(pieces), "wide": sum(margin >= 1e-3 for margin in pieces),
                  "megabytes": told["memory"]["peak_resident_bytes"] / 2**20,
                  "verified": verdict == 0}


def tell_row(name, row):
    if row["status"]:
        told = [name, "-", row["embedded"], row["surface"].replace("|", "/")] + ["-"] * 9
    else:
        told = [name, f"{row['vertices']:,}", row["embedded"], row["surface"], str(row["pieces"]),
                "-" if row["bound"] is None else str(row["bound"]),
                "-" if row["angle"] is None else f"{row['angle']:.2g}", f"{row['median']:.0f}",
                f"{row['margin']:.1e}", f"{row['wide']} of {row['pieces']}", f"{row['seconds']:.1f}",
                f"{row['megabytes']:.0f}", "yes" if row["verified"] else "NO"]
    print("| " + " | ".join(told) + " |", flush=True)


def is_wrong(row):
    if row["status"]:
        return row["status"] not in (2, 3) or row["embedded"] == "yes"
    return not row["verified"] or (row["embedded"] == "yes" and row["surface"] != "kept")


def tell_sums(folders):
    """A row for each folder."""
    titles = ("folder", "files", "embedded", "kept", "unions", "filled", "refused", "verified",
              "pieces", "as few as can be, of two and more", "margins >= 0.001", "seconds")
    print("\n| " + " | ".join(titles) + " |\n" + "|---" * len(titles) + "|")
    for name, rows in folders.items():
        cut = [row for row in rows if row["status"] == 0]
        pieces = sum(row["pieces"] for row in cut)
        told = [len(rows), sum(row["embedded"] == "yes" for row in rows),
                sum(row["surface"] == "kept" for row in cut),
                sum(row["surface"].startswith("union") for row in cut),
                sum(row["surface"] == "filled" for row in cut), len(rows) - len(cut),
                sum(row["verified"] for row in cut), pieces,
                sum(row["bound"] == row["pieces"] > 1 for row in cut),
                f"{100 * sum(row['wide'] for row in cut) / max(1, pieces):.1f} %",
                f"{sum(row['seconds'] for row in rows):.0f}"]
        print(f"| {name} | " + " | ".join(f"{n:,}" if isinstance(n, int) else n for n in told) + " |")


def tell_every(options):
    """A row for each file, then the sums of each folder."""
    rows = {}
    if options.results and os.path.exists(options.results):
        with open(options.results, encoding="utf-8") as file:
            rows = dict(map(json.loads, file))
    words = ["--threads", "1", *options.more.split()]
    words += ["--effort", str(options.effort)] if options.effort else []
    groups = options.groups.split(",") if options.groups else sorted(
        name for name in os.listdir(options.data) if os.path.isdir(os.path.join(options.data, name)))
    names = [os.path.join(group, name) for group in groups
             for name in sorted(os.listdir(os.path.join(options.data, group)))
             if name.lower().endswith(SURFACES + SOLIDS)]
    print("| " + " | ".join(COLUMNS) + " |\n" + "|---" * len(COLUMNS) + "|")
    for name in names:
        if name not in rows:
            rows[name] = row_of(options.starguard, os.path.join(options.data, name), words)
            if options.results:
                with open(options.results, "a", encoding="utf-8") as file:
                    file.write(json.dumps([name, rows[name]]) + "\n")
        tell_row(name, rows[name])
    tell_sums({group: [rows[n] for n in names if n.startswith(group + "/")] for group in groups}
              | {"all": [rows[n] for n in names]})
    wrong = [name for name in names if is_wrong(rows[name])]
    if wrong:
        raise SystemExit("wrong: " + ", ".join(wrong))


# ---- early results ----


def tell_early(program, models, data, limit):
    ratios = []
    print(f"| model | pieces after {limit:g} s | in the end | ratio |\n|---|---|---|---|")
    for model in models:
        early, last = (len(report_of(program, model, words)[0]["pieces"])
                       for words in (["--time-limit", str(limit)], []))
        ratios.append(early / last)
        name = os.path.splitext(os.path.relpath(model, data))[0]
        print(f"| {name} | {early} | {last} | {ratios[-1]:.2f} |", flush=True)
    print(f"\nAt most 1.5: {sum(ratio <= 1.5 for ratio in ratios)} of {len(ratios)}.")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("starguard")
    parser.add_argument("data")
    parser.add_argument("--than")
    parser.add_argument("--groups", help="folders; default: cad,solids,table2, with --every all")
    parser.add_argument("--effort", type=int)
    parser.add_argument("--quality", action="store_true")
    parser.add_argument("--every", action="store_true")
    parser.add_argument("--results", help="of --every: rows so far")
    parser.add_argument("--early", type=float, metavar="SECONDS")
    parser.add_argument("--prove", action="store_true")
    parser.add_argument("--models", default="")
    parser.add_argument("--more", default="", help="further options of decompose")
    options = parser.parse_args()
    if options.every:
        tell_every(options)
        return
    programs = [p for p in (options.than, options.starguard) if p]
    models = [m for group in (options.groups or "cad,solids,table2").split(",")
              for m in sorted(glob.glob(os.path.join(options.data, group, "*.off")))]
    if options.models:
        models = [os.path.join(options.data, name + ".off") for name in options.models.split(",")]
    if options.early:
        tell_early(options.starguard, models, options.data, options.early)
        return
    if options.quality:
        words = ["--prove"] * options.prove + options.more.split()
        if options.effort:
            words += ["--effort", str(options.effort)]
        tell_quality(options.starguard, models, options.data, words)
        return
    effort = options.effort or 500
    head = " | pieces | surface | seconds | verified"
    print("| model" + head * len(programs) + " |")
    print("|---" * (1 + 4 * len(programs)) + "|")
    sums = [{"pieces": 0, "kept": 0, "seconds": 0, "verified": 0} for _ in programs]
    for model in models:
        runs = [cut(p, options.starguard, model, effort) for p in programs]
        for total, run in zip(sums, runs):
            for key, value in run.items():
                total[key] += value
        if (len({run["pieces"] for run in runs}) > 1 or
                not all(run["kept"] and run["verified"] for run in runs)):
            name = os.path.splitext(os.path.relpath(model, options.data))[0]
            print(f"| {name} | " + " | ".join(map(cells, runs)) + " |", flush=True)
    print(f"| all {len(models)} | " + " | ".join(
        f"{s['pieces']} | {s['kept']} kept | {s['seconds']:.0f} | {s['verified']}"
        for s in sums) + " |")


if __name__ == "__main__":
    main()
