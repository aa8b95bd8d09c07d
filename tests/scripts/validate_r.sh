# examples/validate.R finds the R2 and RMSE that `validate` wrote, from the same tables.
. "$2/tests/scripts/lib.sh"
need Rscript
same_agreement Rscript "$source/examples/validate.R"
