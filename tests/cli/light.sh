# Absorbed light of meshes and of measured plants: power by organ, and a balance that closes.
light() {
    plantimeter light --rays 20000 "$@"
    code=$?
    [ $code -eq 0 ] || echo "exit code $code"
}
plantimeter simulate -q pepper --resolution 0.1 --scanner none --seed 3 -o plants
OMP_NUM_THREADS=1 light plants/pepper_3_mesh.mesh.ply -o first | sed 's/, [0-9.]* s$//'
OMP_NUM_THREADS=3 light -q plants/pepper_3_mesh.mesh.ply -o again
cmp first/light.csv again/light.csv && cmp first/pepper_3_mesh.light.ply again/pepper_3_mesh.light.ply && echo same
ls first
cut -d, -f1-4 first/light.csv
grep -a -e property first/pepper_3_mesh.light.ply
echo 'a level black plate of 1 m2 under 1000 W/m2, in centimetres, with y up:'
cat >plate.obj <<'EOF'
v 0 0 0
v 100 0 0
v 100 0 100
v 0 0 100
f 1 2 3 4
EOF
light -q --reflectance 0 --transmittance 0 --irradiance 1000 --unit cm --up y --rays 1000000 plate.obj -o deep/er/plate
tail -1 deep/er/plate/light.csv | awk -F, '{printf "%.0f cm2 %s\n", $4, ($5 > 637 && $5 < 640) ? "sum of sines of six circles over six: 639 W" : $5}'
echo 'a run of measure:'
plantimeter measure -q "$EXAMPLES/eggplant.ply" --traits leaf_area -o run
light -q run -o lit
cut -d, -f1-3 lit/light.csv
echo 'what cannot be:'
light plate.obj
light -o out
light -o out absent.ply
cp "$EXAMPLES/eggplant.ply" cloud.ply && light -o out cloud.ply
light -o out --sources 70 plate.obj
light -o out --reflectance 0.5,0.6 plate.obj
light -o out --reflectance 0.95 plate.obj
light -o out deep
light -q -o out plate.obj absent.ply
