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
leaves' F1 at IoU 0.5, true and found counts, and the share of points called other; then means by set.
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


def leaves_f1(true_leaf, found):
    """true_leaf: number of the leaf, -1 for what is none."""
    leaf = found["label"] == 3
    true_ids, found_ids = np.unique(true_leaf[true_leaf >= 0]), np.unique(found["organ"][leaf])
    matched = 0
    for t in true_ids:
        mine = true_leaf == t
        matched += any(iou(mine, leaf & (found["organ"] == f)) >= 0.5 for f in np.unique(found["organ"][mine & leaf]))
    return 2 * matched / max(1, len(true_ids) + len(found_ids)), len(true_ids), len(found_ids)


def score(real, run):
    means = defaultdict(list)
    print(f"{'plant':46}{'stem':>7}{'leaf':>7}{'F1':>6}  leaves true/found  other %")
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
        f1, true_count, found_count = leaves_f1(np.where(is_leaf, label, -1), found)
        other = 100 * np.mean(~np.isin(found["label"], (1, 2, 3)))
        print(f"{plant:46}{stem:7.3f}{leaf:7.3f}{f1:6.2f}  {true_count:6}/{found_count:<10}{other:8.2f}")
        means[kind].append((stem, leaf, f1, true_count == found_count, other))
    print(f"\n{'set':24}{'plants':>7}{'stem':>7}{'leaf':>7}{'F1':>7}{'count %':>9}{'other %':>9}")
    for kind, rows in means.items():
        m = np.mean(np.array(rows, float), axis=0)
        print(f"{kind:24}{len(rows):7}{m[0]:7.3f}{m[1]:7.3f}{m[2]:7.3f}{100 * m[3]:9.0f}{m[4]:9.2f}")


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in ("convert", "score"):
        sys.exit(__doc__)
    (convert if sys.argv[1] == "convert" else score)(sys.argv[2], sys.argv[3])
