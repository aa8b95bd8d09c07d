# Results to standard output, talk to standard error; --quiet and --json keep to themselves; "-" is standard input.
. "$LIB/small_plant.sh"
small_plant plant.csv
plantimeter measure --labels label --traits leaf_count --up z --quiet plant.csv
plantimeter measure --labels label --traits leaf_count --up z - <plant.csv
plantimeter measure --labels label --traits leaf_count --up z --json - <plant.csv | python3 -c '
import json, sys
found = json.load(sys.stdin)
print(sorted(found), [(t["trait"], t["value"]) for p in found["plants"] for t in p["traits"]])'
plantimeter plan --labels label --json plant.csv | python3 -c '
import json, sys
print([(s["stage"], s["runs"]) for s in json.load(sys.stdin)["plan"] if s["stage"] in ("segment", "georeference")])'
plantimeter info --json plant.csv | python3 -c 'import json, sys; print(json.load(sys.stdin)["points"])'
plantimeter traits --json | python3 -c 'import json, sys; print(len(json.load(sys.stdin)["traits"]) > 1)'
echo 'the file has labels that are not used:'
plantimeter measure --traits leaf_count --up z --ground none plant.csv >/dev/null
