#!/usr/bin/python3
"""Scores a run of `plantimeter measure` against plants with known truth.

    score.py RUN TRUTH_FOLDER [--csv FILE] [--worst N]

RUN holds traits.csv and PLANT.labelled.ply; TRUTH_FOLDER holds truth.json (the index) and, for each case, the labelled
cloud and its truth, as `plantimeter simulate` writes them. Prints a table by scan mode: labels (mean IoU over stem +
petiole and leaf), leaf instances (F1 at IoU 0.5), exact leaf counts, and for each trait bias, RMSE, MAPE, and the share
of 95 % intervals that cover the truth. Leaves are matched by their points (IoU at least 0.5), petioles through their leaf.
"""
import argparse
import csv
import json
import math
import os
import sys
from collections import defaultdict

import numpy as np

PLY_TYPES = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4",
             "float": "<f4", "double": "<f8", "int8": "i1", "uint8": "u1", "int32": "<i4", "float32": "<f4",
             "uint32": "<u4", "float64": "<f8"}

# name in traits.csv: (unit factor to SI or degrees, where in truth, key, visible fraction asked for)
TRAITS = {
    "plant_height": ("plant", "plant_height"),
    "plant_width": ("plant", "plant_width"),
    "projected_area": ("plant", "projected_area"),
    "convex_hull_volume": ("plant", "convex_hull_volume"),
    "convex_hull_area": ("plant", "convex_hull_area"),
    "pca1": ("plant", "pca1"),
    "pca2": ("plant", "pca2"),
    "total_leaf_area": ("plant", "total_leaf_area"),
    "leaf_area": ("leaf", "leaf_area"),
    "leaf_inclination": ("leaf", "leaf_inclination"),
    "facet_inclination_mean": ("leaf", "facet_inclination_mean"),
    "leaf_length": ("leaf", "leaf_length"),
    "leaf_width": ("leaf", "leaf_width"),
    "leaf_azimuth": ("leaf", "leaf_azimuth"),
    "leaf_azimuth_from_stem": ("leaf", "leaf_azimuth_from_stem"),
    "leaf_insertion_angle": ("leaf", "leaf_insertion_angle"),
    "petiole_inclination": ("petiole", "petiole_inclination"),
    "petiole_length": ("petiole", "petiole_length"),
    "petiole_diameter": ("petiole", "petiole_diameter"),
    "stem_diameter": ("stem", "stem_diameter"),
    "stem_length": ("stem", "stem_length"),
    "stem_inclination": ("stem", "stem_inclination"),
}
FACTOR = {"mm": 1e-3, "cm2": 1e-4, "cm3": 1e-6, "deg": 1.0, "1": 1.0}
VISIBLE = {"leaf_area": 0.9, "leaf_inclination": 0.8, "petiole_inclination": 0.5, "petiole_length": 0.5}


def read_ply(path):
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    count, fields = 0, []
    for line in data[:end].decode().split("\n"):
        word = line.split()
        if word[:2] == ["element", "vertex"]:
            count = int(word[2])
        elif word[:1] == ["property"]:
            fields.append((word[2], PLY_TYPES[word[1]]))
    return np.frombuffer(data, dtype=np.dtype(fields), count=count, offset=end)


def iou(a, b):
    union = np.count_nonzero(a | b)
    return np.count_nonzero(a & b) / union if union else 1.0


def match_leaves(truth, found):
    """Pairs (truth id, found id) with IoU >= 0.5 over points that both call leaf."""
    pairs = {}
    ids = np.unique(found["organ"][found["label"] == 3])
    for t in np.unique(truth["organ"][truth["label"] == 3]):
        mine = (truth["label"] == 3) & (truth["organ"] == t)
        for f in np.unique(found["organ"][mine & (found["label"] == 3)]):
            if iou(mine, (found["label"] == 3) & (found["organ"] == f)) >= 0.5:
                pairs[int(t)] = int(f)
    return pairs, len(np.unique(truth["organ"][truth["label"] == 3])), len(ids)


