#!/bin/sh
# A program of somebody else builds against the installed package: by CMake (shared and static) and by pkg-config.
# $1: source folder, $2: build folder of the project.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$2" --prefix "$work/prefix" >/dev/null
cmake -S "$1/tests/consumer" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Release >"$work/log" 2>&1 ||
    { tail -20 "$work/log"; exit 1; }
cmake --build "$work/build" >"$work/log" 2>&1 || { tail -20 "$work/log"; exit 1; }
"$work/build/consumer_shared"
"$work/build/consumer_static"
PKG_CONFIG_PATH="$work/prefix/lib/pkgconfig:$work/prefix/lib/$(gcc -print-multiarch)/pkgconfig"
export PKG_CONFIG_PATH
# shellcheck disable=SC2046 # flags are meant to be split
gcc -std=c17 "$1/tests/consumer/consumer.c" -o "$work/consumer" $(pkg-config --cflags --libs plantimeter) -lm
LD_LIBRARY_PATH=$(pkg-config --variable=libdir plantimeter)
export LD_LIBRARY_PATH
"$work/consumer"
# shellcheck disable=SC2046
gcc -std=c17 -Wall -Wextra -Werror "$1/examples/measure.c" -o "$work/measure" $(pkg-config --cflags --libs plantimeter) -lm
"$work/measure" "$1/examples/data/eggplant.ply" leaf_count | grep -q '^plant .* leaf_count  *[0-9]'
[ "$(pkg-config --modversion plantimeter)" = "$("$work/prefix/bin/plantimeter" --version | awk '{print $2}')" ]
grep -q '^.TH' "$work/prefix/share/man/man1/plantimeter.1"
bash -n "$work/prefix/share/bash-completion/completions/plantimeter"
