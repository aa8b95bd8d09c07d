# An output that cannot be written: exit code 4, and nothing half-written.
. "$LIB/small_plant.sh"
small_plant plant.csv
echo 'a file' >file
plantimeter measure --labels label --traits leaf_count plant.csv -o file/out
echo "exit code $?"
plantimeter measure --labels label --traits leaf_count plant.csv -o file
echo "exit code $?"
mkdir -p taken/plant.png
plantimeter measure --labels label --traits leaf_count --up z plant.csv -o taken
echo "exit code $?"
find taken -name '*.part'
plantimeter traits >/dev/full
echo "exit code $?"
