#!/usr/bin/python3
"""Whether reported standard errors hold what looking at few of the points costs.

    subsamples.py PROGRAM CLOUD.ply... [--points 5000,20000] [--repeats 8] [--folder DIR]

Draws random subsamples of each cloud (binary PLY), measures each as a cloud of its own, and compares with the whole cloud: for
each trait the scatter of the values over the subsamples beside the mean reported standard error, and the share of subsamples
whose 95 % interval holds the value of the whole cloud. Organs are matched by their centroids.
"""
import argparse
import csv
import os
import subprocess
import tempfile
from collections import defaultdict

import numpy as np

from score import PLY_TYPES

TRAITS = ["plant_height", "plant_width", "pca1", "convex_hull_volume", "projected_area", "total_leaf_area", "leaf_area",
          "leaf_inclination", "leaf_length", "petiole_inclination", "petiole_length", "stem_diameter", "stem_length"]


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    lines = data[:end].decode().split("\n")
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
    fields = [(line.split()[2], PLY_TYPES[line.split()[1]]) for line in lines if line.startswith("property")]
    return lines, np.frombuffer(data, np.dtype(fields), count, end)


def write(path, lines, rows):
    with open(path, "wb") as file:
        file.write("\n".join("element vertex %d" % len(rows) if line.startswith("element vertex") else line
                             for line in lines).encode())
        file.write(rows.tobytes())


def measure(program, clouds, out):
    subprocess.run([program, "measure", *clouds, "-o", out, "--effort", "precise", "--files", "tables", "-q"],
                   check=False, stderr=subprocess.DEVNULL)
    values = defaultdict(list)
    with open(os.path.join(out, "traits.csv")) as file:
        for row in csv.DictReader(file):
            if row["trait"] in TRAITS and row["status"].startswith("ok") and row["std_error"]:
                place = np.array([float(row[axis] or "nan") for axis in "xyz"])
                values[row["plant_id"], row["trait"]].append((place, float(row["value"]), float(row["std_error"])))
    return values


def nearest(rows, place, reach):
    """The row whose organ lies nearest; None beyond reach."""
    best = min(rows, key=lambda row: np.linalg.norm(row[0] - place), default=None)
    return best if best and np.linalg.norm(best[0] - place) <= reach else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("clouds", nargs="+")
    parser.add_argument("--points", default="5000,20000")
    parser.add_argument("--repeats", type=int, default=8)
    parser.add_argument("--folder")
    options = parser.parse_args()
    folder = options.folder or tempfile.mkdtemp()
    os.makedirs(folder, exist_ok=True)
    generator = np.random.default_rng(1)
    print("points,trait,cases,scatter/std_error,rms_difference/std_error,covered")
    wholes = measure(options.program, options.clouds, os.path.join(folder, "whole"))
    for points in (int(word) for word in options.points.split(",")):
        parts = []
        for path in options.clouds:
            lines, rows = read(path)
            name = os.path.splitext(os.path.basename(path))[0]
            for repeat in range(options.repeats):
                chosen = generator.permutation(len(rows))[:points]
                parts.append(os.path.join(folder, "%s.%d.%d.ply" % (name, points, repeat)))
                write(parts[-1], lines, rows[np.sort(chosen)])
        found = measure(options.program, parts, os.path.join(folder, "parts%d" % points))
        for trait in TRAITS:
            ratios, differences, covered = [], [], []
            for path in options.clouds:
                name = os.path.splitext(os.path.basename(path))[0]
                for place, value, own_error in wholes[name, trait]:
                    mine = [nearest(found["%s.%d.%d" % (name, points, repeat), trait], place, 0.01)
                            for repeat in range(options.repeats)]
                    mine = [row for row in mine if row]
                    if len(mine) < options.repeats / 2:
                        continue
                    values, errors = np.array([row[1] for row in mine]), np.array([row[2] for row in mine])
                    ratios.append(np.std(values, ddof=1) / np.mean(errors))
                    differences += list((values - value) ** 2 / errors ** 2)
                    covered += list(np.abs(values - value) <= 1.96 * errors)
            if ratios:
                print("%d,%s,%d,%.2f,%.2f,%.2f" % (points, trait, len(ratios), np.median(ratios),
                                                   np.sqrt(np.median(differences) / 0.455), np.mean(covered)), flush=True)


if __name__ == "__main__":
    main()
