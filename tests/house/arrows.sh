#!/bin/sh
# Includes go downward only (docs/architecture.md). Reads the #include lines of every module and fails on an upward arrow.
set -eu
cd "$1"
allowed() {
    case $1 in
        cloud) echo 'cloud' ;;
        io) echo 'cloud|io' ;;
        segment) echo 'cloud|segment' ;;
        mesh) echo 'cloud|mesh' ;;
        simulate) echo 'cloud|io|simulate' ;;
        rebuild) echo 'cloud|io|mesh|rebuild' ;;
        traits) echo 'cloud|io|segment|mesh|traits' ;;
        reports) echo 'cloud|io|traits|reports' ;;
        selftest) echo 'cloud|io|segment|mesh|traits|selftest' ;;
    esac
}
bad=0
for module in cloud io segment mesh simulate rebuild traits reports selftest; do
    [ -d "$module" ] || continue
    found=$(grep -rnE '^ *# *include "' "$module" --include='*.c' --include='*.h' --include='*.cpp' --include='*.hpp' |
        sed -E 's/^([^:]+:[0-9]+):.*"(\.\.\/)?([^"]+)".*/\1 \3/' |
        grep -E ' (cloud|io|segment|mesh|simulate|rebuild|traits|reports|selftest|tool|tests|bench)/' |
        grep -vE " ($(allowed "$module"))/" || true)
    [ -z "$found" ] || { echo "$module includes upward or sideways:"; echo "$found"; bad=1; }
done
names=$(find cloud io segment mesh simulate rebuild traits reports selftest tool -name '*.c' -o -name '*.cpp' | sed 's|.*/||' | sort | uniq -d)
[ -z "$names" ] || { echo "file names that stand in two folders: $names"; bad=1; }
[ "$bad" -eq 0 ] && echo 'arrows go downward'
exit "$bad"
