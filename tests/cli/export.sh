# export: what is written, and what cannot be.
. "$LIB/small_plant.sh"
small_plant plant.csv
plantimeter measure plant.csv --labels label --traits plant_height,leaf_area,leaf_count --up z -o run --files tables -q || exit
plantimeter export run -o out --time 2026-05-02T09:30:00Z
for folder in out/*; do ls $folder; done
cat out/fieldbook/traits.trt
cut -d, -f1-7 out/statgen/timepoints.csv
plantimeter export --mapping | head -2
echo 'what cannot be:'
plantimeter export run || echo "exit code $?"
plantimeter export nowhere -o out || echo "exit code $?"
plantimeter export run -o out --format breedbase || echo "exit code $?"
echo 'name,row' >meta.csv
plantimeter export run -o out --metadata meta.csv || echo "exit code $?"
printf 'trait,variable_id\nplant_height,x\nleaf_count,x\n' >twice.csv
plantimeter export run -o out --ontology twice.csv || echo "exit code $?"
