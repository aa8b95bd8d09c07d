#!/bin/sh
# A build without virtual plants and georeferencing: it compiles, measures, and says what it lacks. Usage: reduced.sh SOURCE
set -eu
source=$1
build=$source/build/reduced
cmake -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DPLANTIMETER_SIMULATE=OFF \
    -DPLANTIMETER_GEOREFERENCE=OFF >/dev/null
cmake --build "$build" --target plantimeter
program=$build/plantimeter
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
    echo "reduced build: $1"
    exit 1
}
"$program" --version | grep -qx 'left out of this build: simulate, georeference' || fail '--version does not say what is left out'
for command in simulate light study; do
    "$program" $command >"$work/printed" 2>&1 && fail "$command gives exit code 0"
    grep -q 'left out of this build' "$work/printed" || fail "$command does not say that it is left out"
done
if ldd "$program" | grep -qiE 'embree|geographic'; then fail 'the program still needs Embree or GeographicLib'; fi
"$program" measure "$source"/examples/data/eggplant.ply -t plant_height,leaf_count,absorbed_radiation -o "$work/out" -q ||
    fail 'it does not measure'
grep -q ',absorbed_radiation,,.*not_applicable' "$work/out/traits.csv" || fail 'absorbed_radiation is not not_applicable'
echo '10 50 0
10.00001 50 0
10 50.00001 1
10.00001 50.00001 1' >"$work/far.xyz"
"$program" measure "$work/far.xyz" --crs geodetic -t plant_height -o "$work/far" >"$work/printed" 2>&1 || true
cat "$work/printed" "$work"/far/traits.csv 2>/dev/null | grep -q 'left out of this build' || fail '--crs does not say that it is left out'
echo 'the reduced build says what it lacks'
