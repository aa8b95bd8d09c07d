# The thinning study: files, and a second run that finds every step done.
study() {
    plantimeter study thinning --max-loss 3 --rays 5000 --density 0.01 -o out "$@"
    code=$?
    [ $code -eq 0 ] || echo "exit code $code"
}
study --plants arabidopsis
head -3 out/thinning.csv | cut -d, -f1-4
cut -d, -f1-8 out/table1.csv
study --plants arabidopsis
ls out | grep -v -e png -e svg
echo 'what cannot be:'
study --plants oak
study --scenarios upside-down
plantimeter study growing -o out || echo "exit code $?"
echo 'the error of light:'
plantimeter study light --plants arabidopsis --rays 4000 -o light
cut -d, -f1 light/light_error.csv
ls light | grep -v -e png -e svg
