# What `export` writes is what the formats ask for; Field Book's database comes back as manual measurements.
. "$2/tests/scripts/lib.sh"
need python3
measured_examples
printf 'plant_id,genotype,row,column,rep,timestamp\neggplant,"Black, round",1,2,A,2026-05-02T09:30:00Z\npepper_in_pot,Hangzhou,1,3,A,2026-05-02T09:40:00Z\n' >meta.csv
"$program" export run -o out --metadata meta.csv --study s1 -q || fail 'export'
python3 - "$source" <<'END' || fail 'a format is not as it should be'
import csv
import json
import re
import sys

traits = list(csv.DictReader(open("run/traits.csv")))
plants = {row["plant_id"]: row for row in csv.DictReader(open("run/plants.csv"))}

# BrAPI v2.1: an array of observations of plants, values as texts, variables defined and apart from those of hand methods.
observations = json.load(open("out/brapi/observations.json"))
variables = {v["observationVariableDbId"]: v for v in json.load(open("out/brapi/variables.json"))}
units = {u["observationUnitDbId"]: u for u in json.load(open("out/brapi/observationunits.json"))}
assert isinstance(observations, list) and len(observations) > 20
hand = set()
for row in csv.DictReader(open(sys.argv[1] + "/reports/data/ontology.csv")):
    hand |= set(filter(None, row["hand_variable_id"].split(";")))
    assert row["trait_accession"] == "" or re.fullmatch(r"TO:\d{7}", row["trait_accession"]), row
assert hand and not hand & set(variables)
assert len({v["method"]["methodDbId"] for v in variables.values()}) == len(variables)
for o in observations:
    assert isinstance(o["value"], str) and float(o["value"]) == float(o["value"]), o
    assert o["observationUnitDbId"] in plants and o["observationVariableDbId"] in variables
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", o["observationTimeStamp"])
    assert o["externalReferences"][0]["referenceId"].startswith("sha256:") and "referenceID" not in o["externalReferences"][0]
    assert all(isinstance(v, str) for v in o["additionalInfo"].values())
    assert o["studyDbId"] == "s1" and o["germplasmName"] in ("Black, round", "Hangzhou")
height = {o["observationUnitDbId"]: float(o["value"]) for o in observations
          if o["observationVariableDbId"] == "plantimeter:plant_height_pointcloud_mm"}
assert height == {p: float(row["plant_height_mm"]) for p, row in plants.items()}, height
assert set(units) == set(plants)
assert all(u["observationUnitPosition"]["observationLevel"]["levelName"] == "plant" for u in units.values())

# MIAPPE 1.2: required cells, and every variable of the data has a row.
sheet = {name: list(csv.DictReader(open(f"out/miappe/{name}.csv")))
         for name in ("observation_unit", "observed_variable", "data_file", "data")}
for row in sheet["observed_variable"]:
    assert all(row[k] for k in ("variableId", "traitName", "methodName", "scaleName")), row
assert all(row["obsUnitType"] == "plant" and row["obsUnitId"] in plants for row in sheet["observation_unit"])
assert set(sheet["data"][0]) - {"obsUnitId", "time"} == {row["variableId"] for row in sheet["observed_variable"]}

# Frictionless: names, files, and fields that are the columns and hold their type.
package = json.load(open("out/frictionless/datapackage.json"))
assert package["profile"] == "tabular-data-package" and len(package["resources"]) == 2
for resource in package["resources"]:
    assert re.fullmatch(r"[-a-z0-9._/]+", resource["name"]) and not resource["path"].startswith(("/", "."))
    rows = list(csv.reader(open("out/frictionless/" + resource["path"])))
    fields = resource["schema"]["fields"]
    assert [f["name"] for f in fields] == rows[0]
    for k, field in enumerate(fields):
        cells = [row[k] for row in rows[1:] if row[k] not in resource["schema"]["missingValues"]]
        {"number": lambda c: [float(x) for x in c], "integer": lambda c: [int(x) for x in c],
         "string": lambda c: c}[field["type"]](cells)
        assert not field.get("constraints", {}).get("required") or len(cells) == len(rows) - 1
    key = resource["schema"].get("primaryKey")
    assert not key or len({row[rows[0].index(key)] for row in rows[1:]}) == len(rows) - 1
    assert open("out/frictionless/" + resource["path"]).read() == open("run/" + resource["path"]).read()

# Field Book: all cells of the trait file quoted, names without forbidden characters, unique ids first.
lines = open("out/fieldbook/traits.trt").read().splitlines()
assert all(re.fullmatch(r'"(?:[^"]|"")*"(?:,"(?:[^"]|"")*"){8}', line) for line in lines)
table = list(csv.reader(open("out/fieldbook/table.csv")))
assert table[0][0] == "plant_name" and not any(set(name) & set('/?<>*|"') for name in table[0])
assert {row[1] for row in csv.reader(lines)} <= {"format", "numeric"}
assert {row[0] for row in csv.reader(lines[1:])} <= set(table[0])
END
"$program" validate run/traits.csv out/fieldbook/database.csv -o back -q || fail "Field Book's database is not read"
grep -q '^plant_height,all,rmse,0,' back/agreement.csv || fail 'its heights are not those of the run'
# A variable of a measurement by hand is refused; a user's own id is taken.
printf 'trait,variable_id\nplant_height,CO_322:0000996\n' >hand.csv
"$program" export run -o refused --ontology hand.csv -q 2>/dev/null && fail "the hand method's variable was taken"
printf 'trait,variable_id,trait_accession\nplant_height,CO_999:0000001,TO:9999999\n' >own.csv
"$program" export run -o own --ontology own.csv --format brapi -q || fail "a user's mapping"
grep -q '"observationVariableDbId": "CO_999:0000001"' own/brapi/observations.json || fail "a user's id is not used"
grep -q 'TO:9999999' own/brapi/variables.json || fail "a user's term is not used"
exit 0
