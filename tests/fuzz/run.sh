#!/bin/sh
# Runs each fuzz target of a build folder for some seconds, starting from the corpus; what it finds stays in the build
# folder. Fails on the first crash and says where its input is.
set -eu
build=${1:?build folder} seconds=${2:-10} seed=${3:-1}
here=$(cd "$(dirname "$0")" && pwd)
export ASAN_OPTIONS=${ASAN_OPTIONS:-allocator_may_return_null=1}
for target in "$build"/tests/fuzz/fuzz_*; do
    [ -x "$target" ] && [ -f "$target" ] || continue
    name=$(basename "$target")
    found=$build/found/$name
    mkdir -p "$found"
    echo "$name: $seconds s"
    if ! "$target" -seed="$seed" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -print_final_stats=0 -verbosity=0 \
        -artifact_prefix="$found/" "$found" "$here/corpus/${name#fuzz_}" "$here/../hostile" >"$found.log" 2>&1; then
        tail -n 40 "$found.log" >&2
        exit 1
    fi
done
