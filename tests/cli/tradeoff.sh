# Error against run time: tables, fronts, competitors, and what cannot be.
. "$LIB/small_plant.sh"
tradeoff() {
    plantimeter tradeoff "$@"
    code=$?
    [ $code -eq 0 ] || echo "exit code $code"
}
# A program that answers as competitors do: one method knows heights, one falls over.
cat >rival <<'END'
#!/bin/sh
if [ "$1" = --list ]; then
    echo '{"method": "ruler", "setting": "plain", "traits": ["plant_height"]}'
    echo '{"method": "broken", "setting": "plain", "traits": ["plant_height"]}'
    exit 0
fi
[ "$2" = ruler ] || kill -SEGV $$
echo '{"trait": "plant_height", "organ_id": null, "value": 0.1, "seconds": 0.001, "peak_bytes": 1000000, "points": 500}'
END
chmod +x rival
tradeoff --simulate pepper --cloud-points 4000 --up z --traits plant_height,leaf_area --points 1000,2000,900000 \
    --repeats 1 --competitors ./rival -o virtual >printed
sed -n -e '1s/ *$//p' -e '$p' printed
grep -c 'plantimeter' printed
head -1 virtual/tradeoff.csv
cut -d, -f1-3,13,14,17 virtual/tradeoff.csv | tail -n +2
echo 'what failed:'
cut -d, -f1-4 virtual/failures.csv | sort -u
ls virtual/plants/dome/pepper_1_clean.truth.json virtual/tradeoff_plant_height.gp
# Errors are numbers; more points are not five times worse; every kind of labels has a front; runs have memory and time.
awk -F, 'NR > 1 && $15 > 0 {
    if ($5 == "" || $5 != $5 + 0 || $5 < 0) print "no error: " $0
    if (!($7 > 0) || !($8 > 0) || !($4 > 0)) print "no cost: " $0
    if ($18 == "yes") front[$1 " " $13]++
    all[$1 " " $13]++
    if ($3 ~ /^points=[0-9a]*l*$/) { error[$1 $2 $3] = $5 }
} END {
    for (k in all) if (!front[k]) print "no front: " k
    for (m = 1; m <= 2; m++) {
        at = "leaf_areaplantimeter" (m == 2 ? " --labels" : "") "points="
        if (!(error[at "all"] <= 5 * error[at "2000"] + 1)) print at ": more points are worse"
    }
    print "rows checked"
}' virtual/tradeoff.csv
echo 'an index, and one plant with its truth:'
tradeoff --truth virtual/plants/dome/truth.json --up z -t plant_height --quick --competitors none -q -o index
tradeoff virtual/plants/dome/pepper_1_clean.labelled.ply --truth virtual/plants/dome/pepper_1_clean.truth.json --up z \
    -t plant_height --quick --competitors none -q -o one
cut -d, -f1-5 index/tradeoff.csv >index.csv
cut -d, -f1-5 one/tradeoff.csv | cmp - index.csv && wc -l <index.csv
echo 'without truth:'
tradeoff virtual/plants/dome/pepper_1_clean.ply --up z -t boundary_share,total_leaf_area --points 2000 --repeats 1 \
    --competitors none -q -o alone
cut -d, -f1-3,13,17 alone/tradeoff.csv | tail -n +2
awk -F, '$3 == "points=all" && $13 == "own" && $5 != 0 { print "the finest setting differs from itself: " $0 }
    $3 == "points=all neighbours=8" && $5 != 0 { print "differs from itself: " $0 }
    NR > 1 && $1 == "total_leaf_area" && !($6 > 0) { print "no error bar: " $0 }' alone/tradeoff.csv
echo 'what cannot be:'
small_plant plant.csv
echo '{"plant": ' >cut.json
echo '{"plant": 3}' >empty.json
echo '{"cases": [{"plant_id": "a"}]}' >bare.json
echo '{"plant": {"plant_height": 0.1}, "organs": []}' >height.json
tradeoff
tradeoff plant.csv
tradeoff -o out
tradeoff plant.csv --simulate pepper -o out
tradeoff plant.csv plant.csv --truth height.json -o out
tradeoff plant.csv --truth nowhere.json -o out
tradeoff plant.csv --truth cut.json -o out
tradeoff plant.csv --truth empty.json -o out
tradeoff --truth bare.json -o out
tradeoff plant.csv --truth height.json -t leaf_area --competitors none -o out
tradeoff nowhere.ply -o out
tradeoff --simulate oak -q -o out
tradeoff --simulate pepper --noise much -o out
tradeoff plant.csv --target 2 -o out
tradeoff plant.csv --target leaf_area=2deg -o out
tradeoff plant.csv --target leaf_weight=2% -o out
tradeoff plant.csv --truth height.json --competitors ./nobody -o out
tradeoff plant.csv --truth height.json --competitors none --points 1000,many -o out
tradeoff plant.csv --truth height.json -t hight --competitors none -o out
