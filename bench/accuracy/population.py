#!/usr/bin/python3
"""Errors and coverage of all traits over a population of virtual plants, with the program's own labels and with true ones.

    population.py --program PLANTIMETER -o OUT [--kinds A,B] [--count N] [--seed S] [--modes clean,rgbd,splat]
                  [--points N] [--noise MM] [--image-width PIXELS] [--arched] [--bounds FILE]
    population.py --program PLANTIMETER -o OUT --folder DIR...      plants that are there already, one folder a mode

Makes N plants of each kind and mode by `plantimeter simulate`, measures each twice (own: segmented by the program; true:
`measure --labels label` on the labelled cloud) and scores both: what is wrong with true labels is the estimator's error,
the rest is the labels'. Writes into OUT
    accuracy.csv   mode, kind (or all), trait, source, n, missing, bias, rmse, median, unit, mape, cover, cover_low,
                   cover_high, relative_se
    errors.csv     a row a value: what it was, should be, and its standard error
    *.svg          errors in standard errors by trait and mode, with the gnuplot scripts beside them, where gnuplot is
cover is the share of 95 % intervals that hold the truth, cover_low to cover_high its own 95 % interval (Wilson's); relative_se
the median standard error as % of the true value, by which an interval that is merely wide is seen.
--bounds FILE: CSV rows mode,trait,source,figure,low,high; exit status 1 if a figure is outside.
"""
import argparse
import csv
import json
import math
import os
import shutil
import subprocess
import sys
from collections import defaultdict

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
try:
    import numpy as np

    import score
except ImportError as problem:  # a machine without numpy skips the test
    print(f"skipped: {problem}")
    sys.exit(77)

KINDS = "eggplant,pepper,okra,cucumber,soybean,tomato,maize,arabidopsis"
SCANNER = {"clean": ["--scanner", "dome"], "rgbd": ["--scanner", "rgbd", "--outliers", "0.005"],
           "splat": ["--scanner", "splat"]}


def make_plants(options, out):
    folders = []
    for mode in options.modes.split(","):
        folder = os.path.join(out, "plants", mode)
        command = [options.program, "simulate", *options.kinds.split(","), "-n", str(options.count), "--seed",
                   str(options.seed), *SCANNER[mode], "--points", str(options.points), "-q", "-o", folder]
        if mode != "clean":
            command += ["--noise", str(options.noise)]
        if mode == "rgbd" and options.image_width:
            command += ["--image-width", str(options.image_width)]
        if options.arched:
            command += ["--arched"]
        subprocess.run(command, check=True)
        folders.append(folder)
    return folders


def read_index(folder):
    with open(os.path.join(folder, "truth.json")) as file:
        index = json.load(file)
    return index["cases"] if isinstance(index, dict) else index


def read_truth(folder, case):
    with open(os.path.join(folder, case["truth"])) as file:
        return json.load(file)


def measure(program, files, run, extra):
    if os.path.isdir(run):
        shutil.rmtree(run)
    done = subprocess.run([program, "measure", *files, "-o", run, "-q", *extra], stderr=subprocess.PIPE, text=True)
    if done.returncode > 1:
        sys.exit(f"measure ended with status {done.returncode}: {done.stderr}")


def identity(truth):
    """Leaves matched to themselves: the labels are the true ones."""
    return {o["organ_id"]: o["organ_id"] for o in truth["organs"] if o["organ"] in ("leaf", "petiole")}


def score_folder(folder, out, program):
    """Rows (mode, kind, plant, source, trait, organ, error, truth, standard error) and misses."""
    cases, found, missing = read_index(folder), [], defaultdict(int)
    name = os.path.basename(os.path.normpath(folder))
    for source in ("own", "true"):
        run = os.path.join(out, "runs", name + "_" + source)
        key = "file" if source == "own" else "labelled"
        measure(program, [os.path.join(folder, c[key]) for c in cases], run,
                [] if source == "own" else ["--labels", "label"])
        rows = score.read_traits(run)
        for case in cases:
            truth = read_truth(folder, case)
            plant = case["plant_id"] + ("" if source == "own" else ".labelled")
            pairs = score.score_labels(case, run, folder)["pairs"] if source == "own" else identity(truth)
            scores, misses = defaultdict(list), defaultdict(int)
            score.score_traits(case, truth, rows[plant], pairs, scores, misses)
            for (mode, trait), values in scores.items():
                found += [(mode, truth["kind"], case["plant_id"], source, trait, v[4], *v[:3]) for v in values]
            for (mode, trait), n in misses.items():
                missing[(mode, truth["kind"], trait, source)] += n
                missing[(mode, "all", trait, source)] += n
    return found, missing


FIGURES = ("mode", "kind", "trait", "source", "n", "missing", "bias", "rmse", "median", "unit", "mape", "cover",
           "cover_low", "cover_high", "relative_se")


def summarise(rows, missing):
    groups = defaultdict(list)
    for mode, kind, _, source, trait, _, error, true, se in rows:
        for k in (kind, "all"):
            groups[(mode, k, trait, source)].append((error, true, se))
    order = list(score.TRAITS)
    table = []
    for key in sorted(set(groups) | set(missing), key=lambda k: (order.index(k[2]), k[0], k[1] != "all", k[1], k[3])):
        values = np.array(groups.get(key, []), float).reshape(-1, 3)
        scale, unit = score.in_unit(key[2])
        row = dict(zip(FIGURES, key), n=len(values), missing=missing.get(key, 0), unit=unit)
        if len(values):
            error, true, se = values.T
            known, whole = np.isfinite(se), true != 0
            row.update(bias=error.mean() * scale, rmse=math.sqrt(np.mean(error ** 2)) * scale,
                       median=np.median(np.abs(error)) * scale)
            if whole.any():
                row["mape"] = 100 * np.mean(np.abs(error[whole] / true[whole]))
            if known.any():
                cover = np.mean(np.abs(error[known]) <= 1.96 * se[known])
                low, high = score.wilson(cover, known.sum())
                row.update(cover=cover, cover_low=low, cover_high=high)
                if (known & whole).any():
                    row["relative_se"] = 100 * np.median(se[known & whole] / np.abs(true[known & whole]))
        table.append(row)
    return table


