#!/usr/bin/python3
"""Draws the rows that `make bench BENCH_CSV=FILE` appended over time: a ratio to its rival against the commits.

    history.py FILE.csv        writes FILE.svg, with the gnuplot script and the numbers beside it

A line a row of the table (goal, what, rival): our figure over the rival's, in the order of the file; of several runs of one commit
on one day the median. The less the better; 1 is the rival.
"""
import csv
import os
import shutil
import statistics
import subprocess
import sys

FIELDS = ("day", "commit", "goal", "what", "rival", "ours", "theirs", "unit", "ratio", "most")


def read(path):
    """{row of the table: {commit: median ratio}}, and the commits in the order of the file."""
    found, commits = {}, []
    with open(path, newline="") as file:
        for number, values in enumerate(csv.reader(file), 1):
            if len(values) != len(FIELDS):
                raise SystemExit(f"{path}: line {number}: {len(values)} values, {len(FIELDS)} were expected")
            row = dict(zip(FIELDS, values))
            when = f"{row['day']} {row['commit']}".strip()
            if when not in commits:
                commits.append(when)
            found.setdefault(f"{row['goal']} {row['what']}, against {row['rival']}", {}).setdefault(when, []).append(float(row["ratio"]))
    return {name: {when: statistics.median(ratios) for when, ratios in of.items()} for name, of in found.items()}, commits


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        raise SystemExit(__doc__)
    rows, commits = read(sys.argv[1])
    stem = os.path.splitext(sys.argv[1])[0]
    with open(stem + ".history.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["commit", *rows])
        for when in commits:
            table.writerow([when, *(f"{rows[name][when]:.4g}" if when in rows[name] else "" for name in rows)])
    base = os.path.basename(stem)
    lines = ", ".join(f"'{base}.history.csv' using 0:{column}:xtic(1) with linespoints pt 7 ps 0.5 title columnheader({column})"
                      for column in range(2, len(rows) + 2))
    with open(stem + ".gp", "w") as script:
        script.write("set terminal svg size 1000,600 dynamic noenhanced\n" f"set output '{base}.svg'\n"
                     "set datafile separator ','\nset logscale y\nset grid\nset key below\nset xtics rotate by 45 right\n"
                     f"set ylabel 'our figure over that of the rival'\nplot {lines}, 1 with lines dt 2 lc 'black' title 'the rival'\n")
    if shutil.which("gnuplot"):
        subprocess.run(["gnuplot", base + ".gp"], cwd=os.path.dirname(os.path.abspath(stem)), check=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
