#!/usr/bin/python3
"""Learns segment/sparse_tube_forest.h: gradient-boosted trees that tell stems and petioles from blades where points are few.

    train_tubes.py PLANTIMETER TUBE_TABLE FOLDER > segment/sparse_tube_forest.h

PLANTIMETER makes the virtual plants (into FOLDER, kept, and taken again if they are there): scenes as scenes.py draws
them, and as many of few points. TUBE_TABLE (bench/) computes the features that the library computes. The same programs and
an empty FOLDER give the same file. Learnt are points with few others around; a plant weighs as much as it has of such, half
for its tubes and half for its blades. Of the scenes
every HELD_OUT-th is not learnt: how well its points with few others around are told (mean of the shares of tubes and of blades
that are told right), where most of its points are such, is printed to standard error.
"""
import os
import random
import subprocess
import sys
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import boosting  # noqa: E402
from scenes import LARGE, SEEDLINGS, draw_scene  # noqa: E402

KINDS = SEEDLINGS + LARGE + ["lettuce", "single_leaf", "bare_stem"]
SCENES, FEW_POINTS = 300, (3000, 12000)
SEED = 400000  # of the first plant; the next ones count on
SIZES, FEATURES, COUNT, LABEL = 3, 36, 36, 37  # of tube_table's rows
STEM, PETIOLE, LEAF = 1, 2, 3
SPARSE = 60  # as PLM_TUBE_SPARSE in segment/tube_class.h
ROWS = 350  # of a plant's tubes and of its blades and of a size of the balls, at most
TREES = 64
HELD_OUT = 7  # no divisor of the number of kinds


def draw_scenes():
    draw = random.Random(SEED)
    scenes = [draw_scene(draw, number, KINDS) for number in range(SCENES // 2)]
    return scenes + [draw_scene(draw, number, KINDS, FEW_POINTS) for number in range(SCENES // 2)]


def make_plant(program, folder, number, scene):
    kind, scanner, _, options = scene
    place = os.path.join(folder, f"{number:03d}")
    if not os.path.exists(os.path.join(place, "truth.json")):
        subprocess.run([program, "simulate", kind, "--scanner", scanner, "--seed", str(SEED + number), *options, "-q", "-o",
                        place], check=True)
    return next(os.path.join(place, name) for name in sorted(os.listdir(place)) if name.endswith(".labelled.ply"))


def read_tables(program, cloud):
    """A table for each size of the balls."""
    raw = subprocess.run([program, cloud], check=True, stdout=subprocess.PIPE, env={**os.environ, "OMP_NUM_THREADS": "1"}).stdout
    count = int(np.frombuffer(raw, "<u4", 1)[0])
    block = np.dtype([("count", "<u4"), ("rows", "<f4", (count, LABEL + 1))])
    if len(raw) != SIZES * block.itemsize:
        raise ValueError(f"{cloud}: a table of {len(raw)} bytes, {SIZES * block.itemsize} were expected")
    return np.frombuffer(raw, block, SIZES)["rows"]


def sparse_rows(table, random_order):
    """Rows of tubes and of blades with few points around, and the share of such in the plant."""
    table = table[random_order]
    few = table[:, COUNT] < SPARSE
    tubes = table[few & np.isin(table[:, LABEL], (STEM, PETIOLE))][:ROWS, :FEATURES]
    blades = table[few & (table[:, LABEL] == LEAF)][:ROWS, :FEATURES]
    return tubes, blades, few.mean()


def gather(simulate, table, folder):
    """For each plant its number and sparse_rows of each size of the balls."""
    def one(numbered):
        number, scene = numbered
        tables = read_tables(table, make_plant(simulate, folder, number, scene))
        order = np.random.default_rng(number).permutation(len(tables[0]))
        return number, [sparse_rows(one_size, order) for one_size in tables]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(one, enumerate(draw_scenes())))


def learn(plants):
    x, y, w = [], [], []
    for _, sizes in plants:
        for tubes, blades, share in sizes:
            for rows, is_tube in ((tubes, 1.0), (blades, 0.0)):
                x.append(rows)
                y.append(np.full(len(rows), is_tube))
                w.append(np.full(len(rows), share * ROWS / max(len(rows), 1)))
    return boosting.boost(np.concatenate(x), np.concatenate(y), np.concatenate(w), TREES)


def tree_score(bias, trees, x):
    score = np.full(len(x), bias)
    for splits, leaf in trees:
        feature, threshold = (np.array(column) for column in zip(*splits))
        node = np.zeros(len(x), int)
        for _ in range(boosting.DEPTH):
            node = 2 * node + 1 + (x[np.arange(len(x)), feature[node]] > threshold[node])
        score += leaf[node - len(splits)]
    return score


def report(bias, trees, plants):
    right = defaultdict(list)
    for number, sizes in plants:
        tubes, blades, share = sizes[0]
        if share > 0.5:
            shares = [np.mean((tree_score(bias, trees, rows) > 0) == is_tube)
                      for rows, is_tube in ((tubes, True), (blades, False)) if len(rows)]
            for group in (KINDS[number % len(KINDS)], "all"):
                right[group].append(np.mean(shares))
    for group, shares in sorted(right.items()):
        print(f"{group}: {len(shares)} plants, told right {np.mean(shares):.3f}", file=sys.stderr)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    plants = gather(*sys.argv[1:])
    bias, trees = learn([plant for plant in plants if plant[0] % HELD_OUT])
    report(bias, trees, plants[::HELD_OUT])
    boosting.write(bias, trees, "SPARSE_TUBE", "segment/tube_class.c", "train_tubes.py")


if __name__ == "__main__":
    main()
