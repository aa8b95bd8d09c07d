# validate and compare: tables, pairs, what stays unpaired, units, groups, gates, Field Book's export, plots.
cat >traits.csv <<END
plant_id,organ,organ_id,x,y,z,trait,value,unit,std_error,n_points,status,reason,method
a,plant,,,,,plant_height,101,mm,0.5,900,ok,,extent
a,leaf,0,0,0,0,leaf_area,10.2,cm2,0.2,300,ok,,surface
a,leaf,1,0,0,0,leaf_area,14.1,cm2,0.2,300,ok,,surface
b,plant,,,,,plant_height,122,mm,0.5,900,ok,,extent
b,leaf,0,0,0,0,leaf_area,19.5,cm2,0.2,300,ok;occluded,,surface
b,leaf,1,0,0,0,leaf_area,,cm2,,0,failed,too few points,surface
c,plant,,,,,plant_height,139,mm,0.5,900,ok,,extent
c,leaf,0,0,0,0,leaf_area,23.8,cm2,0.2,300,ok,,surface
END
cat >manual.csv <<END
plant_id,organ,organ_id,trait,value,unit
a,plant,,plant_height,10.0,cm
a,plant,,plant_height,10.2,cm
a,leaf,0,leaf_area,1010,mm2
a,leaf,1,leaf_area,1390,mm2
b,plant,,plant_height,12.0,cm
b,leaf,0,leaf_area,2010,mm2
b,leaf,1,leaf_area,2210,mm2
c,plant,,plant_height,14.1,cm
c,leaf,0,leaf_area,2420,mm2
END
cat >metadata.csv <<END
plant_id,variety
a,long
b,long
c,round
END
plantimeter validate traits.csv manual.csv -o agreement --by variety --metadata metadata.csv || echo "exit code $?"
cat agreement/agreement.md agreement/pairs.csv agreement/unmatched.csv
grep -E '^leaf_area,all,(n|r2|rmse|mape|bias|tost_p|manual_icc|coverage_95)' agreement/agreement.csv
echo 'gates:'
plantimeter validate traits.csv manual.csv -o agreement -q --fail-if 'leaf_area.mape>5' || echo "exit code $?"
plantimeter validate traits.csv manual.csv -o agreement -q --fail-if 'leaf_area.mape>1,plant_height.r2<0.5' || echo "exit code $?"
plantimeter validate traits.csv manual.csv -o agreement -q --fail-if 'leaf_area.map>1' || echo "exit code $?"
echo "Field Book's database export:"
cat >fieldbook.csv <<END
"plant_id_field","row","trait","value","timestamp","person","location","number","attached_photo","attached_video","attached_audio","device_name"
"a","1","plant_height_cm","10.1","2026-05-02 09:00:00+0200","Kim","","1","","","","tablet"
"b","1","plant_height_cm","12.1","2026-05-02 09:01:00+0200","Kim","","1","","","","tablet"
"b","1","plant_height_cm","11.9","2026-05-02 09:02:00+0200","Kim","","2","","","","tablet"
"c","1","plant_height_cm","14.1","2026-05-02 09:03:00+0200","Kim","","1","","","","tablet"
"c","1","flower_colour","purple","2026-05-02 09:03:00+0200","Kim","","1","","","","tablet"
END
plantimeter validate traits.csv fieldbook.csv -o fieldbook || echo "exit code $?"
echo 'two runs:'
sed 's/,139,mm/,141,mm/' traits.csv >other.csv
plantimeter compare traits.csv other.csv -o compared || echo "exit code $?"
echo 'what cannot be:'
plantimeter validate traits.csv || echo "exit code $?"
plantimeter validate traits.csv nowhere.csv -o none || echo "exit code $?"
printf 'plant_id,organ,organ_id,trait,value,unit\na,plant,,plant_height,tall,cm\n' >words.csv
plantimeter validate traits.csv words.csv -o none || echo "exit code $?"
printf 'plant_id,organ,organ_id,trait,value,unit\nz,plant,,plant_height,10,cm\n' >strangers.csv
plantimeter validate traits.csv strangers.csv -o none || echo "exit code $?"
