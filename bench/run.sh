#!/bin/sh
# Runs the benchmarks of a build folder and prints one table: a row a goal, ratios of our figure to the rival's (the less
# the better). $1: folder of the benchmarks; $2: goals, as P1,P9 or all, or accuracy: errors and
# coverage of the traits over virtual plants, in $1/accuracy, or scenes: whether the organs are found in scenes drawn
# at random, in $1/scenes, or growth: time and memory of the stages from 1 k to 10 M points,
# in $1/growth; $3: CSV file to append to, or nothing.
set -eu
BENCH_COMMIT=$(git rev-parse --short HEAD 2>/dev/null || true)
export BENCH_COMMIT
if [ "$2" = accuracy ]; then
    exec python3 "$(dirname "$0")/accuracy/population.py" --program "$1/../plantimeter" -o "$1/accuracy"
fi
if [ "$2" = scenes ]; then
    exec python3 "$(dirname "$0")/accuracy/scenes.py" --program "$1/../plantimeter" -o "$1/scenes"
fi
if [ "$2" = growth ]; then
    exec python3 "$(dirname "$0")/growth.py" --program "$1/../plantimeter" -o "$1/growth"
fi
printf '%-4s %-44s %9s %-5s %-34s %9s  %6s  %5s  %s\n' goal what ours unit rival theirs ratio most met
for program in "$1"/bench_*; do
    [ -x "$program" ] || continue
    "$program" --only "$2" ${3:+--csv "$3"}
done
case ,$2, in
    *,P5,* | ,all,) sh "$(dirname "$0")/instructions.sh" "$1" ;;
esac
[ -z "${3:-}" ] || python3 "$(dirname "$0")/history.py" "$3"
