# What the script tests share. A test is run as `sh tests/scripts/NAME.sh PROGRAM SOURCE_FOLDER` in an empty folder; it
# exits with 0 (passed), 77 (skipped, having said why) or anything else (failed, having said what).
program=$1
source=$2
export LC_ALL=C

# need COMMAND: skips where there is no such program.
need() {
    command -v "$1" >/dev/null && return
    echo "skipped: $1 is not installed"
    exit 77
}

# fail MESSAGE
fail() {
    echo "failed: $1"
    exit 1
}

# manual_of TRAITS.csv: a manual table of some of its traits: a bias, a deterministic error, repeats, other units.
manual_of() {
    awk -F, 'BEGIN { print "plant_id,organ,organ_id,trait,value,unit" }
    $7 ~ /^(plant_height|leaf_area|leaf_inclination|stem_diameter)$/ && $12 ~ /^ok/ && $8 != "" {
        for (repeat = 0; repeat < 2; repeat++) {
            value = $8 * (1 + 0.04 * sin(NR + 2 * repeat)) + 0.02 * $8
            unit = $9
            if ($7 == "plant_height") { value /= 10; unit = "cm" }
            if ($7 == "leaf_area") { value *= 100; unit = "mm2" }
            printf "%s,%s,%s,%s,%.6g,%s\n", $1, $2, $3, $7, value, unit
        }
    }' "$1"
}

# measured_examples: measures the example plants into run/ (tables only).
measured_examples() {
    "$program" measure "$source"/examples/data/*.ply -o run --files tables -q --effort fast 2>measure.log || fail "$(cat measure.log)"
}

# same_agreement COMMAND...: a script that finds the R2 and RMSE of `validate` from the same tables agrees with it, and
# notices a table that says otherwise.
same_agreement() {
    measured_examples
    manual_of run/traits.csv >manual.csv
    "$program" validate run/traits.csv manual.csv -o agreement -q || fail 'validate'
    "$@" run/traits.csv manual.csv agreement/agreement.csv >found.csv || fail 'its figures differ'
    [ "$(wc -l <found.csv)" -eq 5 ] || fail "four traits were expected: $(cat found.csv)"
    sed 's/\(leaf_area,all,rmse\),\([0-9]\)/\1,9\2/' agreement/agreement.csv >other.csv
    "$@" run/traits.csv manual.csv other.csv >/dev/null 2>&1 && fail 'a wrong RMSE was not noticed'
    return 0
}
