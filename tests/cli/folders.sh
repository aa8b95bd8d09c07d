# Every command makes the folder that it writes into, and those above it.
. "$LIB/small_plant.sh"
small_plant plant.csv
plantimeter measure -q --labels label --traits plant_height plant.csv -o a/measure/out && ls a/measure/out/traits.csv
plantimeter simulate -q bare_stem --resolution 0.1 --points 50 -o a/simulate/out && ls a/simulate/out/truth.json
plantimeter light -q --rays 1000 a/simulate/out/*.mesh.ply -o a/light/out && ls a/light/out/light.csv
plantimeter study thinning --plants arabidopsis --scenarios random --max-loss 2 --rays 100 --density 0.001 -o a/study/out |
    sed 's/ [a-z]*: .*//' && ls a/study/out/table1.csv
printf 'plant_id,organ,organ_id,trait,value,unit\nplant,plant,,plant_height,300,mm\n' >manual.csv
plantimeter validate a/measure/out/traits.csv manual.csv -o a/validate/out >/dev/null && ls a/validate/out | head -1
plantimeter compare a/measure/out/traits.csv a/measure/out/traits.csv -o a/compare/out >/dev/null && ls a/compare/out | head -1
echo 'a file in the way:'
echo 'a file' >file
for command in 'simulate bare_stem' 'light a/simulate/out/bare_stem_1_clean.mesh.ply' 'study thinning' \
    'validate a/measure/out/traits.csv manual.csv'; do
    plantimeter $command -o file/out
    echo "exit code $?"
done
