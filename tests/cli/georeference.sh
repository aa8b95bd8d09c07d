# UTM coordinates give the plant's place and the traits that it has at the origin; without --crs as well, to 1e-6.
. "$LIB/small_plant.sh"
small_plant local.csv
awk -F, 'NR == 1 { print; next } { printf "%.6f,%.6f,%.6f,%d,%d\n", $1 + 500000, $2 + 5400000, $3 + 120, $4, $5 }' \
    local.csv >utm.csv
measure() {
    plantimeter measure --labels label --traits plant_height,leaf_count,convex_hull_volume --up z --quiet --files tables "$@"
}
measure local.csv -o a
measure utm.csv -o b
measure utm.csv -o c --crs utm:32N
head -1 c/plants.csv
python3 - <<'PYTHON'
import csv
a, b, c = (next(csv.DictReader(open(f"{f}/plants.csv"))) for f in "abc")
for name in ("plant_height_mm", "convex_hull_volume_cm3", "leaf_count"):
    # The file has micrometres: a 1e-5 of a plant of 10 cm; UTM's scale differs from 1 by 4e-4 there.
    print(name, abs(float(b[name]) / float(a[name]) - 1) < 3e-5, abs(float(c[name]) / float(a[name]) - 1) < 2e-3)
print(round(float(c["longitude"]), 4), round(float(c["latitude"]), 4))
row = next(csv.DictReader(open("c/traits.csv")))
print([round(float(row[k]), 2) for k in "xyz"], round(float(row["longitude"]), 4))
PYTHON
plantimeter plan --crs utm:32N utm.csv | head -1
