# A labelled cloud is measured as it is labelled; the folder gets the tables and the files of each plant.
. "$LIB/small_plant.sh"
small_plant plant.csv
plantimeter measure plant.csv --labels label --traits leaf_count --up z -o out/deep || exit
ls out/deep
cat out/deep/traits.csv out/deep/plants.csv
head -c 400 out/deep/plant.labelled.ply | sed -n '/end_header/q;p'
