#!/usr/bin/python3
"""Scenes as they come: how often the organs of a virtual plant are found when scanner, sampling, noise and surroundings are drawn.

    scenes.py --program PLANTIMETER -o OUT [--count N] [--seed S] [--kinds A,B,...] [--points LEAST MOST] [--least-exact SHARE]

Draws N scenes (the same by the same seed): a kind of plant, a scanner, 5 000 to 200 000 points (or LEAST to MOST), noise, floaters,
views, pot, table or neither, points or gaussians. Makes each by `plantimeter simulate`, measures it at default options, and writes
OUT/scenes.csv, a row a scene: mean_iou over stem + petiole and leaf, f1 of the leaves at IoU 0.5, how many there are and were
found, share of the ground's points that were called plant, what the habit was guessed to be, and seconds. Prints the means by
scanner and surroundings, and the worst scenes.
A population (population.py) tells how exact the traits are on usual scans; this tells what goes wrong altogether on others.
--least-exact: exit status 1 if fewer scenes than this share have the number of leaves exact.
"""
import argparse
import csv
import json
import math
import os
import random
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
try:
    import numpy as np

    import score
    from population import measure, read_index
except ImportError as problem:  # a machine without numpy skips the test
    print(f"skipped: {problem}")
    sys.exit(77)

SEEDLINGS = ["eggplant", "pepper", "okra", "cucumber", "tomato", "soybean", "maize", "arabidopsis"]
LARGE = ["tomato_large", "cucumber_large", "maize_large", "arabidopsis_large"]  # too far off for depth cameras
FIELDS = ("scene", "kind", "scanner", "surroundings", "options", "habit", "mean_iou", "f1", "leaves", "found",
          "ground_left", "seconds")
POINTS = (10 ** 3.7, 10 ** 5.3)  # least and most, equally likely in logarithms
WORST = 8


def draw_scene(draw, number, kinds, points=POINTS):
    """Kind, scanner, surroundings and options of simulate."""
    kind = kinds[number % len(kinds)]
    scanner = draw.choice(["dome", "uniform", "splat"] + (["rgbd"] if kind not in LARGE else []))
    options = ["--points", str(int(10 ** draw.uniform(math.log10(points[0]), math.log10(points[1]))))]
    if scanner == "rgbd":
        options += ["--noise", f"{draw.uniform(0.2, 0.8):.2f}", "--views", str(draw.choice([6, 8, 12, 12, 20])),
                    "--outliers", str(draw.choice([0, 0.005, 0.02]))]
    elif scanner == "splat":
        options += ["--noise", f"{draw.uniform(0.2, 0.8):.2f}", "--outliers", str(draw.choice([0, 0.01, 0.03]))]
        if draw.random() < 0.4:
            options += ["--format", "3dgs"]
    elif draw.random() < 0.5:
        options += ["--noise", f"{draw.uniform(0, 0.4):.2f}"]
    surroundings = draw.choice(["none", "none", "pot", "table"])
    if surroundings != "none":
        options.append("--" + surroundings)
    return kind, scanner, surroundings, options


def ground_left(case, run, folder):
    truth, found = score.read_labels(case, run, folder)
    ground = truth["label"] == 4
    return float(np.mean(np.isin(found["label"][ground], (1, 2, 3)))) if ground.any() else float("nan")


def score_scene(program, out, name, seed, scene):
    kind, scanner, surroundings, options = scene
    folder, run = os.path.join(out, "plants", name), os.path.join(out, "runs", name)
    subprocess.run([program, "simulate", kind, "--scanner", scanner, "--seed", str(seed), *options, "-q", "-o", folder],
                   check=True)
    case = read_index(folder)[0]
    start = time.monotonic()
    try:
        measure(program, [os.path.join(folder, case["file"])], run, ["--views", "0"])
        labels, left = score.score_labels(case, run, folder), ground_left(case, run, folder)
        with open(os.path.join(run, "run.json")) as file:
            habit = json.load(file)["plants"][0]["organs"]["habit"]
    except (SystemExit, OSError, ValueError, TypeError, KeyError) as problem:  # the worst of all: nothing was measured
        print(f"{name}: {problem}", file=sys.stderr)
        labels, left, habit = {"miou": 0, "f1": 0, "pieces": (None, 0)}, float("nan"), "failed"
    values = (name, kind, scanner, surroundings, " ".join(options), habit, round(labels["miou"], 4),
              round(labels["f1"], 4), *labels["pieces"], round(left, 6), round(time.monotonic() - start, 2))
    return dict(zip(FIELDS, values))


def print_group(name, rows):
    exact = np.mean([row["leaves"] == row["found"] for row in rows])
    print(f"{name:16} n {len(rows):3}  mean IoU {np.mean([row['mean_iou'] for row in rows]):.3f}  "
          f"F1 {np.mean([row['f1'] for row in rows]):.3f}  count exact {100 * exact:.0f} %")
    return exact


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("-o", "--out", required=True)
    parser.add_argument("--count", type=int, default=96)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", default=",".join(SEEDLINGS + LARGE))
    parser.add_argument("--points", type=float, nargs=2, default=POINTS)
    parser.add_argument("--least-exact", type=float, default=0)
    options = parser.parse_args()
    draw, rows = random.Random(options.seed), []
    for number in range(options.count):
        scene = draw_scene(draw, number, options.kinds.split(","), options.points)
        rows.append(score_scene(options.program, options.out, f"{number:03d}", 1000 * options.seed + number, scene))
    with open(os.path.join(options.out, "scenes.csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, FIELDS)
        writer.writeheader()
        writer.writerows(rows)
    for field in ("scanner", "surroundings"):
        for value in sorted({row[field] for row in rows}):
            print_group(value, [row for row in rows if row[field] == value])
    exact = print_group("all", rows)
    for row in sorted(rows, key=lambda row: row["mean_iou"] + row["f1"])[:WORST]:
        print(f"  {row['scene']} {row['kind']} {row['scanner']} {row['options']}: {row['habit']}, IoU {row['mean_iou']}, "
              f"F1 {row['f1']}, {row['found']} of {row['leaves']} leaves")
    return 1 if exact < options.least_exact else 0


if __name__ == "__main__":
    sys.exit(main())
