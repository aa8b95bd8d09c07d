# The unit: guessed and said, or given.
. "$LIB/small_plant.sh"
small_plant m.csv
small_plant mm.csv 1000
unit() {
    plantimeter info "$@" | grep '^unit'
}
unit m.csv
unit mm.csv
unit mm.csv --unit mm
unit mm.csv --scale 0.001
unit mm.csv --known-length 0:0:0,0:0:100,10cm
unit mm.csv --known-length 0,239,9.5702cm
plantimeter info mm.csv --known-length 0,2390,1m
echo "exit code $?"
plantimeter measure mm.csv --labels label --traits leaf_count --up z >/dev/null
