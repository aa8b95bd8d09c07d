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
TREES, DEPTH, RATE, BINS, RIDGE = 64, 5, 0.3, 48, 20.0


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


def best_splits(binned, edges, node, gradient, hessian, leaves):
    g_all, h_all = np.bincount(node, gradient, leaves), np.bincount(node, hessian, leaves)
    gain, feature, place = np.full(leaves, 1e-6), np.zeros(leaves, int), np.full(leaves, 255)
    for f, edge in enumerate(edges):
        cell = node * 64 + binned[f]
        g = np.bincount(cell, gradient, leaves * 64).reshape(leaves, 64).cumsum(1)
        h = np.bincount(cell, hessian, leaves * 64).reshape(leaves, 64).cumsum(1)
        won = (g ** 2 / (h + RIDGE) + (g_all[:, None] - g) ** 2 / (h_all[:, None] - h + RIDGE)
               - (g_all ** 2 / (h_all + RIDGE))[:, None])
        won[:, len(edge):] = 0
        at = won.argmax(1)
        top = won[np.arange(leaves), at]
        better = top > gain
        gain[better], feature[better], place[better] = top[better], f, at[better]
    return feature, place


def boost(x, y, w):
    edges = [np.unique(np.quantile(x[::4, f], np.linspace(0, 1, BINS + 1)[1:-1]).astype(np.float32))
             for f in range(x.shape[1])]
    binned = np.stack([np.searchsorted(edges[f], x[:, f], side="left") for f in range(x.shape[1])]).astype(np.uint8)
    bias = np.log((w * y).sum() / (w * (1 - y)).sum())
    score, trees, row = np.full(len(y), bias), [], np.arange(len(y))
    for _ in range(TREES):
        p = 1 / (1 + np.exp(-score))
        gradient, hessian = w * (p - y), w * p * (1 - p)
        node, tree = np.zeros(len(y), int), []
        for depth in range(DEPTH):
            feature, place = best_splits(binned, edges, node, gradient, hessian, 1 << depth)
            tree += [(int(f), float(edges[f][k]) if k < 255 else np.inf) for f, k in zip(feature, place)]
            node = 2 * node + (binned[feature[node], row] > place[node])
        g, h = np.bincount(node, gradient, 1 << DEPTH), np.bincount(node, hessian, 1 << DEPTH)
        leaf = -RATE * g / (h + RIDGE)
        score += leaf[node]
        trees.append((tree, leaf))
    return bias, trees


def number(value):
    if np.isinf(value):
        return "INFINITY"
    text = f"{np.float32(value):.6g}"
    return text + ("F" if any(c in text for c in ".e") else ".0F")


def write(bias, trees):
    print("/* segment/ghost_forest.h: boosted trees of segment/ghosts.c; a feature above its threshold goes to the right."
          "\n * Written by bench/accuracy/train_ghosts.py. Internal. */")
    print("#ifndef PLANTIMETER_SEGMENT_GHOST_FOREST_H\n#define PLANTIMETER_SEGMENT_GHOST_FOREST_H\n")
    print("#include <math.h>\n#include <stdint.h>\n")
    print(f"enum {{ GHOST_NODES = {(1 << DEPTH) - 1} }};\n\nstatic const double GHOST_BIAS = {bias:.6g};")
    print("/* clang-format off */\nstatic const struct {\n    uint8_t feature[GHOST_NODES];\n"
          "    float threshold[GHOST_NODES];\n    float leaf[GHOST_NODES + 1];\n"
          f"}} GHOST_TREE[{len(trees)}] = {{")
    for tree, leaf in trees:
        print("    {{" + ", ".join(str(f) for f, _ in tree) + "},")
        print("     {" + ", ".join(number(t) for _, t in tree) + "},")
        print("     {" + ", ".join(number(v) for v in leaf) + "}},")
    print("};\n/* clang-format on */\n\n#endif")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    write(*boost(*gather(sys.argv[2], make_plants(sys.argv[1], sys.argv[3]))))
