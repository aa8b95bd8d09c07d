# Wrong usage: exit code 2, a message that says what to change, nothing on standard output.
check() {
    plantimeter "$@"
    code=$?
    [ $code -eq 2 ] || echo "exit code $code: $*"
}
check
check mesure
check --versoin
check measure
check measure --trait
check measure --tratis leaf_count a.ply
check measure --s a.ply
check measure --up w a.ply
check measure --stem-height 20 a.ply
check measure --stem-height 2furlongs a.ply
check measure --neighbours many a.ply
check measure --neighbours 1 a.ply
check measure --seed -1 a.ply
check measure --scale 0 a.ply
check measure --force=yes a.ply
check measure -x a.ply
check measure --traits leaf_cuont a.ply
check measure --traits nothing_like_it a.ply
check measure --traits '' a.ply
check measure --ground soil a.ply
check measure --unit mm --scale 0.1 a.ply
check measure --crs utm:32 --unit mm a.ply
check measure --crs mercator a.ply
check measure --known-length 1,2 a.ply
check measure --known-length 1:2,3:4:5,1mm a.ply
check measure --scale-from stem:3mm a.ply
check plan
check info a.ply b.ply
check traits leaf_count
check help no_such_command
