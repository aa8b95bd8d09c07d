#!/bin/sh
# The library neither ends the program, prints, nor draws hidden random numbers; and it exports plm_ names only.
# $1: the static library, $2: the shared library.
set -eu
forbidden='exit|_exit|abort|printf|puts|putchar|perror|rand|srand|random|drand48|vprintf'
# Only the project's own C objects count: templates of C++ libraries may refer to abort, behind exceptions.
bad=$(nm -A --undefined-only "$1" 2>/dev/null | grep -E '\.c\.o:' | grep -E " U ($forbidden)\$" || true)
if [ -n "$bad" ]; then
    echo 'the library must not use:'
    echo "$bad"
    exit 1
fi
foreign=$(nm -D --defined-only "$2" | awk '$2 ~ /[TDBR]/ {print $3}' | grep -vE '^(plm_|_init$|_fini$|_Z)' || true)
if [ -n "$foreign" ]; then
    echo 'exported names without plm_:'
    echo "$foreign"
    exit 1
fi
nm -D --defined-only "$2" | grep -q ' T plm_cloud_create' || { echo 'plm_cloud_create is not exported'; exit 1; }
echo 'symbols are clean'
