#!/bin/sh
# Static analysis by cppcheck: warnings, performance and portability; any finding fails.
set -eu
cd "$(dirname "$0")/../.."
folders=
for folder in cloud io segment mesh simulate rebuild traits reports tool; do [ -d "$folder" ] && folders="$folders $folder"; done
mkdir -p build/cppcheck
# Two style rules are off: starting two bounds at one value is what bounds do, and a heap compares by index and key.
# shellcheck disable=SC2086 # the list is meant to be split
cppcheck --quiet --std=c17 --language=c --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
    --suppress=missingIncludeSystem --suppress=duplicateAssignExpression --suppress=arrayIndexThenCheck --cppcheck-build-dir=build/cppcheck -j "$(nproc)" -I . -D__GNUC__=12 \
    $(find $folders -name '*.c')
echo 'static analysis is clean'
