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
