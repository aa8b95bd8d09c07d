# Time budgets and target errors: how they are written, what they leave out, and how they say so.
. "$LIB/small_plant.sh"
small_plant plant.csv 1 3
usage() {
    plantimeter measure plant.csv "$@" >printed
    echo "exit code $?"
}
usage --time-budget 5parsecs
usage --time-budget 0s
usage --time-budget -3s
usage --target-error leaf_area
usage --target-error leaf_aera=2%
usage --target-error leaf_area=2mm
usage --target-error leaf_area=2% --points 5000
# Much time for a small plant: all of it is measured, with all its points, as without a budget.
plantimeter measure plant.csv --unit m --labels label -o free -q --files tables
plantimeter measure plant.csv --unit m --labels label --time-budget 2min -o timed -q
cmp free/traits.csv timed/traits.csv && ls timed
sed -n 's/.*"asked_s": \(.*\),/asked \1/p; s/.*"points_of_organ_traits": \(.*\),/organs by \1 points/p' timed/run.json
# No time at all: rows with that reason, and exit code 1.
plantimeter measure plant.csv --unit m --labels label --time-budget 1ms -o late -q
echo "exit code $?"
ls late
awk -F, 'NR > 1 { n[$12 " " $13]++ } END { for (k in n) print k }' late/traits.csv | sort
plantimeter measure plant.csv --unit m --labels label --time-budget 1e-6min -o late2 2>&1 >printed |
    sed 's/took [0-9.e-]* s/took SECONDS s/'
# A target that any number of points reaches, and one that none does.
plantimeter measure plant.csv --unit m --labels label --target-error plant_height=50% --target-error leaf_area=90%,stem_diameter=1cm -o easy -q
echo "exit code $?"
grep -c '"reached": true' easy/run.json
plantimeter measure plant.csv --unit m --labels label --target-error plant_height=1e-9mm -o hard >printed 2>messages
echo "exit code $?"
sed 's/interval is [0-9.e-]* /interval is WIDTH /' messages
