#!/usr/bin/python3
"""Scores labels on real plants whose organs were labelled by hand.

    score_real.py convert REAL FOLDER     write the clouds, without labels, as FOLDER/SET_PLANT.ply
    plantimeter measure FOLDER/*.ply -o RUN
    score_real.py score REAL RUN          compare RUN/SET_PLANT.labelled.ply with the hand labels

REAL holds maize_pot (3D_Corn_Phenotype), maize_mvs and maize_scanner (Label3DMaize) and growth_series (TrackPlant3D) as
published: rows of x y z label. The stem is the lowest label of a file, each other label one leaf (the tomatoes' stem class
holds petioles and rachises too, so found petioles count as stem). The large maize of maize_mvs stand in pots, which the
hand labels give to the stem or to a leaf: their last label is the pot. Points called ground are left out; the rest of a pot is neither
stem nor a leaf, and a leaf that is made of it counts as found. Prints for each plant the IoU of stem and of leaf, the
leaves' F1 at IoU 0.5, true and found counts, and the share of points called other; then means by set. Where compound
leaves were found, their leaflets are scored as leaves, too: by hand some plants were labelled by leaves, others by
leaflets, and no file says which. The means by set are given for leaves, and for the better of the two of each plant.
"""
import glob
import os
import sys
from collections import defaultdict

import numpy as np

from score import iou, read_ply

SETS = {"maize_pot": "*.labelled.xyz", "maize_mvs": "4_*.txt", "maize_scanner": "3_*.txt", "growth_series": "*.txt"}


def plants(real):
    for name, pattern in SETS.items():
        for path in sorted(glob.glob(os.path.join(real, name, pattern))):
            plant = os.path.basename(path).replace(".labelled.xyz", "").replace(".txt", "")
            kind = name if name != "growth_series" else name + " " + plant.split("_")[1].rstrip("1234567890")
            yield kind, f"{name}_{plant}", path


def convert(real, folder):
    os.makedirs(folder, exist_ok=True)
    for _, plant, path in plants(real):
        xyz = np.loadtxt(path)[:, :3].astype("<f8")
        with open(os.path.join(folder, plant + ".ply"), "wb") as file:
            file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty double x\nproperty double y\n"
                       b"property double z\nend_header\n" % len(xyz))
            file.write(xyz.tobytes())


def leaves_f1(true_leaf, found_leaf):
    """Numbers of leaves, -1 for what is none. Gives F1, and how many leaves there are and were found."""
    true_ids, found_ids = np.unique(true_leaf[true_leaf >= 0]), np.unique(found_leaf[found_leaf >= 0])
    matched = 0
    for t in true_ids:
        mine = true_leaf == t
        touched = np.unique(found_leaf[mine & (found_leaf >= 0)])
        matched += any(iou(mine, found_leaf == f) >= 0.5 for f in touched)
    return 2 * matched / max(1, len(true_ids) + len(found_ids)), len(true_ids), len(found_ids)


def leaflets_of(found):
    """Numbers of leaflets, -1 for what is none; a leaf that has none is one. None where there are no compound leaves."""
    if "leaflet" not in found.dtype.names:
        return None
    organ, part = found["organ"].astype(int), found["leaflet"].astype(int)
    parted = np.isin(organ, np.unique(organ[(found["label"] == 3) & (part >= 0)]))
    number = organ * (part.max() + 1) + np.clip(part, 0, None)
    return np.where((found["label"] == 3) & ((part >= 0) | ~parted), number, -1)


def score(real, run):
    means = defaultdict(list)
    print(f"{'plant':46}{'stem':>7}{'leaf':>7}{'F1':>6}  leaves true/found  other %  of leaflets")
    for kind, plant, path in plants(real):
        result = os.path.join(run, plant + ".labelled.ply")
        if not os.path.exists(result):
            print(f"{plant:46} not measured")
            continue
        label, found = np.loadtxt(path)[:, 3].astype(int), read_ply(result)
        if len(label) != len(found):
            raise ValueError(f"{plant}: {len(found)} labelled points, {len(label)} by hand")
        lowest, pot = label.min(), label.max() if kind == "maize_mvs" else None
        kept = found["label"] != 4
        label, found = label[kept], found[kept]
        is_stem = label == lowest
        stem = iou(is_stem, np.isin(found["label"], (1, 2)))
        is_leaf = ~is_stem & (label != pot)
        leaf = iou(is_leaf, found["label"] == 3)
        true_leaf, leaflets = np.where(is_leaf, label, -1), leaflets_of(found)
        f1, true_count, found_count = leaves_f1(true_leaf, np.where(found["label"] == 3, found["organ"], -1))
        by_leaves = best = (f1, true_count == found_count)
        text = ""
        if leaflets is not None:
            f1_leaflets, _, count = leaves_f1(true_leaf, leaflets)
            best = max(by_leaves, (f1_leaflets, true_count == count))
            text = f"{f1_leaflets:6.2f} {count:4}"
        other = 100 * np.mean(~np.isin(found["label"], (1, 2, 3)))
        print(f"{plant:46}{stem:7.3f}{leaf:7.3f}{f1:6.2f}  {true_count:6}/{found_count:<10}{other:8.2f}{text}")
        means[kind].append((stem, leaf, *by_leaves, *best, other))
    print(f"\n{'set':24}{'plants':>7}{'stem':>7}{'leaf':>7}{'F1':>7}{'count %':>9}{'best F1':>9}{'count %':>9}{'other %':>9}")
    for kind, rows in means.items():
        stem, leaf, f1, count, best, best_count, other = np.mean(np.array(rows, float), axis=0)
        print(f"{kind:24}{len(rows):7}{stem:7.3f}{leaf:7.3f}{f1:7.3f}{100 * count:9.0f}{best:9.3f}{100 * best_count:9.0f}"
              f"{other:9.2f}")


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in ("convert", "score"):
        sys.exit(__doc__)
    (convert if sys.argv[1] == "convert" else score)(sys.argv[2], sys.argv[3])
