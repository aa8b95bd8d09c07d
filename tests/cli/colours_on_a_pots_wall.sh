# Eight patches of a pot's wall that have the plant's colour by chance were a ninth leaf, 193 mm below the soil: they lie on the wall.
plantimeter simulate -q -o plants --seed 57085 --arched --scanner dome --pot soybean
plantimeter measure -q -t leaf_count,plant_height -o out --files tables --views 0 plants/soybean_57085_clean_pot.ply
echo "exit code $?"
grep ',leaf_count,' out/traits.csv | cut -d, -f 1,2,7,8
awk -F, '$7 == "plant_height" { print ($8 > 409 && $8 < 411 ? "as tall as it was built" : "off: " $8) }' out/traits.csv
