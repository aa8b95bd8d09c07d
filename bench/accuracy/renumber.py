#!/usr/bin/python3
"""Gives a manual table the organ numbers of a run: organs are paired by the centroids of the truth (trial.py's rule).

    renumber.py TRAITS.csv MANUAL.csv TRUTH_FOLDER >RENUMBERED.csv

MANUAL's organ_id are those of TRUTH_FOLDER/PLANT.truth.json. Readings of organs that the run does not have are left out, and
counted on standard error.
"""
import csv
import sys

from trial import estimates, pair, truths


def main(traits, manual, folder):
    _, centroids = estimates(traits)
    number = {}
    for plant, truth in truths(folder).items():
        for organ in ("leaf", "petiole", "stem"):
            for o, mine in pair(truth, centroids, plant, organ):
                number[plant, organ, str(o["organ_id"])] = mine
    lost = 0
    with open(manual) as file:
        rows = list(csv.DictReader(file))
    writer = csv.DictWriter(sys.stdout, rows[0].keys(), lineterminator="\n")
    writer.writeheader()
    for row in rows:
        if row["organ_id"]:
            row["organ_id"] = number.get((row["plant_id"], row["organ"], row["organ_id"]))
        if row["organ_id"] is None:
            lost += 1
        else:
            writer.writerow(row)
    print(f"{lost} of {len(rows)} readings are of organs that the run does not have", file=sys.stderr)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
