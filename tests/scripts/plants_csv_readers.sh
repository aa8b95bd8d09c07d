# plants.csv opens cleanly in R and in pandas: numbers are numbers, names stay, a row a plant; so does the statgenHTP table.
. "$2/tests/scripts/lib.sh"
measured_examples
"$program" export run -o out --format statgen -q --time 2026-05-02 || fail 'export'
tried=0
if command -v Rscript >/dev/null; then
    tried=1
    Rscript - <<'END' || fail 'R'
plants <- read.csv("run/plants.csv")
stopifnot(nrow(plants) == 2, identical(names(plants), names(read.csv("run/plants.csv", check.names = FALSE))))
stopifnot(is.numeric(plants$plant_height_mm), is.numeric(plants$total_leaf_area_cm2), is.integer(plants$leaf_count))
long <- read.csv("run/traits.csv")
stopifnot(is.numeric(long$value), is.numeric(long$std_error), all(long$organ %in% c("plant", "stem", "petiole", "leaf")))
time <- read.csv("out/statgen/timepoints.csv")
stopifnot(identical(names(time)[1:6], c("genotype", "timePoint", "plotId", "repId", "rowNum", "colNum")))
stopifnot(!anyDuplicated(time[c("plotId", "timePoint")]), is.numeric(time$plant_height_mm), !is.na(as.Date(time$timePoint)))
END
fi
if python3 -c 'import pandas' 2>/dev/null; then
    tried=1
    python3 - <<'END' || fail 'pandas'
import pandas as pd
plants = pd.read_csv("run/plants.csv")
assert len(plants) == 2 and not any(name.startswith("Unnamed") for name in plants.columns)
numeric = plants.select_dtypes("number").columns
assert {"plant_height_mm", "total_leaf_area_cm2", "leaf_count"} <= set(numeric), plants.dtypes
long = pd.read_csv("run/traits.csv")
wide = long[long.organ == "plant"].pivot(index="plant_id", columns="trait", values="value")
assert (wide.plant_height.to_numpy() == plants.set_index("plant_id").plant_height_mm[wide.index].to_numpy()).all()
END
fi
# A spreadsheet: one header line, as many cells in each row, no byte order mark, lines that end.
awk -F, 'NR == 1 { n = NF } NF != n { exit 1 }' run/plants.csv || fail 'rows of different length'
[ "$(tail -c 1 run/plants.csv | od -An -c | tr -d ' ')" = '\n' ] || fail 'the last line does not end'
[ $tried -eq 1 ] || { echo 'skipped: neither R nor pandas is installed'; exit 77; }
exit 0
