#!/bin/sh
# Goal P5: instructions of the smoothness factor, 1e5 points and one thread, against FLANN's C API with leaves of 16. The
# same on every machine, so fit for CI. $1: folder of the benchmarks. Needs valgrind; without it the row is left out.
set -eu
command -v valgrind >/dev/null || { echo 'P5   left out: no valgrind' >&2; exit 0; }
instructions() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$1/bench_neighbours" --once "$2" 2>&1 |
        sed -n 's/.*Collected : \([0-9]*\).*/\1/p'
}
none=$(instructions "$1" none)
ours=$(instructions "$1" ours)
flann=$(instructions "$1" flann)
awk -v none="$none" -v ours="$ours" -v flann="$flann" 'BEGIN {
    ratio = (ours - none) / (flann - none)
    printf "%-4s %-44s %9.4g %-5s %-34s %9.4g  %6.3f  %5.3g  %s\n", "P5", "SF, 1e5 points in a box, instructions",
           (ours - none) / 1e6, "1e6", "FLANN C, leaf 16", (flann - none) / 1e6, ratio, 0.4, ratio <= 0.4 ? "yes" : "NO" }'
