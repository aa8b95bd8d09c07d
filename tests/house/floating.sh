#!/bin/sh
# The digits of the tables do not depend on the compiler, its optimisation, FMA instructions or the number of threads, and
# nothing raises a floating-point exception. Usage: floating.sh SOURCE REFERENCE_PROGRAM [CLOUD...]
#
# The program is built anew in build/floating: with gcc -O0 (and -ftrapping-math), gcc -O2, gcc -O3 -mfma, clang -O2:
# traits.csv and plants.csv have to be the reference's byte for byte, with 1 and with 2 threads, and with a C library that is
# told that the processor has no FMA. One more build, gcc -O3 -mfma -ffp-contract=fast, lets the compiler fuse what the
# project forbids it to fuse: points near a tie then go to the other organ, and an organ near the limit of what can be
# measured to the other side of it. What that changes is told; only its rows have to be the same, and 99 of 100 states.
# The -O0 build runs with invalid operations, divisions by zero and overflows trapped, also on virtual plants of other kinds.
# FLOATING_BUILDS: those to make, of O0 O2 clang fma contract; all if unset. O0 is always made.
set -eu
source=$1
reference=$2
shift 2
[ $# -gt 0 ] || set -- "$source"/examples/data/*.ply
builds=$source/build/floating
wanted=" ${FLOATING_BUILDS:-O0 O2 clang fma contract} "
tables=$(mktemp -d)
trap 'rm -rf "$tables"' EXIT
failures=0
fail() {
    echo "floating: $1"
    failures=$((failures + 1))
}

wants() {
    case $wanted in *" $1 "*) return 0 ;; esac
    return 1
}
for build in $wanted; do
    case $build in O0 | O2 | clang | fma | contract) ;; *) echo "floating: no build $build"; exit 2 ;; esac
done

# build NAME CC CXX FLAGS ARITHMETIC
build() {
    cmake -S "$source" -B "$builds/$1" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_C_COMPILER="$2" -DCMAKE_CXX_COMPILER="$3" \
        -DCMAKE_C_FLAGS="$4" -DCMAKE_CXX_FLAGS="$4" "-DPLANTIMETER_ARITHMETIC=$5" -DPLANTIMETER_TESTS=OFF \
        -DPLANTIMETER_BENCH=OFF >"$tables/built" || { cat "$tables/built"; exit 1; }
    cmake --build "$builds/$1" --target plantimeter >"$tables/built" || { tail -30 "$tables/built"; exit 1; }
}

# measure PROGRAM THREADS FOLDER CLOUD...
measure() {
    measuring=$1 threads=$2 into=$tables/$3
    shift 3
    "$measuring" measure "$@" --threads "$threads" --files tables -o "$into" -q || fail "$measuring ends with code $?"
}

# same FOLDER WHAT: byte for byte
same() {
    for table in traits.csv plants.csv; do
        cmp -s "$tables/reference/$table" "$tables/$1/$table" && continue
        fail "$table of $2 is not the reference's:"
        diff "$tables/reference/$table" "$tables/$1/$table" | head -6 || true
    done
    echo "compared byte for byte: $2"
}

# tell FOLDER WHAT: how many values differ, and by how much
tell() {
    awk -F, 'function abs(x) { return x < 0 ? -x : x }
        NR == FNR { row[FNR] = $0; rows = FNR; next }
        {
            split(row[FNR], was, ",")
            if ($1 $2 $3 $7 != was[1] was[2] was[3] was[7]) { print "was " row[FNR] "\nis  " $0; bad++ }
            else if ($12 != was[12]) { print "was " row[FNR] "\nis  " $0; states++ }
            else if ($8 != was[8]) {
                changed++
                change = abs($8 - was[8])
                if (was[10] > 0 && change > most * was[10]) most = change / was[10]
            }
        }
        END {
            printf "told, not held: %d of %d values have other digits, the farthest by %.1e standard errors\n", changed, FNR - 1, most
            exit bad > 0 || rows != FNR || 100 * states > FNR
        }' "$tables/reference/traits.csv" "$tables/$1/traits.csv" || fail "rows or states of $2 are others"
    echo "compared by rows and states: $2"
}

