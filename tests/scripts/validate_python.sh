# examples/validate.py finds the R2 and RMSE that `validate` wrote, from the same tables.
. "$2/tests/scripts/lib.sh"
need python3
measured_examples
manual_of run/traits.csv >manual.csv
"$program" validate run/traits.csv manual.csv -o agreement -q || fail 'validate'
python3 "$source/examples/validate.py" run/traits.csv manual.csv agreement/agreement.csv >found.csv || fail 'its figures differ'
[ "$(wc -l <found.csv)" -eq 5 ] || fail "four traits were expected: $(cat found.csv)"
# A table that says otherwise is noticed.
sed 's/\(leaf_area,all,rmse\),\([0-9]\)/\1,9\2/' agreement/agreement.csv >other.csv
python3 "$source/examples/validate.py" run/traits.csv manual.csv other.csv >/dev/null 2>&1 && fail 'a wrong RMSE was not noticed'
exit 0
