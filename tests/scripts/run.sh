#!/bin/sh
# Runs one script test in an empty folder. Usage: run.sh PROGRAM SOURCE_FOLDER NAME
set -u
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
sh "$2/tests/scripts/$3.sh" "$1" "$2"
