#!/usr/bin/python3
"""Learns the weights of the signs by which segment/frame.c tells which axis of a plant without ground is up.

    train_posture.py PLANTIMETER POSTURE_TABLE FOLDER [CLOUD...]

PLANTIMETER makes the virtual plants (into FOLDER, kept), POSTURE_TABLE (bench/) finds the signs that the library finds.
Each plant shows five wrong axes and z, the right one: the weights are those of a conditional logit, each kind of plant
with the same weight, and a ridge. Prints them, the signs named, and how many plants of each kind stand right: as they
are, and turned so that a wrong axis has the head start of z (the mean over the wrong axes). CLOUDs (z-up) are judged
likewise, not learnt.
"""
import os
import subprocess
import sys
from collections import defaultdict

import numpy as np

KINDS = "eggplant pepper okra cucumber soybean tomato maize arabidopsis bare_stem".split()
SCANS = {
    701: "--scanner rgbd --noise 0.5 --points 45000 --outliers 0.005",
    711: "--scanner rgbd --noise 0.8 --points 45000 --outliers 0.01 --views 8",
    721: "--scanner splat --noise 0.5 --points 45000",
    731: "--scanner splat --noise 0.3 --points 20000 --outliers 0.02",
    741: "--scanner dome --points 45000",
    751: "--scanner dome --points 8000",
    761: "--scanner uniform --noise 0.5 --points 8000 --outliers 0.005",
}
PLANTS = 4  # of each kind and scan
SIGNS = "detour top lines flat aside".split()  # in the order of segment/frame.h
Z, AXES, RIDGE, HEAD_START = 2, 6, 0.7, 3.0  # HEAD_START as segment/frame.c has it


def make_plants(program, folder):
    clouds = []
    for seed, options in SCANS.items():
        place = os.path.join(folder, str(seed))
        if not os.path.exists(os.path.join(place, "truth.json")):
            subprocess.run([program, "simulate", *KINDS, "-n", str(PLANTS), "--seed", str(seed), *options.split(), "-q",
                            "-o", place], check=True)
        clouds += sorted(os.path.join(place, name) for name in os.listdir(place)
                         if name.endswith(".ply") and not name.endswith((".labelled.ply", ".mesh.ply")))
    return clouds


def read_signs(program, clouds):
    lines = subprocess.run([program, *clouds], check=True, stdout=subprocess.PIPE, text=True).stdout.splitlines()
    rows = [line.rsplit(" ", AXES * len(SIGNS)) for line in lines]
    kinds = [os.path.basename(row[0]).split("_")[0] for row in rows]
    return np.array(kinds), np.array([row[1:] for row in rows], float).reshape(len(rows), AXES, len(SIGNS))


def odds(signs, weights):
    score = signs @ weights
    p = np.exp(score - score.max(1, keepdims=True))
    return p / p.sum(1, keepdims=True)


def learn(kinds, signs):
    scale = signs.reshape(-1, len(SIGNS)).std(0)
    x, weights = signs / scale, np.zeros(len(SIGNS))
    of_plant = np.array([1 / np.mean(kinds == kind) for kind in kinds])
    of_plant /= of_plant.mean()
    for _ in range(100):  # Newton's steps; the function is convex
        p = odds(x, weights)
        mean = np.einsum("na,nak->nk", p, x)
        spread = np.einsum("na,nak,nal->nkl", p, x, x) - np.einsum("nk,nl->nkl", mean, mean)
        slope = (of_plant[:, None] * (mean - x[:, Z])).sum(0) + 2 * RIDGE * weights
        curve = np.einsum("n,nkl->kl", of_plant, spread) + 2 * RIDGE * np.eye(len(SIGNS))
        weights -= np.linalg.solve(curve, slope)
    return weights / scale


def report(title, kinds, signs, weights):
    found = defaultdict(lambda: [0, 0, 0])
    score = signs @ weights
    wrong = np.delete(score, Z, 1)
    for kind, right, others in zip(kinds, score[:, Z], wrong):
        found[kind][0] += 1
        found[kind][1] += right + HEAD_START > others.max()
        found[kind][2] += np.mean([right > max(others.max(), other + HEAD_START) for other in others])
    print(f"{title}: kind, plants, right as they are, right when turned")
    for kind, (count, up, turned) in sorted(found.items()):
        print(f"  {kind:24}{count:5}{up:6.0f}{turned:8.1f}")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    kinds, signs = read_signs(sys.argv[2], make_plants(sys.argv[1], sys.argv[3]))
    weights = learn(kinds, signs)
    print("weights: " + ", ".join(f"{sign} {weight:.2f}" for sign, weight in zip(SIGNS, weights)))
    report("learnt", kinds, signs, weights)
    if sys.argv[4:]:
        report("others", *read_signs(sys.argv[2], sys.argv[4:]), weights)
