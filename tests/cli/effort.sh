# Large clouds are thinned: by effort, or to the number asked for. All rows are labelled all the same, and keep their own labels.
. "$LIB/small_plant.sh"
plantimeter simulate pepper --points 60000 --resolution 0.5 --seed 5 -q -o made
plant=pepper_5_clean
for effort in fast balanced; do
    plantimeter measure made/$plant.ply -o $effort --effort $effort -q
    sed -n 's/.*"used_points": \([0-9]*\).*/\1/p' $effort/run.json |
        awk -v effort=$effort '{ print effort, ($1 >= 60000 ? "all" : $1 > 48000 && $1 < 52000 ? "thinned" : $1) }'
    sed -n 's/^element vertex //p' $effort/$plant.labelled.ply | awk '{ print "labelled rows", ($1 >= 60000 ? "all" : $1) }'
done
# The fit behind a value: its steps, its condition and why it ended.
tr -d ' \n' <balanced/run.json | grep -o '{"trait":"stem_diameter","organ_id":0,"steps":[1-9][0-9]*,"condition":[0-9.]*,"end":"[a-z]*"}' |
    sed 's/"steps":[0-9]*,"condition":[0-9.]*/"steps":S,"condition":C/; s/"small\(gain\|step\)"/"small"/'
# What half of the points give is what all give, nearly.
paste -d, fast/plants.csv balanced/plants.csv | awk -F, '
    NR == 1 { n = NF / 2; for (i = 1; i <= n; i++) name[i] = $i }
    NR == 2 {
        for (i = 1; i <= n; i++)
            if (name[i] ~ /^(plant_height_mm|total_leaf_area_cm2|convex_hull_volume_cm3)$/) {
                ratio = $i / $(i + n)
                print name[i], (ratio > 0.98 && ratio < 1.02 ? "agrees" : ratio)
            }
    }'
small_plant plant.csv 1 3
for repeat in 1 2 3; do tail -n +2 plant.csv | awk -F, -v r=$repeat '{ printf "%.7g,%s,%s,%s,%s\n", $1 + r * 1e-5, $2, $3, $4, $5 }'; done >more.csv
cat more.csv >>plant.csv
plantimeter measure plant.csv --unit m --labels label --points 1500 -o own -q
sed -n 's/.*"points": \([0-9]*\).*/\1 points/p' own/run.json
sed -n 's/.*"used_points": \([0-9]*\).*/\1/p' own/run.json | awk '{ print ($1 > 1350 && $1 < 1650 ? "thinned" : $1) }'
plantimeter measure own/plant.labelled.ply --labels label --points 100000 -o again -q # the same labels
grep -c ',stem,\|,leaf,' own/traits.csv again/traits.csv
plantimeter measure plant.csv --unit m --labels label --points 12 -o own