def write_csv(path, header, rows):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows(rows)


def print_table(table):
    print(f"{'mode':7}{'trait':24}{'source':6}{'n':>5}{'miss':>5}{'bias':>10}{'rmse':>10}{'median':>9} unit"
          f"{'mape %':>9}{'cover':>7}{'se %':>7}")
    for r in table:
        if r["kind"] == "all" and r["n"]:
            print(f"{r['mode']:7}{r['trait']:24}{r['source']:6}{r['n']:5}{r['missing']:5}{r['bias']:10.4f}"
                  f"{r['rmse']:10.4f}{r['median']:9.4f} {r['unit']:4}{r.get('mape', math.nan):9.3f}"
                  f"{r.get('cover', math.nan):7.2f}{r.get('relative_se', math.nan):7.2f}")


def plot(out, rows):
    """Errors over standard errors, a picture a mode: 95 % of the dots belong between the lines."""
    if not shutil.which("gnuplot"):
        return
    traits = [t for t in score.TRAITS if any(r[4] == t for r in rows)]
    for mode in sorted({r[0] for r in rows}):
        data = os.path.join(out, f"scaled_errors_{mode}.dat")
        with open(data, "w") as file:
            for source, shift in (("true", -0.18), ("own", 0.18)):
                for r in rows:
                    if r[0] == mode and r[3] == source and r[8] > 0:
                        jitter = 0.12 * math.sin(97 * len(r[2]) + 1e4 * r[6] + 13 * int(r[5] or 0))
                        ratio = max(-8, min(8, r[6] / r[8]))
                        file.write(f"{traits.index(r[4]) + shift + jitter:.3f} {ratio:.4f}\n")
                file.write("\n\n")
        script = os.path.join(out, f"scaled_errors_{mode}.gnuplot")
        tics = ", ".join(f'"{t.replace("_", " ")}" {i}' for i, t in enumerate(traits))
        with open(script, "w") as file:
            file.write(f'set terminal svg size 1200,600\nset output "scaled_errors_{mode}.svg"\n'
                       f'set title "{mode}: error / standard error (beyond 8: drawn at 8)"\n'
                       f'set xtics rotate by 45 right ({tics})\nset yrange [-8.5:8.5]\nset key outside\n'
                       f'set xrange [-1:{len(traits)}]\nset bmargin 10\n'
                       f'plot "scaled_errors_{mode}.dat" index 0 with points pt 7 ps 0.25 title "true labels", '
                       f'"" index 1 with points pt 7 ps 0.25 title "own labels", '
                       f'1.96 with lines lc "grey" title "95 %", -1.96 with lines lc "grey" notitle\n')
        subprocess.run(["gnuplot", os.path.basename(script)], cwd=out, check=True)


def check_bounds(path, table):
    """Prints each figure that is outside of its bounds; gives how many are."""
    known = {(r["mode"], r["trait"], r["source"]): r for r in table if r["kind"] == "all"}
    outside = 0
    with open(path, newline="") as file:
        for bound in csv.DictReader(file):
            row = known.get((bound["mode"], bound["trait"], bound["source"]), {})
            value = row.get(bound["figure"])
            if value is None or not float(bound["low"]) <= value <= float(bound["high"]):
                print(f"outside: {bound['mode']} {bound['trait']} ({bound['source']} labels) {bound['figure']} is "
                      f"{value}; it should be {bound['low']} to {bound['high']}")
                outside += 1
    return outside


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--kinds", default=KINDS)
    parser.add_argument("--count", type=int, default=2)
    parser.add_argument("--seed", type=int, default=501)
    parser.add_argument("--modes", default="clean,rgbd,splat")
    parser.add_argument("--points", type=int, default=45000)
    parser.add_argument("--noise", type=float, default=0.5)
    parser.add_argument("--image-width", type=int, help="of depth cameras: the wider, the more pixels a voxel has")
    parser.add_argument("--arched", action="store_true", help="seedlings with arched petioles and deep sinuses")
    parser.add_argument("--folder", nargs="+")
    parser.add_argument("--bounds")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    rows, missing = [], defaultdict(int)
    for folder in options.folder or make_plants(options, options.output):
        found, misses = score_folder(folder, options.output, options.program)
        rows += found
        for key, n in misses.items():
            missing[key] += n
    table = summarise(rows, missing)
    write_csv(os.path.join(options.output, "errors.csv"),
              ("mode", "kind", "plant_id", "source", "trait", "organ_id", "error", "truth", "std_error"), rows)
    write_csv(os.path.join(options.output, "accuracy.csv"), FIGURES,
              ([r.get(f, "") if not isinstance(r.get(f), float) else f"{r[f]:.6g}" for f in FIGURES] for r in table))
    print_table(table)
    plot(options.output, rows)
    return 1 if options.bounds and check_bounds(options.bounds, table) else 0


if __name__ == "__main__":
    sys.exit(main())
