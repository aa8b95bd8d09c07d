# series: three plants over six days with known growth; one reading is wrong; one plant is missed once. Rates with errors.
day_run() { # FOLDER DAY
    mkdir $1
    awk -v day=$2 'BEGIN {
        print "{\"program\": \"plantimeter\", \"version\": \"0\", \"options\": {}, \"plants\": [" >"'$1'/run.json"
        print "plant_id,organ,organ_id,x,y,z,trait,value,unit,std_error,n_points,status,reason,method" >"'$1'/traits.csv"
        for (i = 0; i < 3; i++) {
            if (i == 2 && day == 4) continue
            printf "%s{\"plant_id\": \"p%d\", \"status\": \"ok\"}\n", i ? "," : "", i >"'$1'/run.json"
            height = 100 + 5 * day * (i + 1); area = 20 * exp(0.1 * day)
            if (i == 1 && day == 6) height = 300
            printf "p%d,plant,,,,,plant_height,%.9g,mm,0.5,900,ok,,m\n", i, height >"'$1'/traits.csv"
            printf "p%d,plant,,,,,total_leaf_area,%.9g,cm2,0.2,900,ok,,m\n", i, area >"'$1'/traits.csv"
            printf "p%d,leaf,0,,,,leaf_area,%.9g,cm2,0.2,900,ok,,m\n", i, area / 2 >"'$1'/traits.csv"
        }
        print "]}" >"'$1'/run.json"
    }'
}
echo 'run,date' >dates.csv
for day in 0 2 4 6 8 10; do
    day_run run$day $day
    printf 'run%d,2026-02-%d\n' $day $((24 + day)) | sed 's/-02-30/-03-02/; s/-02-32/-03-04/; s/-02-34/-03-06/' >>dates.csv
done
plantimeter series run8 run0 run2 ./run4/ run6 run10 --dates dates.csv -o out || echo "exit code $?"
grep -E 'p1,plant_height|p2,plant_height' out/series.csv
cat out/wide.csv
grep -E 'p1,plant_height|p2,total|all,all' out/growth.csv
echo 'what cannot be:'
plantimeter series run0 --dates dates.csv -o out || echo "exit code $?"
plantimeter series run0 run2 -o out || echo "exit code $?"
plantimeter series run0 run2 --dates dates.csv || echo "exit code $?"
printf 'run,date\nrun0,2026-02-24\nrun2,yesterday\nrun4,2026-02-24\nrun6,2026-02-30\n' >wrong.csv
plantimeter series run0 run2 --dates wrong.csv -o out || echo "exit code $?"
plantimeter series run0 run4 --dates wrong.csv -o out || echo "exit code $?"
plantimeter series run0 run6 --dates wrong.csv -o out || echo "exit code $?"
plantimeter series run0 run8 --dates wrong.csv -o out || echo "exit code $?"
