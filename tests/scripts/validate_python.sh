# examples/validate.py finds the R2 and RMSE that `validate` wrote, from the same tables.
. "$2/tests/scripts/lib.sh"
need python3
same_agreement python3 "$source/examples/validate.py"
