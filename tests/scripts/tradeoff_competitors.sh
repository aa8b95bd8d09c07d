# The plain library methods beside the program's own, in one run of `tradeoff`; where they were built.
. "$2/tests/scripts/lib.sh"
rivals=$(dirname "$program")/plantimeter-competitors
[ -x "$rivals" ] || {
    echo 'skipped: plantimeter-competitors is not built'
    exit 77
}
"$rivals" --list >methods || fail '--list'
grep -q '"method": "CGAL Alpha_shape_3"' methods || fail 'no alpha shapes'
"$program" tradeoff --simulate pepper --cloud-points 6000 --up z --points 2000 --repeats 1 --limit 120 -q -o out \
    -t plant_height,convex_hull_volume,leaf_area,leaf_inclination,stem_diameter,petiole_inclination || fail 'tradeoff'
[ "$(wc -l <out/failures.csv)" -eq 1 ] || fail "$(cat out/failures.csv)"
# Each method is there with all points and with 2000, and has an error that is no nonsense on a clean scan; our own estimates of
# areas with the same labels are better than the best surface through raw points.
awk -F, '
    $3 ~ /^points=(all|2000) / || $2 == "plantimeter --labels" { rows[$2]++ }
    $3 ~ /^points=all/ && $13 == "given" && $15 > 0 && !($5 >= 0 && $5 < 400) { print "nonsense: " $0; bad = 1 }
    $1 == "leaf_area" && $3 == "points=all" && $2 == "plantimeter --labels" { own = $5 }
    $1 == "leaf_area" && $3 == "points=all alpha=8 spacings" { shape = $5 }
    $1 == "plant_height" && $3 == "points=all extent along z" { height = $5 }
    END {
        n = split("CGAL Alpha_shape_3|CGAL advancing front|PCL greedy projection|PCL MLS + greedy projection|PCL normals|" \
            "PCL RANSAC cylinder|open formula|CGAL convex_hull_3|plantimeter --labels", name, "|")
        for (k = 1; k <= n; k++) if (!(rows[name[k]] >= 2)) { print "missing: " name[k]; bad = 1 }
        if (!(own < shape && shape < 20)) { print "leaf area: " own " % against " shape " %"; bad = 1 }
        if (!(height < 5)) { print "height by its extent: " height " %"; bad = 1 }
        exit bad
    }' out/tradeoff.csv || fail 'the table'
"$rivals" --method 'open formula' --setting 'extent along z' nowhere.ply | grep -q '"failure": "nowhere.ply: ' ||
    fail 'a missing cloud'
"$rivals" --method nothing --setting none x.ply | grep -q '"failure": "no method ' || fail 'an unknown method'
# A program that stands alone says in one line that they are missing.
mkdir alone && cp "$(readlink -f "$program")" alone/plantimeter
alone/plantimeter tradeoff --truth out/plants/dome/truth.json --up z -t plant_height --quick -o again >printed 2>told ||
    fail 'without competitors'
[ "$(grep -c 'plantimeter-competitors is not beside this program' told)" -eq 1 ] && [ "$(wc -l <told)" -eq 1 ] ||
    fail "$(cat told)"