def read_labels(case, run, folder):
    """The labelled clouds of truth and of the run, row by row the same points."""
    truth = read_ply(os.path.join(folder, case["labelled"]))
    found = read_ply(os.path.join(run, case["plant_id"] + ".labelled.ply"))
    if "opacity" in truth.dtype.names and len(truth) != len(found):
        truth = truth[1 / (1 + np.exp(-truth["opacity"].astype(float))) >= 0.005]
    if len(truth) != len(found):
        raise ValueError(f"{case['plant_id']}: {len(found)} labelled points, truth has {len(truth)}")
    return truth, found


def score_labels(case, run, folder):
    truth, found = read_labels(case, run, folder)
    tube_t, tube_f = np.isin(truth["label"], (1, 2)), np.isin(found["label"], (1, 2))
    leaf_t, leaf_f = truth["label"] == 3, found["label"] == 3
    classes = [iou(t, f) for t, f in ((tube_t, tube_f), (leaf_t, leaf_f)) if t.any()]
    pairs, true_count, found_count = match_leaves(truth, found)
    f1 = 2 * len(pairs) / (true_count + found_count) if true_count + found_count else 1.0
    parts = {name: iou(truth["label"] == k, found["label"] == k)
             for k, name in ((1, "stem"), (2, "petiole"), (3, "leaf"), (4, "ground")) if (truth["label"] == k).any()}
    return {"miou": float(np.mean(classes)), "f1": f1, "parts": parts, "pairs": pairs,
            "pieces": (true_count, found_count)}


