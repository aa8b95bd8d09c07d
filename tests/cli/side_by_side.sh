# Plants of a large batch are measured side by side; tables, exit code and messages are those of one after the other.
. "$LIB/small_plant.sh"
for number in 1 2 3 4 5 6; do small_plant "plant$number.csv" "1.$number" 2; done
echo 'no cloud' >plant3.csv
for threads in 1 3; do
    plantimeter measure plant?.csv --unit m --labels label --threads "$threads" -o "with$threads" --quiet 2>"messages$threads"
    echo "exit code $?"
done
cmp with1/traits.csv with3/traits.csv && cmp with1/plants.csv with3/plants.csv && echo 'the same tables'
sort messages1 | cmp - messages3 && cat messages3
plantimeter measure plant?.csv --unit m --labels label --threads 3 -o with3 2>&1 >table | tail -n 1
