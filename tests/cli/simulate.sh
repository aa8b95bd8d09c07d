# Virtual plants come with their truth, and are the same again for the same seed on any number of threads.
simulate() {
    plantimeter simulate --resolution 0.2 --points 500 --seed 3 "$@"
    code=$?
    [ $code -eq 0 ] || echo "exit code $code"
}
OMP_NUM_THREADS=1 simulate -q pepper -n 2 -o first
OMP_NUM_THREADS=3 simulate -q pepper -n 2 -o again
ls first
diff -r first again && echo same
echo 'as gaussians, in a pot:'
simulate -q pepper --scanner splat --format 3dgs --pot -o splat
ls splat
echo 'the mesh alone:'
simulate -q bare_stem --scanner none -o mesh
ls mesh
echo 'arched, which the truth says:'
simulate -q cucumber --arched --scanner none -o arched
simulate -q cucumber --scanner none -o straight
[ -s arched/cucumber_3_mesh.mesh.ply ] || echo missing
cmp -s arched/cucumber_3_mesh.mesh.ply straight/cucumber_3_mesh.mesh.ply || echo another plant
grep -l '"arched": true' arched/*.truth.json straight/*.truth.json
echo 'what cannot be:'
simulate tomatoe -o wrong
simulate pepper --format 3dgs -o wrong
simulate pepper
simulate -o wrong
echo 'with its views:'
simulate -q pepper --scanner rgbd --views 2 --image-width 160 --axis-tilt 1 --axis-shift 2 --views-out -o views
ls views/*.views
simulate pepper --views-out -o wrong
