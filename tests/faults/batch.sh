#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/faults/batch.sh MESHES KILLS
#
# Bakes the models of PMESH_MODELS and so many generated meshes by `pmesh batch`,
# killed so often before it would be done, and resumed: outputs are whole or
# missing each time, and in the end those of an undisturbed run. A part of
# `make check-faults`.
set -u
suite=batch
. tests/harness.sh
case $PMESH in
/*) ;;
*) PMESH=$PWD/$PMESH ;;
esac
meshes=$1
kills=$2

# grid N SIZE: a wavy plane, each with other waves.
make_meshes() {
    mkdir "$dir/in" "$dir/in/made"
    i=0
    while [ $i -lt "$meshes" ]; do
        awk -v n=$((10 + i % 30)) -v k="$i" 'BEGIN {
            for (i = 0; i <= n; i++) for (j = 0; j <= n; j++)
                print "v", i, j, 2 * sin(i * (k + 3) / 40) * cos(j / 5)
            for (i = 0; i < n; i++) for (j = 1; j <= n; j++) {
                p = i * (n + 1) + j
                print "f", p, p + n + 1, p + 1
                print "f", p + 1, p + n + 1, p + n + 2
            }
        }' >"$dir/in/made/$i.obj"
        i=$((i + 1))
    done
    [ -z "${PMESH_MODELS-}" ] || ln -s "$PMESH_MODELS" "$dir/in/models"
    inputs="$dir/in/made ${PMESH_MODELS:+$PMESH_MODELS}"
}

all_whole() {
    find "$dir/out" -name '*.pmesh' >"$dir/list"
    while read -r file; do
        "$PMESH" verify -q "$file" || return 1
    done <"$dir/list"
    wc -l <"$dir/list" >>"$dir/counts"
}

# Milliseconds since some moment.
now() {
    echo $(($(date +%s%N) / 1000000))
}

undisturbed() {
    start=$(now)
    # shellcheck disable=SC2086 # words on purpose
    "$PMESH" batch $inputs -o "$dir/calm" -q -j 2
    result=$?
    took=$(($(now) - start))
    return $result
}

# Children end what they have begun: they are not killed with their parent. All
# runs together take about what one does that is left alone.
killed_and_resumed() {
    k=0
    mkdir "$dir/out"
    while [ $k -lt "$kills" ]; do
        delay=$(awk -v k="$k" -v n="$kills" -v ms="$took" \
            'BEGIN { srand(k); print (0.5 + rand()) * ms / 1000 / (n + 1) }')
        # shellcheck disable=SC2086 # words on purpose
        timeout -s KILL "$delay" "$PMESH" batch $inputs -o "$dir/out" -q -j 2 \
            --resume 2>/dev/null
        all_whole || return 1
        k=$((k + 1))
    done
    # shellcheck disable=SC2086
    "$PMESH" batch $inputs -o "$dir/out" -j 2 --resume
}

left_undone() {
    [ "$(head -n 1 "$dir/counts")" -lt "$(find "$dir/calm" -name '*.pmesh' |
        wc -l)" ]
}

as_if_undisturbed() {
    diff -r -x '.pmesh-*' "$dir/out" "$dir/calm"
}

make_meshes
try 'undisturbed' undisturbed
try 'killed and resumed' killed_and_resumed
tail -n 1 "$dir/log"
echo "files after each kill: $(tr '\n' ' ' <"$dir/counts")"
try 'killed before the end' left_undone
try 'the same files as undisturbed' as_if_undisturbed
find "$dir/calm" -name '*.pmesh' | wc -l
summary
