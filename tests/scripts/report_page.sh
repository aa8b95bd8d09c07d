# report.html is complete in itself, shows every plant, and of many plants stays small.
. "$2/tests/scripts/lib.sh"
. "$source/tests/cli/lib/small_plant.sh"
small_plant 'a<b&c.csv'
small_plant b.csv
echo 'no cloud' >broken.csv
"$program" measure 'a<b&c.csv' b.csv broken.csv --labels label --up z -o run -q 2>/dev/null
page=run/report.html
[ -s $page ] || fail 'measure wrote no page'
grep -q '<section class="card" id="plant-0" data-plant="a&lt;b&amp;c">' $page || fail 'the name of a plant is not escaped'
grep -q 'class="bad">failed: ' $page || fail 'a failed plant is not told'
for trait in 'plant height' 'leaf count'; do grep -q "$trait" $page || fail "no $trait"; done
[ "$(grep -c '<tr data-organ="leaf:' $page)" -eq 6 ] || fail 'a row for each leaf was expected'
grep -q "$(sha256sum <b.csv | cut -d' ' -f1)" $page || fail 'no checksum of an input'
grep -Eq '(src|href|data)="(https?:|//|[a-z/.]+\.(png|js|css|svg))' $page && fail 'the page names something outside it'
grep -q 'Content-Security-Policy' $page || fail 'no policy against the network'
# Again, from the folder: the same bytes.
cp $page before.html
"$program" report run -q || fail 'report'
cmp $page before.html || fail 'the page made again differs'
# Small pictures instead of whole ones and 3D views.
"$program" report run -q --views 0 || fail 'report --views 0'
grep -q 'image/jpeg' $page || fail 'no small pictures'
grep -q 'id="view-' $page && fail 'a 3D view in spite of --views 0'
grep -q 'The first 0 of 3 plants' $page || fail 'the page does not say whose views it has'
# What a plant takes: the page but for what all share (style, scripts), a thousandth of half a gigabyte at most.
own=$(sed -n '/<main>/,/<\/main>/p' $page | wc -c)
[ "$own" -lt $((3 * 500000)) ] || fail "a plant takes $((own / 3)) bytes"
exit 0
