#!/usr/bin/env python3
"""R2 and RMSE of a run against manual measurements, from the tables alone: how to read them in Python.

Usage: validate.py TRAITS.csv MANUAL.csv [AGREEMENT.csv]

Rows are paired by plant_id, organ, organ_id and trait; repeated manual readings count as their mean. With the agreement.csv
that `plantimeter validate` wrote of the same tables, its figures are compared with these: exit code 1 where they differ.
Python's own library is enough.
"""
import csv
import math
import sys

METRES = {"mm": (1, 1e-3), "cm": (1, 1e-2), "m": (1, 1), "mm2": (2, 1e-6), "cm2": (2, 1e-4), "m2": (2, 1),
          "mm3": (3, 1e-9), "cm3": (3, 1e-6), "m3": (3, 1)}


def convert(value, unit, wanted):
    """The value in the wanted unit; None where the two are not of one kind."""
    if unit == wanted:
        return value
    if METRES.get(unit, (0,))[0] != METRES.get(wanted, (-1,))[0]:
        return None
    return value * METRES[unit][1] / METRES[wanted][1]


def read(path):
    """{(plant, organ, organ_id, trait): [(value, unit), ...]} of the rows that hold a value."""
    values = {}
    with open(path, newline="", encoding="utf-8-sig") as file:
        for row in csv.DictReader(file):
            if not row.get("status", "ok").startswith("ok") or row["value"] in ("", "NA"):
                continue
            key = (row["plant_id"], row["organ"], row["organ_id"], row["trait"])
            values.setdefault(key, []).append((float(row["value"]), row["unit"]))
    return values


def agreement(pairs):
    """n, R2 = 1 - SSE/SST, RMSE of (estimate, manual) pairs."""
    mean = sum(m for _, m in pairs) / len(pairs)
    squared = sum((p - m) ** 2 for p, m in pairs)
    total = sum((m - mean) ** 2 for _, m in pairs)
    return len(pairs), 1 - squared / total if total > 0 else math.nan, math.sqrt(squared / len(pairs))


def main(traits, manual, written=None):
    estimates, readings = read(traits), read(manual)
    pairs = {}
    for key, repeats in readings.items():
        if key not in estimates:
            continue
        value, unit = estimates[key][0]
        converted = [convert(m, u, unit) for m, u in repeats]
        if None not in converted:
            pairs.setdefault(key[3], []).append((value, sum(converted) / len(converted)))
    found = {trait: agreement(of_trait) for trait, of_trait in sorted(pairs.items())}
    print("trait,n,r2,rmse")
    for trait, (n, r2, rmse) in found.items():
        print(f"{trait},{n},{r2:.6g},{rmse:.6g}")
    if not written:
        return 0
    differing = 0
    with open(written, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["group"] != "all" or row["statistic"] not in ("n", "r2", "rmse") or not row["value"]:
                continue
            if "azimuth" in row["trait"]:
                continue  # differences of azimuths go round the circle
            mine = found[row["trait"]][("n", "r2", "rmse").index(row["statistic"])]
            if not math.isclose(mine, float(row["value"]), rel_tol=1e-6, abs_tol=1e-7):
                print(f"{row['trait']}: {row['statistic']} is {row['value']} there and {mine:.9g} here", file=sys.stderr)
                differing += 1
    return 1 if differing else 0


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
