# The examples of README's "Everyday use" run as they stand, one after the other, on small plants by the names they use.
. "$LIB/small_plant.sh"
mkdir night
plantimeter simulate pepper --points 4000 --resolution 0.3 --seed 3 -q -o made
cp made/pepper_3_clean.ply cloud.ply
cp cloud.ply night/
# What a user has of his own: readings of the same plant and organs.
plantimeter measure night/*.ply -o own -q
printf "plant_id,variety\ncloud,bell\n" >plants_in_field.csv
cp -r own last_week
printf "run,date\nlast_week,2026-05-02\nresults,2026-05-09\n" >dates.csv
awk -F, 'NR == 1 { print "plant_id,organ,organ_id,trait,value,unit" }
    $7 == "leaf_area" && $8 != "" { print $1 "," $2 "," $3 "," $7 "," $8 * 1.02 "," $9 }' own/traits.csv >manual.csv
# Fewer plants, rays and steps than the README's; else what a test does would take a night.
sed -n '/^## Everyday use/,/^Each command/s/^    \(plantimeter .*\)/\1/p' "$EXAMPLES/../../README.md" |
    sed -e 's/ *#.*//' -e 's/-n 10/-n 1 --points 3000 --resolution 0.2/' -e 's/^plantimeter light.*/& --rays 2000/' \
        -e 's/^plantimeter selftest/& --only hulls/' \
        -e 's/^plantimeter tradeoff.*/& --quick --cloud-points 3000 --up z --traits plant_height --competitors none/' -e 's/500ms/1min/' -e 's/leaf_area=2%/leaf_area=60%/' -e 's/--max-loss 30/--max-loss 2 --density 0.003 --rays 1000 --scenarios random/' >examples
while read -r line; do
    sh -c "$line" >printed 2>messages || { echo "exit $?: $line"; cat messages; }
    [ -s printed ] || echo "nothing printed: $line"
done <examples
[ "$(wc -l <examples)" -ge 8 ] && echo 'the examples ran'
