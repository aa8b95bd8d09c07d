# Traits of plants that were seen in part, corrected by the curves of a study.
. "$LIB/small_plant.sh"
small_plant plant.csv
cp plant.csv other.csv
cat >curves.csv <<'EOF'
plant,trait,slope,residual_sd
tomato,plant_height,0,0
tomato,convex_hull_volume,0.5,0.01
maize,plant_height,0.25,0.02
EOF
measure() {
    plantimeter measure -q --labels label --traits plant_height,convex_hull_volume plant.csv other.csv -o out --files tables "$@"
    code=$?
    [ $code -eq 0 ] || echo "exit code $code"
}
echo 'a share for all, and the curves of one plant:'
measure --visibility-correction curves.csv:tomato --visible-share 0.8
cut -d, -f1,2,5 out/corrected.csv
# value / (1 + 0.5 (0.8 - 1)), and the error of the curve beside that of the value
awk -F, '$2 == "convex_hull_volume" {
    f = 0.9; e = sqrt(($4 / f) ^ 2 + ($3 * 0.01 / (f * f)) ^ 2)
    print (($6 - $3 / f) ^ 2 < 1e-12 * $6 ^ 2 && ($7 - e) ^ 2 < 1e-9 * e ^ 2) ? "as it should be" : $0
}
$2 == "plant_height" { print ($6 == $3 && $7 == $4) ? "height stays" : $0 }' out/corrected.csv
echo 'a share for each plant; the folder is measured already:'
printf 'plant_id,visible_share\nother,0.5\n' >shares.csv
measure --visibility-correction curves.csv:maize --visible-share shares.csv
awk -F, 'NR > 1 { print $1, $2, $5, ($6 / $3 - 1 / 0.875) ^ 2 < 1e-12 ? "higher by 1/0.875" : $6 / $3 }' out/corrected.csv
echo 'what cannot be:'
measure --visibility-correction curves.csv:tomato
measure --visibility-correction curves.csv --visible-share 0.8
measure --visibility-correction curves.csv:oak --visible-share 0.8
measure --visibility-correction curves.csv:maize --visible-share 1.2
measure --visibility-correction absent.csv --visible-share 0.5
printf 'plant_id,visible_share\nother,0\n' >shares.csv
measure --visibility-correction curves.csv:maize --visible-share shares.csv
measure --visibility-correction shares.csv --visible-share 0.5
