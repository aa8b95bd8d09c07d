#!/usr/bin/python3
"""Which wrong labels cost what: leaves measured with the true labels, the program's own, and mixtures of both.

    label_errors.py --program PLANTIMETER -o OUT RUN FOLDER [--kinds A,B,...] [--most MAPE]

RUN is what `plantimeter measure` wrote of the plants in FOLDER (by `plantimeter simulate`). Leaves of the run take the numbers
of the true ones that they match. Prints bias and MAPE of leaf area, RMSE and median of leaf inclination for
    true      the true labels
    own       the program's
    ghosts    true labels, but points of nothing (ghosts, floaters) as the program has them
    no_ghosts the program's labels, but points of nothing left out
    tubes     the program's labels, but right where either has stem or petiole
    leaves    the program's labels, but each leaf point with its true leaf
--most: exit status 1 if the MAPE of leaf area is above this many per cent in any of them, or no leaf was measured.
"""
import argparse
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
try:
    import numpy as np

    import score
    from population import measure, read_index, read_truth
except ImportError as problem:  # a machine without numpy skips the test
    print(f"skipped: {problem}")
    sys.exit(77)

OTHER, STEM, PETIOLE, LEAF = 0, 1, 2, 3
UNMATCHED = 1000  # numbers of found leaves that match no true one begin here
PLY_NAMES = {np.dtype(kind): name for name, kind in score.PLY_TYPES.items()}


def write_ply(path, cloud):
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(cloud)}"]
    header += [f"property {PLY_NAMES[cloud.dtype[name]]} {name}" for name in cloud.dtype.names]
    with open(path, "wb") as file:
        file.write(("\n".join(header) + "\nend_header\n").encode())
        file.write(cloud.tobytes())


def renumber(truth, found):
    """Labels and organs of the run, in the numbers of the true leaves."""
    true_of = {f: t for t, f in score.match_leaves(truth, found)[0].items()}
    label, organ = found["label"].copy(), found["organ"].copy()
    for number in np.unique(organ[np.isin(label, (PETIOLE, LEAF))]):
        mine = np.isin(label, (PETIOLE, LEAF)) & (found["organ"] == number)
        organ[mine] = true_of.get(int(number), UNMATCHED + int(number))
    return label, organ


def mixtures(truth, found):
    """Name, labels and organs of each mixture."""
    own = renumber(truth, found)
    true = truth["label"], truth["organ"]
    nothing = true[0] == OTHER
    tubes = np.isin(true[0], (STEM, PETIOLE)) | (np.isin(own[0], (STEM, PETIOLE)) & ~nothing)
    leaves = (own[0] == LEAF) & (true[0] == LEAF)
    yield "true", *true
    yield "own", *own
    yield "ghosts", *(np.where(nothing, o, t) for o, t in zip(own, true))
    yield "no_ghosts", *(np.where(nothing, t, o) for o, t in zip(own, true))
    yield "tubes", *(np.where(tubes, t, o) for o, t in zip(own, true))
    yield "leaves", *(np.where(leaves, t, o) for o, t in zip(own, true))


def write_mixtures(cases, options):
    """The clouds of each mixture: a list of files by its name."""
    files = {}
    for case in cases:
        truth, found = score.read_labels(case, options.run, options.folder)
        for name, label, organ in mixtures(truth, found):
            place = os.path.join(options.out, name)
            os.makedirs(place, exist_ok=True)
            cloud = truth.copy()
            cloud["label"], cloud["organ"] = label, organ
            files.setdefault(name, []).append(os.path.join(place, case["plant_id"] + ".ply"))
            write_ply(files[name][-1], cloud)
    return files


def errors(cases, run, options):
    """Relative errors of area and errors of inclination in degrees, of the leaves that have both."""
    rows, area, inclination = score.read_traits(run), [], []
    for case in cases:
        for organ in read_truth(options.folder, case)["organs"]:
            if organ["organ"] != "leaf":
                continue
            key = "leaf", str(organ["organ_id"])
            row = [rows[case["plant_id"]].get((*key, trait)) for trait in ("leaf_area", "leaf_inclination")]
            if not all(r and r["value"] for r in row):
                continue
            area.append(float(row[0]["value"]) * score.FACTOR[row[0]["unit"]] / organ["leaf_area"] - 1)
            inclination.append(float(row[1]["value"]) * score.FACTOR[row[1]["unit"]] - organ["leaf_inclination"])
    return np.array(area), np.array(inclination)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("-o", "--out", required=True)
    parser.add_argument("run")
    parser.add_argument("folder")
    parser.add_argument("--kinds", default="")
    parser.add_argument("--most", type=float, default=float("inf"))
    options = parser.parse_args()
    worst = 0.0
    cases = [case for case in read_index(options.folder)
             if not options.kinds or read_truth(options.folder, case)["kind"] in options.kinds.split(",")]
    for name, files in write_mixtures(cases, options).items():
        run = os.path.join(options.out, name, "run")
        measure(options.program, files, run, ["--labels", "label", "-t", "leaf_area,leaf_inclination"])
        area, inclination = errors(cases, run, options)
        if not len(area):
            sys.exit(f"{name}: no leaf was measured")
        worst = max(worst, 100 * np.abs(area).mean())
        print(f"{name:10} n {len(area):4}  area: bias {100 * area.mean():6.2f} %, MAPE {100 * np.abs(area).mean():5.2f} %"
              f"  inclination: RMSE {np.sqrt(np.mean(inclination ** 2)):5.2f}, median {np.median(np.abs(inclination)):.2f} deg")
    return 1 if worst > options.most else 0


if __name__ == "__main__":
    sys.exit(main())
