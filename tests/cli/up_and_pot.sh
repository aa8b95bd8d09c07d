# Zenith is found or given; a pot of known diameter gives the unit.
# The example with y up, in millimetres, every other point.
python3 - "$EXAMPLES/pepper_in_pot.ply" y.csv <<'PYTHON'
import struct, sys
data = open(sys.argv[1], "rb").read()
end = data.index(b"end_header\n") + 11
header = data[:end].decode().split("\n")
count = next(int(l.split()[2]) for l in header if l.startswith("element vertex"))
sizes = {"float": 4, "uchar": 1, "int": 4, "double": 8}
row = sum(sizes[l.split()[1]] for l in header if l.startswith("property"))
with open(sys.argv[2], "w") as out:
    out.write("x,y,z\n")
    for i in range(0, count, 2):
        x, y, z = struct.unpack_from("<3f", data, end + i * row)
        out.write(f"{y * 1e3:.4f},{z * 1e3:.4f},{x * 1e3:.4f}\n")
PYTHON
plantimeter info y.csv | grep '^up' | sed 's/(.*//'
plantimeter info y.csv --up x | grep '^up'
plantimeter info y.csv --scale-from pot:80mm 2>&1 | grep '^unit' | sed 's/: 0.0010[0-9]* m (pot: [0-9.]* units/: about 0.001 m (pot: N units/;s/: 0.0009[0-9]* m (pot: [0-9.]* units/: about 0.001 m (pot: N units/'
plantimeter measure y.csv --traits plant_height --unit mm --quiet -o out --files tables
plantimeter measure "$EXAMPLES/pepper_in_pot.ply" --traits plant_height --quiet -o out2 --files tables
python3 - <<'PYTHON'
import csv, json
turned = next(csv.DictReader(open("out/plants.csv")))["plant_height_mm"]
plain = next(csv.DictReader(open("out2/plants.csv")))["plant_height_mm"]
# Half of the points, without colour: the pot's rim may come out another way by a few points.
print(abs(float(turned) / float(plain) - 1) < 0.03, json.load(open("out/run.json"))["plants"][0]["frame"]["up"])
PYTHON
plantimeter info "$EXAMPLES/eggplant.ply" --scale-from pot:80mm
echo "exit code $?"
