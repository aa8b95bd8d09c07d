#!/usr/bin/python3
"""The seedling paper's trial on virtual plants: 20 plants of seven varieties, manual-like readings, its table and its Figure 14.

    trial.py PROGRAM FOLDER [--seed N] [--pot] [--doc FILE] [--no-measure]

Simulates (three eggplants x 4, two peppers x 2, okra x 2, cucumber x 2; twelve depth views with 0.5 mm noise), measures
at default options, makes the manual table (below), pairs by centroids, and writes FOLDER/trial.md (ours beside the paper's),
FOLDER/trial.csv and FOLDER/figure14.svg and .png. --doc writes the table into a page too.

Manual readings are the truth with the errors of the paper's tools: height by ruler (SD 1 mm); angles on a wall grid, the mean of
five readings (SD 1 degree each); leaf area flattened and photographed (SD 2 %); diameters by calliper, the mean of five (SD 0.05 mm
each). As in the paper: height of 20 plants, area and inclination of 43 leaves, inclination of 38 petioles, 46 diameters (20 main
stems, 26 petioles; ours of petioles is taken half way, which the truth is too). Leaves and petioles are drawn at random from those
that the cameras see to at least a half; how many of these the program did not find is told.
"""
import argparse
import csv
import json
import math
import os
import random
import subprocess
import sys

import numpy as np
from scipy.optimize import linear_sum_assignment

KINDS = [("eggplant", 12), ("pepper", 4), ("okra", 2), ("cucumber", 2)]
SCAN = ["--scanner", "rgbd", "--noise", "0.5", "--points", "45000", "--outliers", "0.005"]
NEAR = 0.03  # metres between the centroids of one organ at most
# trait: (how many, name in the paper, (R2, RMSE, rRMSE %, MAPE %) there, unit)
PAPER = {
    "plant_height": (20, "plant height", (0.98, 2.3, 1.52, 1.32), "mm"),
    "petiole_inclination": (38, "petiole inclination", (0.99, 0.73, 1.41, 1.97), "deg"),
    "leaf_area": (43, "leaf area", (0.66, 1.05, 7.63, 7.16), "cm2"),
    "leaf_inclination": (43, "leaf inclination", (0.99, 1.01, 1.72, 2.12), "deg"),
    "stem_diameter": (46, "stem diameter", (0.95, 0.12, 5.43, 4.68), "mm"),
}


def run(*command):
    subprocess.run(command, check=True)


def truths(folder):
    """{plant: truth} of all plants, the file's name as the plant's."""
    found = {}
    for name in sorted(os.listdir(folder)):
        if name.endswith(".truth.json"):
            with open(os.path.join(folder, name)) as file:
                found[name[:-len(".truth.json")]] = json.load(file)
    return found


def estimates(path):
    """Rows of traits.csv, and centroids {(plant, organ): {id: xyz}}."""
    with open(path) as file:
        rows = list(csv.DictReader(file))
    centroids = {}
    for row in rows:
        if row["organ_id"] and row["x"]:
            place = [float(row[c]) for c in "xyz"]
            centroids.setdefault((row["plant_id"], row["organ"]), {})[row["organ_id"]] = place
    return rows, centroids


def pair(truth, centroids, plant, organ):
    """[(organ of the truth, our number or None)]: one-to-one, least total distance, at most NEAR apart."""
    mine = [o for o in truth["organs"] if o["organ"] == organ]
    theirs = centroids.get((plant, organ), {})
    if not mine or not theirs:
        return [(o, None) for o in mine]
    ids = list(theirs)
    place = np.array([o["centroid_in_file"] for o in mine])
    distance = np.linalg.norm(place[:, None, :] - np.array([theirs[i] for i in ids])[None, :, :], axis=2)
    partner = dict(zip(*linear_sum_assignment(np.minimum(distance, 2 * NEAR))))
    return [(o, ids[partner[k]] if k in partner and distance[k, partner[k]] <= NEAR else None) for k, o in enumerate(mine)]


def readings(generator, value, sd, repeats, step):
    return [round(generator.gauss(value, sd) / step) * step for _ in range(repeats)]


