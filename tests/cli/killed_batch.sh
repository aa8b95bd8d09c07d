# A batch that was killed leaves nothing half-written, and goes on where it was, to the same tables.
. "$LIB/small_plant.sh"
for i in 1 2 3 4 5 6 7 8; do small_plant "plant$i.csv" 1 $((i % 4 + 1)); done
measure() {
    plantimeter measure --labels label --traits leaf_count --up z --quiet --output "$@" plant*.csv
}
measure whole
measure killed &
sleep 0.4
kill -9 $! 2>/dev/null
wait $! 2>/dev/null
find killed -name '*.part'
measure killed
echo "exit code $?"
cmp whole/traits.csv killed/traits.csv && cmp whole/plants.csv killed/plants.csv && cmp whole/plant5.png killed/plant5.png &&
    echo 'the tables and a picture are those of a whole batch'
# Killed between its first tables and its record, as a table that cannot be written ends it there.
mkdir -p cut/plants.csv/in_the_way
measure cut 2>/dev/null
echo "exit code $?"
ls cut/traits.csv
rm -r cut/plants.csv
measure cut
echo "exit code $?"
cmp whole/traits.csv cut/traits.csv && cmp whole/plants.csv cut/plants.csv && echo 'the same tables'