measure "$reference" 1 reference "$@"
measure "$reference" 2 release_2 "$@"
same release_2 'the release build, 2 threads'
GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2 measure "$reference" 1 plain "$@"
same plain 'the release build, C library without FMA and AVX2'

fused=
if [ "$(uname -m)" = x86_64 ] && grep -qw fma /proc/cpuinfo; then fused=-mfma; fi
build O0 gcc g++ '-O0 -g1' -ffp-contract=off
if wants O2; then build O2 gcc g++ '-O2 -DNDEBUG' '-ffp-contract=off;-fno-math-errno;-fno-trapping-math'; fi
for variant in O0 O2; do
    [ $variant = O0 ] || wants $variant || continue
    for threads in 1 2; do
        measure "$builds/$variant/plantimeter" $threads ${variant}_$threads "$@"
        same ${variant}_$threads "gcc -$variant, $threads threads"
    done
done
if wants clang && command -v clang++ >/dev/null; then
    build clang clang clang++ '-O2 -DNDEBUG' '-ffp-contract=off;-fno-math-errno;-fno-trapping-math'
    for threads in 1 2; do
        measure "$builds/clang/plantimeter" $threads clang_$threads "$@"
        same clang_$threads "clang -O2, $threads threads"
    done
fi
if [ -n "$fused" ] && wants fma; then
    build fma gcc g++ "-O3 $fused -DNDEBUG" '-ffp-contract=off;-fno-math-errno;-fno-trapping-math'
    measure "$builds/fma/plantimeter" 1 fma "$@"
    same fma 'gcc -O3 -mfma'
fi
if [ -n "$fused" ] && wants contract; then
    build contract gcc g++ "-O3 $fused -DNDEBUG" '-ffp-contract=fast;-fno-math-errno;-fno-trapping-math'
    measure "$builds/contract/plantimeter" 1 contract "$@"
    tell contract 'gcc -O3 -mfma -ffp-contract=fast'
fi
if [ "$(uname -m)" = x86_64 ]; then
    gcc -O1 -shared -fPIC "$source/tests/house/trap.c" -o "$tables/trap.so" -lm
    # The trap sees what it should see, and only that.
    printf '%s\n' '#include <stdlib.h>' 'int main(int count, char **words)' \
        '{ volatile double zero = count - 1, one = atof(words[0] + 0) + 1; return count > 1 ? 0 : one / zero < 0; }' >"$tables/divides.c"
    gcc "$tables/divides.c" -o "$tables/divides"
    LD_PRELOAD=$tables/trap.so "$tables/divides" 2>&1 | grep -q 'trap: divide by zero' || fail 'the trap sees no division by zero'
    LD_PRELOAD=$tables/trap.so "$tables/divides" 1 2>&1 | grep -q trap && fail 'the trap sees what is not there'
    LD_PRELOAD=$tables/trap.so "$builds/O0/plantimeter" measure "$@" --threads 2 -o "$tables/trapped" -q 2>"$tables/traps" ||
        fail "the trapped run ends with code $?"
    # maize 63003: a level of one row of cells was tried as a pot, and divided by its width
    "$reference" simulate maize arabidopsis soybean tomato --seed 63003 --scanner splat --points 60000 -q -o "$tables/plants"
    for kind in maize arabidopsis soybean tomato; do
        LD_PRELOAD=$tables/trap.so "$builds/O0/plantimeter" measure "$tables/plants/${kind}_63003_splat.ply" --threads 2 \
            --files tables -o "$tables/plants/$kind" -q 2>>"$tables/traps" || fail "the trapped run of $kind ends with code $?"
    done
    if grep -q 'floating-point trap' "$tables/traps"; then
        fail 'floating-point exceptions are raised:'
        awk '/^floating/ { print; left = 4 } /plantimeter\(/ && left-- > 0 { gsub(/.*\(\+?|\).*/, ""); print }' "$tables/traps" |
            while read -r line; do
                case $line in
                    0x*) addr2line -fpe "$builds/O0/plantimeter" "$line" ;;
                    *) echo "$line" ;;
                esac
            done
    else
        echo 'no floating-point exception in the trapped run'
    fi
    same trapped 'the trapped run'
fi
[ $failures -eq 0 ] || exit 1
