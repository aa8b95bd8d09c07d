# A plant's name is its file's; equal names get numbers; odd letters survive the tables and run.json.
. "$LIB/small_plant.sh"
mkdir a b
small_plant a/plant.csv
small_plant b/plant.csv 1 2
small_plant 'c, "d".csv' 1 1
small_plant "$(printf 'latin\351.csv')" 1 4
plantimeter measure --labels label --traits leaf_count --up z -o out --files tables */plant.csv c*.csv latin*.csv >/dev/null
echo "exit code $?"
LC_ALL=C tr '\351' '?' <out/plants.csv
python3 -c '
import json
print([p["plant_id"] for p in json.load(open("out/run.json"))["plants"]])'
ls out
