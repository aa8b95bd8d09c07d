#!/bin/sh
# Every source file is as clang-format would write it.
set -eu
cd "$1"
git ls-files '*.c' '*.h' '*.cpp' '*.hpp' | xargs -r clang-format --dry-run --Werror && echo 'formatting is clean'
