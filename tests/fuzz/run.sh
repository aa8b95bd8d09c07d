#!/bin/sh
# Runs each fuzz target of a build folder for some seconds, starting from the corpus, as many side by side as there are
# processors; what it finds stays in the build folder. Fails if one crashes and says where its input is.
set -eu
build=${1:?build folder} seconds=${2:-10} seed=${3:-1}
here=$(cd "$(dirname "$0")" && pwd)
export ASAN_OPTIONS=${ASAN_OPTIONS:-allocator_may_return_null=1}
export build seconds seed here
targets=$(find "$build"/tests/fuzz -maxdepth 1 -name 'fuzz_*' -type f -perm -u+x | sort)
[ -n "$targets" ] || { echo "no fuzz target in $build/tests/fuzz"; exit 1; }
# shellcheck disable=SC2016 # the inner shell expands these
echo "$targets" | xargs -P "$(nproc)" -I TARGET sh -eu -c '
    name=$(basename "$1")
    found=$build/found/$name
    mkdir -p "$found"
    echo "$name: $seconds s"
    "$1" -seed="$seed" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -print_final_stats=0 -verbosity=0 \
        -artifact_prefix="$found/" "$found" "$here/corpus/${name#fuzz_}" "$here/../hostile" >"$found.log" 2>&1 || {
        tail -n 40 "$found.log" >&2
        exit 1
    }' sh TARGET