def wilson(share, n):
    """95 % interval of a share of n."""
    z = 1.96
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z * math.sqrt(share * (1 - share) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    return middle - half, middle + half


def read_traits(run):
    rows = defaultdict(dict)
    with open(os.path.join(run, "traits.csv"), newline="") as file:
        for row in csv.DictReader(file):
            rows[row["plant_id"]][(row["organ"], row["organ_id"], row["trait"])] = row
    return rows


def truth_values(truth, trait):
    level, key = TRAITS[trait]
    if level == "plant":
        yield "", truth["plant"].get(key), 1.0
        return
    for organ in truth["organs"]:
        if organ["organ"] == level and organ.get(key) is not None and organ.get("points", 1) > 0:
            yield str(organ["organ_id"]), organ[key], organ.get("visible_fraction", 1.0)


def difference(trait, value, truth):
    error = value - truth
    if "azimuth" in trait:
        error = (error + 180) % 360 - 180
    return error


def score_traits(case, truth, rows, pairs, out, misses):
    for trait, (level, _) in TRAITS.items():
        for organ_id, true_value, visible in truth_values(truth, trait):
            if true_value is None or visible < VISIBLE.get(trait, 0):
                continue
            found_id = organ_id
            if level in ("leaf", "petiole"):
                if int(organ_id) not in pairs:
                    misses[(case["mode"], trait)] += 1
                    continue
                found_id = str(pairs[int(organ_id)])
            row = rows.get((level, found_id, trait))
            if row is None or not row["status"].startswith("ok") or row["value"] == "":
                misses[(case["mode"], trait)] += 1
                continue
            factor = FACTOR[row["unit"]]
            value = float(row["value"]) * factor
            error = float(row["std_error"]) * factor if row["std_error"] else float("nan")
            out[(case["mode"], trait)].append((difference(trait, value, true_value), true_value, error,
                                               case["plant_id"], organ_id))


def in_unit(trait):
    if "area" in trait:
        return 1e4, "cm2"
    if "volume" in trait:
        return 1e6, "cm3"
    if any(word in trait for word in ("inclination", "azimuth", "angle")):
        return 1.0, "deg"
    return 1e3, "mm"


def print_traits(scores, misses, writer):
    print(f"{'mode':8}{'trait':26}{'n':>5}{'miss':>5}{'bias':>10}{'rmse':>10}{'median':>9} unit {'mape %':>8}"
          f"{'cover':>7}{'cover_n':>8}")
    for mode, trait in sorted(set(scores) | set(misses), key=lambda k: (list(TRAITS).index(k[1]), k[0])):
        rows = scores.get((mode, trait), [])
        if not rows:
            print(f"{mode:8}{trait:26}{0:5}{misses[(mode, trait)]:5}")
            continue
        error, true = np.array([r[0] for r in rows]), np.array([r[1] for r in rows])
        sigma = np.array([r[2] for r in rows])
        scale, unit = in_unit(trait)
        known = np.isfinite(sigma)
        cover = np.mean(np.abs(error[known]) <= 1.96 * sigma[known]) if known.any() else float("nan")
        mape = 100 * np.mean(np.abs(error) / np.abs(true)) if np.all(true != 0) else float("nan")
        line = (mode, trait, len(rows), misses[(mode, trait)], error.mean() * scale,
                np.sqrt(np.mean(error ** 2)) * scale, np.median(np.abs(error)) * scale, unit, mape, cover)
        print(f"{line[0]:8}{line[1]:26}{line[2]:5}{line[3]:5}{line[4]:10.4f}{line[5]:10.4f}{line[6]:9.4f} {unit:4}"
              f"{mape:9.3f}{cover:7.2f}{known.sum():8}")
        if writer:
            writer.writerow(line)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run")
    parser.add_argument("truth")
    parser.add_argument("--csv", help="write the trait table here too")
    parser.add_argument("--worst", type=int, default=0, help="print the N worst rows of each trait")
    options = parser.parse_args()
    with open(os.path.join(options.truth, "truth.json")) as file:
        index = json.load(file)
    cases = index["cases"] if isinstance(index, dict) else index
    rows, scores, misses = read_traits(options.run), defaultdict(list), defaultdict(int)
    labels = defaultdict(list)
    print(f"{'plant':28}{'mode':8}{'mIoU':>7}{'F1':>6}  leaves true/found  IoU by class")
    for case in cases:
        if not os.path.exists(os.path.join(options.run, case["plant_id"] + ".labelled.ply")):
            print(f"{case['plant_id']:28}{case['mode']:8}not measured")
            continue
        with open(os.path.join(options.truth, case["truth"])) as file:
            truth = json.load(file)
        result = score_labels(case, options.run, options.truth)
        count = rows[case["plant_id"]].get(("plant", "", "leaf_count"))
        found = int(float(count["value"])) if count and count["value"] else -1
        exact = found == truth["plant"]["leaf_count"]
        labels[case["mode"]].append((result["miou"], result["f1"], exact))
        parts = " ".join(f"{k} {v:.3f}" for k, v in result["parts"].items())
        print(f"{case['plant_id']:28}{case['mode']:8}{result['miou']:7.3f}{result['f1']:6.2f}"
              f"  {truth['plant']['leaf_count']:6}/{found:<11}  {parts}")
        score_traits(case, truth, rows[case["plant_id"]], result["pairs"], scores, misses)
    print()
    for mode, values in labels.items():
        mean = np.mean(np.array(values, float), axis=0)
        print(f"{mode:8} plants {len(values):3}  mIoU {mean[0]:.3f}  F1 {mean[1]:.3f}  exact count {100 * mean[2]:.0f} %")
    print()
    writer = None
    if options.csv:
        file = open(options.csv, "w", newline="")
        writer = csv.writer(file)
        writer.writerow(("mode", "trait", "n", "missing", "bias", "rmse", "median", "unit", "mape", "coverage"))
    print_traits(scores, misses, writer)
    for mode, trait in sorted(scores) if options.worst else ():
        scale, unit = in_unit(trait)
        for error, true, sigma, plant, organ in sorted(scores[(mode, trait)], key=lambda r: -abs(r[0]))[:options.worst]:
            print(f"{mode:8}{trait:26}{plant:28}{organ:>4} error {error * scale:9.3f} {unit} of {true * scale:9.3f}"
                  f" se {sigma * scale:.3f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
