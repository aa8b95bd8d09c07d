# A folder's results are neither overwritten nor measured twice; --force measures anew.
. "$LIB/small_plant.sh"
small_plant one.csv
small_plant two.csv 1 2
measure() {
    plantimeter measure --labels label --traits leaf_count --up z -o out "$@"
    code=$?
    [ $code -eq 0 ] || echo "exit code $code"
}
measure one.csv
echo 'a second plant joins the first, which is not measured again:'
measure one.csv two.csv
cp out/traits.csv before.csv
echo 'nothing is left to do:'
measure one.csv two.csv
cmp out/traits.csv before.csv
echo 'another option:'
measure --seed 1 one.csv
echo 'another file of that name:'
small_plant one.csv 1 5
measure one.csv
cmp out/traits.csv before.csv
echo 'by force:'
measure --force one.csv
echo 'a file of the results was deleted:'
rm out/one.labelled.ply
measure one.csv
ls out
echo 'the record is broken:'
echo '{' >out/run.json
measure one.csv
echo 'a table of somebody else:'
rm out/run.json
measure one.csv
