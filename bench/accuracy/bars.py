#!/usr/bin/python3
"""The accuracy bars of the project against runs of `plantimeter measure` with its own labels.

    bars.py RUN=TRUTH_FOLDER... [--worst N] [--kinds] [--noise LEAST MOST]

Each RUN holds traits.csv and PLANT.labelled.ply, its TRUTH_FOLDER what `plantimeter simulate` writes. Plants of all
runs are taken together by scan mode. Prints a line a bar: what was measured, the bar, and whether it holds; with
--worst the N worst values of each, with --kinds a column a kind, with --noise only of plants at whose distance the
noise of the scanner has an SD (mm) from LEAST up to MOST: depth cameras see large plants from farther off. 95 %
intervals should hold the truth in 92 to 98 % (splats 90 to 98); where they do not, and chance does not explain it, they
are called narrow or wide. Two bars are for part of the organs: petioles from 20 mm of true length up (in noise; the
median tells of shorter ones) and stems of 2 to 4 mm.
"""
import argparse
import json
import math
import os
import sys
from collections import defaultdict

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import score

# bar: (figure, sign: +1 more is better, clean, rgbd, splat)
BARS = {
    "labels, mean IoU": ("mean", +1, 0.95, 0.88, 0.85),
    "leaf instances, F1": ("mean", +1, 0.97, 0.92, 0.88),
    "leaf count exact, %": ("share", +1, 95, 90, 85),
    "plant_height, MAPE %": ("mape", -1, 0.1, 0.5, 0.4),
    "leaf_area, MAPE %": ("mape", -1, 1.2, 2.5, 3.5),
    "leaf_inclination, RMSE deg": ("rmse", -1, 0.3, 0.4, 0.8),
    "petiole_inclination from 20 mm, RMSE deg": ("rmse", -1, 0.4, 0.7, 1.0),
    "petiole_inclination, median deg": ("median", -1, 0.4, 0.7, 1.0),
    "stem_diameter of 2-4 mm, RMSE mm": ("rmse", -1, 0.02, 0.10, 0.08),
    "convex_hull_volume, MAPE %": ("mape", -1, 0.15, 0.9, 1.0),
}
MODES = ("clean", "rgbd", "splat")
COVER = ((0.92, 0.98), (0.92, 0.98), (0.90, 0.98))  # share of 95 % intervals that hold the truth
LONG_PETIOLE, THIN_STEM = 0.020, (0.002, 0.004)


def true_organs(truth):
    return {(o["organ"], str(o["organ_id"])): o for o in truth["organs"]}


def add_traits(truth, scores, mode, out):
    """Values (error, truth, standard error, kind, plant, organ) of each bar that this trait has."""
    organs, kind = true_organs(truth), truth["kind"]
    for (_, trait), rows in scores.items():
        for error, true, sigma, plant, organ in rows:
            unit = 1e3 if trait == "stem_diameter" else 1
            row = (error * unit, true, sigma * unit, kind, plant, organ)
            for bar in BARS:
                if bar.split(",")[0].split(" ")[0] != trait:
                    continue
                if "from 20 mm" in bar and organs[("petiole", organ)].get("petiole_length", 0) < LONG_PETIOLE:
                    continue
                if trait == "stem_diameter" and not THIN_STEM[0] <= true <= THIN_STEM[1]:
                    continue
                out[(mode, bar)].append(row)


def noise_at_plant(scan):
    """SD in mm at the plant's distance; the scanner's own where it does not grow with distance."""
    return 1e3 * scan.get("sigma_at_plant", scan.get("sigma", 0))


def read_run(run, folder, noise, out):
    with open(os.path.join(folder, "truth.json")) as file:
        index = json.load(file)
    rows = score.read_traits(run)
    for case in index["cases"] if isinstance(index, dict) else index:
        plant, mode = case["plant_id"], case["mode"]
        mode = "splat" if mode == "3dgs" else mode.split("_")[0]
        if not os.path.exists(os.path.join(run, plant + ".labelled.ply")):
            print(f"{plant}: not measured")
            continue
        with open(os.path.join(folder, case["truth"])) as file:
            truth = json.load(file)
        if noise and not noise[0] <= noise_at_plant(truth["scan"]) < noise[1]:
            continue
        labels = score.score_labels(case, run, folder)
        count = rows[plant].get(("plant", "", "leaf_count"))
        found = int(float(count["value"])) if count and count["value"] else -1
        true_count = truth["plant"]["leaf_count"]
        nan, kind = math.nan, truth["kind"]
        out[(mode, "labels, mean IoU")].append((labels["miou"], 1, nan, kind, plant, ""))
        out[(mode, "leaf instances, F1")].append((labels["f1"], 1, nan, kind, plant, ""))
        out[(mode, "leaf count exact, %")].append((found - true_count, true_count, nan, kind, plant, ""))
        scores, misses = defaultdict(list), defaultdict(int)
        score.score_traits(case, truth, rows[plant], labels["pairs"], scores, misses)
        add_traits(truth, scores, mode, out)


def figure(name, rows):
    value, true = np.array([r[0] for r in rows]), np.array([r[1] for r in rows])
    if name == "mean":
        return value.mean()
    if name == "share":
        return 100 * np.mean(value == 0)
    if name == "mape":
        return 100 * np.mean(np.abs(value / true))
    return np.sqrt(np.mean(value ** 2)) if name == "rmse" else np.median(np.abs(value))


def cover(rows, limits):
    """Share of the 95 % intervals that hold the truth, and whether it lies in its limits: `narrow` and `wide` intervals are said
    where chance does not explain it (the share's own 95 % interval, as if organs were independent, lies beyond)."""
    held = [abs(r[0]) <= 1.96 * r[2] for r in rows if np.isfinite(r[2])]
    if not held:
        return ""
    low, high = score.wilson(np.mean(held), len(held))
    said = "narrow" if high < limits[0] else "wide" if low > limits[1] else ""
    return f"cover {np.mean(held):.3f} {said}"


def worst(name, rows, count):
    def badness(row):
        return {"mean": -row[0], "share": abs(row[0]), "mape": abs(row[0] / row[1])}.get(name, abs(row[0]))
    for row in sorted(rows, key=badness, reverse=True)[:count]:
        value = 100 * row[0] / row[1] if name == "mape" else row[0]
        print(f"        {row[4]} {row[5]}: {value:.3f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("runs", nargs="+", metavar="RUN=TRUTH_FOLDER")
    parser.add_argument("--worst", type=int, default=0)
    parser.add_argument("--kinds", action="store_true")
    parser.add_argument("--noise", nargs=2, type=float, metavar=("LEAST", "MOST"))
    options = parser.parse_args()
    out, missed = defaultdict(list), 0
    for pair in options.runs:
        read_run(*pair.split("="), options.noise, out)
    for mode_number, mode in enumerate(MODES):
        kinds = sorted({r[3] for key, rows in out.items() if key[0] == mode for r in rows})
        for bar, (name, sign, *bars) in BARS.items():
            rows = out.get((mode, bar))
            if not rows:
                continue
            value, limit = figure(name, rows), bars[mode_number]
            holds = sign * (value - limit) >= 0
            missed += not holds
            by_kind = " ".join(f"{k[:4]} {figure(name, [r for r in rows if r[3] == k]):.3g}"
                               for k in kinds if any(r[3] == k for r in rows)) if options.kinds else ""
            print(f"{mode:6}{bar:42}{len(rows):4}{value:9.3f} of {limit:<6}{'' if holds else 'MISSED':7}"
                  f"{cover(rows, COVER[mode_number])}  {by_kind}")
            worst(name, rows, options.worst)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
