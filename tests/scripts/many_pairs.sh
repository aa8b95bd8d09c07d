# 100 000 pairs with every statistic and 2000 resamples take at most 20 s of processor time (the kernel ends it otherwise).
. "$2/tests/scripts/lib.sh"
awk 'BEGIN {
    header = "plant_id,organ,organ_id,trait,value,unit"
    print header >"estimates.csv"
    print header >"manual.csv"
    seed = 1
    for (i = 0; i < 100000; i++) {
        seed = (seed * 16807) % 2147483647
        value = 10 + 40 * seed / 2147483647
        printf "p%d,leaf,%d,leaf_area,%.6g,cm2\n", i / 20, i % 20, value >"manual.csv"
        seed = (seed * 16807) % 2147483647
        printf "p%d,leaf,%d,leaf_area,%.6g,cm2\n", i / 20, i % 20, value * 0.98 + 2 * seed / 2147483647 >"estimates.csv"
    }
}'
(ulimit -t 20 && "$program" validate estimates.csv manual.csv -o agreement -q) || fail 'it took more than 20 s, or failed'
grep -q '^leaf_area,all,n,100000,' agreement/agreement.csv || fail 'not all pairs were used'
grep '^leaf_area,all,mape,' agreement/agreement.csv | grep -q ',[0-9.]*,[0-9.]*,[0-9.]*,100000,%,' || fail 'no interval of MAPE'
exit 0