def make_manual(folder, seed):
    """Writes manual.csv and estimates.csv (petioles' diameters under the stem's name); gives what was not found."""
    generator = random.Random(seed)
    rows, centroids = estimates(os.path.join(folder, "run", "traits.csv"))
    manual, missed, seen = [], {}, {}
    leaves, petioles = [], []
    for plant, truth in truths(os.path.join(folder, "plants")).items():
        height = truth["plant"]["plant_height"] * 1e3
        manual.append((plant, "plant", "", "plant_height", readings(generator, height, 1, 1, 1), "mm"))
        for organ, kept in (("leaf", leaves), ("petiole", petioles)):
            for o, number in pair(truth, centroids, plant, organ):
                if o["visible_fraction"] < 0.5:
                    continue
                seen[organ] = seen.get(organ, 0) + 1
                if number is None:
                    missed[organ] = missed.get(organ, 0) + 1
                else:
                    kept.append((plant, number, o))
        stems = [(o, n) for o, n in pair(truth, centroids, plant, "stem") if o.get("organ_id") == 0]
        for o, number in stems or []:
            diameter = readings(generator, o["stem_diameter"] * 1e3, 0.05, 5, 0.02)
            manual.append((plant, "stem", "0" if number is None else number, "stem_diameter", diameter, "mm"))
    for plant, number, o in generator.sample(leaves, PAPER["leaf_area"][0]):
        manual.append((plant, "leaf", number, "leaf_area", [o["leaf_area"] * 1e4 * generator.gauss(1, 0.02)], "cm2"))
        manual.append((plant, "leaf", number, "leaf_inclination", readings(generator, o["leaf_inclination"], 1, 5, 0.5), "deg"))
    for plant, number, o in generator.sample(petioles, PAPER["petiole_inclination"][0]):
        manual.append((plant, "petiole", number, "petiole_inclination",
                       readings(generator, o["petiole_inclination"], 1, 5, 0.5), "deg"))
    for plant, number, o in generator.sample(petioles, PAPER["stem_diameter"][0] - 20):
        manual.append((plant, "petiole", number, "stem_diameter",
                       readings(generator, o["petiole_diameter"] * 1e3, 0.05, 5, 0.02), "mm"))
    with open(os.path.join(folder, "manual.csv"), "w") as file:
        print("plant_id,organ,organ_id,trait,value,unit", file=file)
        for plant, organ, number, trait, values, unit in manual:
            for value in values:
                print(f"{plant},{organ},{number},{trait},{value:.6g},{unit}", file=file)
    with open(os.path.join(folder, "estimates.csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        for row in rows:
            if row["trait"] == "petiole_diameter":
                row["trait"] = "stem_diameter"
            writer.writerow(row)
    return missed, seen


def agreement(folder):
    with open(os.path.join(folder, "agreement", "agreement.csv")) as file:
        return {(r["trait"], r["statistic"]): r for r in csv.DictReader(file) if r["group"] == "all"}


def interval(row, digits):
    if not row["ci_low"]:
        return ""
    return f" ({float(row['ci_low']):.{digits}f} to {float(row['ci_high']):.{digits}f})"


def main_stems(folder):
    """The diameters of main stems alone: n, R2, RMSE, rRMSE, MAPE, bias."""
    with open(os.path.join(folder, "agreement", "pairs.csv")) as file:
        rows = [r for r in csv.DictReader(file) if r["trait"] == "stem_diameter" and r["organ"] == "stem"]
    p, m = (np.array([float(r[side]) for r in rows]) for side in ("estimate", "manual"))
    rmse = math.sqrt(np.mean((p - m) ** 2))
    return (len(rows), 1 - np.sum((p - m) ** 2) / np.sum((m - m.mean()) ** 2), rmse, rmse / m.mean() * 100,
            np.mean(np.abs(p - m) / m) * 100, np.mean(p - m))


def write_table(folder, missed, seen):
    found = agreement(folder)
    lines = ["| trait | n | R2 (95 % interval) | RMSE | rRMSE % | MAPE % | bias | R2, paper | RMSE, paper | rRMSE %, paper | MAPE %, paper |",
             "|---|---:|---|---:|---:|---:|---:|---:|---:|---:|---:|"]
    with open(os.path.join(folder, "trial.csv"), "w") as file:
        print("trait,n,r2,rmse,rrmse,mape,bias,unit,paper_n,paper_r2,paper_rmse,paper_rrmse,paper_mape", file=file)
        for trait, (n, name, paper, unit) in PAPER.items():
            mine = [float(found[trait, s]["value"]) for s in ("r2", "rmse", "rrmse", "mape", "bias")]
            count = found[trait, "n"]["value"]
            print(",".join([trait, count] + [f"{v:.6g}" for v in mine] + [unit, str(n)] + [str(p) for p in paper]), file=file)
            r2 = f"{mine[0]:.3f}" + interval(found[trait, "r2"], 3)
            lines.append(f"| {name} | {count} | {r2} | {mine[1]:.2f} {unit} | {mine[2]:.2f} | {mine[3]:.2f} | {mine[4]:+.2f} | "
                         f"{paper[0]} | {paper[1]} {unit} | {paper[2]} | {paper[3]} |")
    n, *of_stems = main_stems(folder)
    lines.append("| of these, main stems | {} | {:.3f} | {:.2f} mm | {:.2f} | {:.2f} | {:+.2f} | | | | |".format(n, *of_stems))
    told = ", ".join(f"{missed.get(organ, 0)} of {seen[organ]} {plural}" for organ, plural in
                     (("leaf", "leaves"), ("petiole", "petioles")))
    lines += ["", f"Not found by the program, of what the cameras see to at least a half: {told}."]
    text = "\n".join(lines) + "\n"
    with open(os.path.join(folder, "trial.md"), "w") as file:
        file.write(text)
    return text


def draw(folder):
    """Estimate against manual, a panel a trait, as the paper's Figure 14; from validate's data files."""
    found = agreement(folder)
    script = ["set datafile separator whitespace", "unset key", "set grid lc rgb '#dddddd'", "set border lc rgb '#444444'",
              "set style line 1 lc rgb '#0072b2' pt 7 ps 0.6", "set style line 2 lc rgb '#d55e00' lw 2",
              "set style line 3 lc rgb '#777777' dt 2"]
    terminals = {"svg": "svg size 1200,800 enhanced font 'sans,13' background '#ffffff'",
                 "png": "pngcairo size 2400,1600 enhanced font 'sans,13' fontscale 2 linewidth 2 pointscale 2"}
    for ending, terminal in terminals.items():
        script += [f"set terminal {terminal}", f"set output 'figure14.{ending}'", "set multiplot layout 2,3"]
        for letter, (trait, (_, name, _, unit)) in zip("abcde", PAPER.items()):
            value = {s: float(found[trait, s]["value"]) for s in ("n", "r2", "rmse", "rrmse", "mape", "ols_slope", "ols_intercept")}
            facts = (f"n = {value['n']:.0f}\\nR^2 = {value['r2']:.3f}\\nRMSE = {value['rmse']:.3g} {unit}\\n"
                     f"rRMSE = {value['rrmse']:.2f} %\\nMAPE = {value['mape']:.2f} %")
            script += [f"set title '({letter}) {name}'", f"set xlabel 'manual [{unit}]'", f"set ylabel 'estimate [{unit}]'",
                       f'set label 1 "{facts}" at graph 0.04,0.94 left front',
                       f"plot x w l ls 3, {value['ols_slope']}*x+({value['ols_intercept']}) w l ls 2, "
                       f"'agreement/plots/{trait}.dat' u 1:2 w p ls 1"]
        script += ["unset multiplot", "unset output"]
    with open(os.path.join(folder, "figure14.gp"), "w") as file:
        file.write("\n".join(script) + "\n")
    subprocess.run(["gnuplot", "figure14.gp"], cwd=folder, check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--doc", help="replace the table between the marks <!-- trial --> of this page")
    parser.add_argument("--pot", action="store_true", help="stand the plants in pots; the paper's masks leave pots out")
    parser.add_argument("--no-measure", action="store_true", help="take the plants and the run that are there")
    options = parser.parse_args()
    program, folder = os.path.abspath(options.program), options.folder
    plants = os.path.join(folder, "plants")
    if not options.no_measure:
        os.makedirs(plants, exist_ok=True)
        for kind, count in KINDS:
            run(program, "simulate", kind, "-n", str(count), "--seed", str(options.seed), *SCAN, *["--pot"] * options.pot, "-q", "-o",
                plants)
        clouds = [os.path.join(plants, plant + ".ply") for plant in truths(plants)]
        run(program, "measure", *clouds, "-o", os.path.join(folder, "run"), "-q", "--files", "tables", "--force")
    missed, seen = make_manual(folder, options.seed)
    run(program, "validate", os.path.join(folder, "estimates.csv"), os.path.join(folder, "manual.csv"), "-o",
        os.path.join(folder, "agreement"), "--plots", "-q")
    text = write_table(folder, missed, seen)
    draw(folder)
    sys.stdout.write(text)
    if options.doc:
        with open(options.doc) as file:
            before, _, after = file.read().split("<!-- trial -->\n")
        with open(options.doc, "w") as file:
            file.write(f"{before}<!-- trial -->\n{text}<!-- trial -->\n{after}")


if __name__ == "__main__":
    main()
