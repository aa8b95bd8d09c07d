#!/usr/bin/python3
"""Learns segment/ghost_forest.h: gradient-boosted trees that tell ghosts and floaters from points of a plant.

    train_ghosts.py PLANTIMETER GHOST_TABLE FOLDER > segment/ghost_forest.h

PLANTIMETER makes the virtual plants (into FOLDER, kept), GHOST_TABLE (bench/) computes the features that the library
computes. The same programs give the same file. Every plant has the same weight; within a plant, stems and petioles
together weigh up to WEIGHT_OF_TUBES times as much as their points, because few points carry them. A point weighs what a
wrong answer costs: one of the plant the surface it stands for, a ghost how far off it lies (both by the distance to the
plant's next point in the plant's spacings, within bounds).
"""
import os
import subprocess
import sys

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import boosting  # noqa: E402

KINDS = "eggplant pepper okra cucumber soybean tomato maize arabidopsis".split()
SCANS = {
    501: "--scanner rgbd --noise 0.5 --points 45000 --outliers 0.005",
    511: "--scanner rgbd --noise 0.3 --points 90000 --outliers 0.005",
    521: "--scanner rgbd --noise 0.8 --points 45000 --outliers 0.01 --views 8",
    531: "--scanner rgbd --noise 0.5 --points 25000 --views 20",
    541: "--scanner splat --noise 0.5 --points 45000",
    551: "--scanner splat --noise 0.3 --points 20000 --outliers 0.02",
    561: "--scanner dome --points 30000",
    571: "--scanner uniform --noise 0.3 --points 30000 --outliers 0.005",
    581: "--scanner dome --points 8000",
    591: "--scanner uniform --noise 0.5 --points 8000 --outliers 0.005",
    601: "--scanner rgbd --noise 0.5 --points 45000 --outliers 0.005 --pot",
    611: "--scanner splat --noise 0.6 --points 45000 --pot",
    621: "--scanner rgbd --noise 0.4 --points 30000 --outliers 0.005 --pot --table",
    631: "--scanner splat --noise 0.4 --points 45000",
}
FEATURES = 23
POINTS = 12000  # of a plant, at most
WEIGHT_OF_TUBES = 4
SPACINGS_OF_PLANT, SPACINGS_OF_GHOST = (0.7, 4), (0.3, 8)  # least and most that weigh
TREES = 64


def make_plants(program, folder):
    clouds = []
    for seed, options in SCANS.items():
        place = os.path.join(folder, str(seed))
        if not os.path.exists(os.path.join(place, "truth.json")):
            subprocess.run([program, "simulate", *KINDS, "-n", "1", "--seed", str(seed), *options.split(), "-q", "-o",
                            place], check=True)
        clouds += sorted(os.path.join(place, name) for name in os.listdir(place) if name.endswith(".labelled.ply"))
    return clouds


def read_table(program, cloud):
    raw = subprocess.run([program, cloud], check=True, stdout=subprocess.PIPE).stdout
    count = np.frombuffer(raw, "<u4", 1)[0]
    table = np.frombuffer(raw, "<f4", offset=4).reshape(count, FEATURES + 2)
    return table[:, :FEATURES], table[:, FEATURES].astype(int), table[:, FEATURES + 1]


def gather(program, clouds):
    random = np.random.default_rng(1)
    features, ghost, weight = [], [], []
    for cloud in clouds:
        table, label, away = read_table(program, cloud)
        some = random.permutation(len(label))[:POINTS]
        tube, leaf = np.isin(label, (1, 2)), label == 3
        w = np.full(len(label), POINTS / len(some))
        if tube.any() and leaf.any():
            w[tube] *= min(WEIGHT_OF_TUBES, max(1, leaf.sum() / tube.sum()))
        spacings = away / np.median(away[label != 0])
        w *= np.where(label != 0, np.clip(spacings, *SPACINGS_OF_PLANT) ** 2, np.clip(spacings, *SPACINGS_OF_GHOST))
        features.append(table[some])
        ghost.append((label[some] == 0).astype(float))
        weight.append(w[some])
    return np.concatenate(features), np.concatenate(ghost), np.concatenate(weight)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    bias, trees = boosting.boost(*gather(sys.argv[2], make_plants(sys.argv[1], sys.argv[3])), TREES)
    boosting.write(bias, trees, "GHOST", "segment/ghosts.c", "train_ghosts.py")
