# report.html in headless Chromium: the 3D view draws, a click on an organ tells its traits, the switches switch; and without
# JavaScript the tables are there. PLANTIMETER_SCREENSHOT=FILE.png keeps a picture of the page with an open view.
. "$2/tests/scripts/lib.sh"
need chromium
browser() {
    timeout 200 chromium --headless=new --no-sandbox --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader \
        --hide-scrollbars --user-data-dir="$PWD/profile" --window-size=900,1900 --virtual-time-budget=20000 "$@" 2>browser.log
}
"$program" measure "$source/examples/data/eggplant.ply" -o run -q --effort fast || fail 'measure'
grep -q 'id="view-0"' run/report.html || { echo 'skipped: the program was built without three.js'; exit 77; }
# Clicks on points of each organ, and counts what is drawn. Few clicks: a renderer in software on a busy machine is slow.
cat >probe.js <<'END'
var canvas = document.querySelector('.stage canvas'), gl = canvas.getContext('webgl2') || canvas.getContext('webgl');
var report = document.createElement('pre'), view = document.querySelector('.view').plantimeter;
function drawn() {
    var w = gl.drawingBufferWidth, h = gl.drawingBufferHeight, p = new Uint8Array(4 * w * h), n = 0;
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, p);
    for (var i = 0; i < p.length; i += 4) n += p[i] !== p[0] || p[i + 1] !== p[1] || p[i + 2] !== p[2];
    return n;
}
var all = drawn(), found = {}, box = canvas.getBoundingClientRect(), told = document.querySelector('.told');
view.data.organs.forEach(function (organ, number) {
    var of = [], place = view.organs.geometry.attributes.position, name = organ.organ + ' ' + organ.organ_id;
    view.organs.userData.organ.forEach(function (k, i) { if (k === number) of.push(i); });
    for (var k = 1; k < 6 && of.length && !found[name]; k++) { // another organ may be in front of some of its points
        var p = new THREE.Vector3().fromBufferAttribute(place, of[Math.floor(of.length * k / 6)]).project(view.camera);
        var at = { bubbles: true, clientX: box.left + (p.x + 1) / 2 * box.width, clientY: box.top + (1 - p.y) / 2 * box.height };
        canvas.dispatchEvent(new MouseEvent('mousedown', at));
        document.dispatchEvent(new MouseEvent('mouseup', at));
        canvas.dispatchEvent(new MouseEvent('click', at));
        if (!told.hidden) found[told.querySelector('h3').textContent] = true;
    }
});
report.id = 'probe';
report.textContent = 'drawn ' + (all > 2000 ? 'much' : 'little: ' + all) + '\n' + Object.keys(found).sort().join(', ') + '\n';
document.querySelectorAll('.tools input').forEach(function (input) {
    var before = drawn();
    input.click();
    report.textContent += input.name + (drawn() !== before ? ' switches' : ' does nothing') + '\n';
});
document.querySelector('tr[data-organ="leaf:2"]').click();
report.textContent += 'row: ' + told.textContent + '\n';
document.body.appendChild(report);
END
{ sed '/^<\/body>/,$d' run/report.html && echo '<script>' && cat probe.js && echo '</script></body></html>'; } >run/probe.html
browser --dump-dom "file://$PWD/run/probe.html#view=eggplant" >dom.html
sed -n '/<pre id="probe">/,/<\/pre>/p' dom.html >found.txt
[ -s found.txt ] || fail "the page's script did not end: $(grep -i console browser.log)"
grep -q 'drawn much' found.txt || fail "$(cat found.txt)"
for organ in 'leaf 0' 'leaf 1' 'leaf 2' 'leaf 3' 'stem 0' 'petiole 1'; do
    grep -q "$organ" found.txt || fail "no click reached $organ: $(cat found.txt)"
done
for switch in points 'leaf surfaces' 'convex hull'; do
    grep -q "^$switch switches" found.txt || fail "$(cat found.txt)"
done
area=$(awk -F, '$2 == "leaf" && $3 == 2 && $7 == "leaf_area" { print int($8) }' run/traits.csv)
grep -q "row: leaf 2area cm2$area" found.txt || fail "the row of leaf 2 does not tell its area, $area cm2: $(cat found.txt)"
# Without JavaScript, here forbidden by the page's policy, it is drawn all the same (an empty page makes some 10 kB).
sed "s/script-src 'unsafe-inline'/script-src 'none'/" run/report.html >run/plain.html
browser --screenshot="$PWD/plain.png" "file://$PWD/run/plain.html"
[ -s plain.png ] || fail "no picture: $(tail -3 browser.log)"
[ "$(wc -c <plain.png)" -gt 50000 ] || fail 'without JavaScript there is nothing to see'
if [ -n "${PLANTIMETER_SCREENSHOT:-}" ]; then
    sed 's/box.scrollIntoView();//' run/report.html >run/shown.html
    browser --screenshot="$PLANTIMETER_SCREENSHOT" "file://$PWD/run/shown.html#view=eggplant/leaf:2"
fi
exit 0
