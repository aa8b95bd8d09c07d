# A rosette in a pot as gaussians, whose smallest balls hold a part of the noise: its six leaves are not parted along their midribs.
plantimeter simulate -q -o plants --seed 57083 --arched --scanner splat --noise .5 --format 3dgs --pot arabidopsis
plantimeter measure -q -t leaf_count -o out --files tables --views 0 plants/arabidopsis_57083_3dgs_pot.ply
echo "exit code $?"
grep ',leaf_count,' out/traits.csv | cut -d, -f 1,2,7,8
