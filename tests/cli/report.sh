# report: the page of a run made again, of a validation alone, of both; and what cannot be.
. "$LIB/small_plant.sh"
small_plant plant.csv
plantimeter measure plant.csv --labels label --traits plant_height,leaf_area,leaf_count --up z -o run -q || exit
ls run
printf 'plant_id,organ,organ_id,trait,value,unit\nplant,leaf,0,leaf_area,8,cm2\nplant,leaf,1,leaf_area,8,cm2\n' >manual.csv
plantimeter validate run/traits.csv manual.csv -o agreement -q || exit
plantimeter report run --validation agreement && grep -c 'Agreement with manual' run/report.html
plantimeter report agreement && grep -c 'Agreement with manual' agreement/report.html
plantimeter report run --plots -q && ls run/plots | grep -v -e svg -e png && cut -d' ' -f6- run/plots/overview.dat
echo 'what cannot be:'
plantimeter report || echo "exit code $?"
plantimeter report nowhere || echo "exit code $?"
plantimeter report run --validation run || echo "exit code $?"
plantimeter report run --views many || echo "exit code $?"
