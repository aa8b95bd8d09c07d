# One bad file does not stop the others; its row says why. All bad: the exit code is that of bad input.
. "$LIB/small_plant.sh"
small_plant good.csv
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar label\nend_header\n1 2 3 1\n' >cut.ply
plantimeter measure --labels label --traits leaf_count --up z -o out cut.ply good.csv missing.ply
echo "exit code $?"
cat out/plants.csv
plantimeter measure -o out2 missing.ply
echo "exit code $?"
plantimeter measure missing.ply
echo "exit code $?"
: >empty.ply
plantimeter info empty.ply
echo "exit code $?"
plantimeter plan missing.ply
echo "exit code $?"
ls out out2
