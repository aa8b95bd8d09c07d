#!/bin/sh
# Runs command-line tests: each NAME.sh in an empty folder, and compares what it printed and its exit code with
# NAME.expected. Usage: run.sh PROGRAM SOURCE_FOLDER [--record] NAME...
# --record writes the .expected files anew: read the difference before committing it.
set -u
program=$1
source=$2
shift 2
record=false
if [ "${1:-}" = --record ]; then
    record=true
    shift
fi
here=$source/tests/cli
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
ln -s "$program" "$work/bin/plantimeter"
PATH=$work/bin:$PATH
LC_ALL=C
EXAMPLES=$source/examples/data
LIB=$here/lib
OMP_WAIT_POLICY=passive # tests run side by side: threads that wait must not spin
export PATH LC_ALL EXAMPLES LIB OMP_WAIT_POLICY
failed=0
for name in "$@"; do
    mkdir "$work/$name"
    (cd "$work/$name" && sh "$here/$name.sh") >"$work/stdout" 2>"$work/stderr" </dev/null
    code=$?
    {
        echo '--- stdout'
        cat "$work/stdout"
        echo '--- stderr'
        cat "$work/stderr"
        echo "--- exit code $code"
    } >"$work/found"
    if $record; then
        cp "$work/found" "$here/$name.expected"
    elif ! diff -u "$here/$name.expected" "$work/found"; then
        echo "$name: the output is not what was expected"
        failed=1
    fi
done
exit $failed
