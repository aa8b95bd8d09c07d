#!/usr/bin/python3
"""How run time and memory of each stage grow with the number of points.

    growth.py --program PLANTIMETER -o OUT [--kind eggplant] [--most 10000000] [--least 1000] [--threads 1] [--repeats 1]

Scans one virtual plant at densities that give --least to --most points (`plantimeter simulate --scanner uniform`, three sizes a
decade), measures each (`measure --points`: all points are looked at) and reads the seconds and the memory of the stages
from run.json; of several repeats the least seconds count. Writes OUT/growth.csv (stage, points, seconds, peak_mib),
OUT/exponents.csv (stage, exponent, seconds and peak_mib at the most points) and, where gnuplot is, OUT/growth.svg with its
script. The exponent is the slope of log seconds over log points in the upper two decades, of sizes where the stage takes at least
20 ms; n log n has 1.07 there. Exit status 1 where an exponent is above 1.15.
"""
import argparse
import csv
import json
import math
import os
import shutil
import subprocess
import sys

MOST_EXPONENT = 1.15
LEAST_SECONDS = 0.02  # below, the clock and the start of threads are what is measured
DECADES = 2


def sizes(least, most):
    steps = round(3 * math.log10(most / least))
    return [round(least * (most / least) ** (i / steps)) for i in range(steps + 1)] if steps > 0 else [round(most)]


def stages_of(options, points, folder):
    clouds = os.path.join(folder, "clouds")
    shutil.rmtree(clouds, ignore_errors=True)
    subprocess.run([options.program, "simulate", options.kind, "--scanner", "uniform", "--points", str(points), "--seed", "3",
                    "-o", clouds, "-q"], check=True)
    cloud = next(name for name in sorted(os.listdir(clouds)) if name.endswith(".ply") and name.count(".") == 1)
    best = {}
    for _ in range(options.repeats):
        run = os.path.join(folder, "run")
        shutil.rmtree(run, ignore_errors=True)
        subprocess.run([options.program, "measure", os.path.join(clouds, cloud), "--points", str(2 * points), "--files", "tables",
                        "--threads", str(options.threads), "-o", run, "-q"], check=True)
        with open(os.path.join(run, "run.json")) as file:
            plant = json.load(file)["plants"][0]
        if plant["used_points"] < 0.8 * points:  # cleaning may drop a few
            raise SystemExit(f"{plant['used_points']} of {points} points were looked at")
        for stage in plant["plan"]:
            if stage["runs"]:
                found = (stage["seconds"], stage["peak_bytes"] / 2**20)
                best[stage["stage"]] = min(best.get(stage["stage"], found), found)
    shutil.rmtree(clouds)
    best["all"] = (sum(seconds for seconds, _ in best.values()), max(memory for _, memory in best.values()))
    return best


def exponent(rows, most):
    """Least squares of log seconds over log points; None where the stage is too quick for it."""
    use = [(math.log(n), math.log(s)) for n, s, _ in rows if n >= most / 10**DECADES * 0.99 and s >= LEAST_SECONDS]
    if len(use) < 3:
        return None
    x0, y0 = (sum(column) / len(use) for column in zip(*use))
    return sum((x - x0) * (y - y0) for x, y in use) / sum((x - x0) ** 2 for x, _ in use)


def plot(out, rows):
    lines = ", ".join(f"'growth.csv' using (strcol(1) eq '{stage}' ? $2 : NaN):3 with linespoints pt 7 ps 0.4 title '{stage}'"
                      for stage in rows)
    with open(os.path.join(out, "growth.gp"), "w") as script:
        script.write("set terminal svg size 800,600 dynamic\nset output 'growth.svg'\nset datafile separator ','\nset logscale xy\n"
                     "set key outside\nset grid\nset xlabel 'points'\nset ylabel 'seconds'\nset datafile missing NaN\n"
                     f"plot {lines}\n")
    if shutil.which("gnuplot"):
        subprocess.run(["gnuplot", "growth.gp"], cwd=out, check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--kind", default="eggplant")
    parser.add_argument("--least", type=float, default=1e3)
    parser.add_argument("--most", type=float, default=1e7)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeats", type=int, default=1)
    options = parser.parse_args()
    options.program = os.path.abspath(options.program)
    os.makedirs(options.output, exist_ok=True)
    rows = {}
    for points in sizes(options.least, options.most):
        for stage, (seconds, memory) in stages_of(options, points, options.output).items():
            rows.setdefault(stage, []).append((points, seconds, memory))
        print(f"{points:9} points {rows['all'][-1][1]:9.3f} s {rows['all'][-1][2]:8.0f} MiB", flush=True)
    with open(os.path.join(options.output, "growth.csv"), "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(("stage", "points", "seconds", "peak_mib"))
        for stage, found in rows.items():
            table.writerows((stage, n, f"{s:.6g}", f"{m:.1f}") for n, s, m in found)
    too_steep = []
    with open(os.path.join(options.output, "exponents.csv"), "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(("stage", "exponent", "seconds", "peak_mib"))
        for stage, found in rows.items():
            slope = exponent(found, options.most)
            shown = "" if slope is None else f"{slope:.2f}"
            table.writerow((stage, shown, f"{found[-1][1]:.4g}", f"{found[-1][2]:.0f}"))
            print(f"{stage:12} {shown or 'too quick':>9}  {found[-1][1]:9.3f} s")
            if slope is not None and slope > MOST_EXPONENT:
                too_steep.append(stage)
    plot(options.output, rows)
    for stage in too_steep:
        print(f"growth: {stage} grows faster than n log n", file=sys.stderr)
    return 1 if too_steep else 0


if __name__ == "__main__":
    sys.exit(main())
