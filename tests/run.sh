#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/run.sh BUILD_DIR
#
# Runs every part of the test suite: the unit tests, the checks of the tree,
# and each tests/*/run.sh with PMESH set to the program. A part may end with a
# line "N passed, N failed"; any other counts as one test by its exit status.
# Prints the sums as the last line; fails if a test did.
set -u
build=$1
PMESH=$PWD/$build/pmesh
export PMESH
passed=0
failed=0
log=$build/part.log

part() {
    printf '== %s\n' "$*"
    { "$@" 2>&1; echo $? >"$log.status"; } | tee "$log"
    status=$(cat "$log.status")
    count=$(tail -n 1 "$log" |
        sed -n 's/^\([0-9]*\) passed, \([0-9]*\) failed$/\1 \2/p')
    if [ -z "$count" ]; then
        if [ "$status" = 0 ]; then count='1 0'; else count='0 1'; fi
    elif [ "$status" != 0 ] && [ "${count#* }" = 0 ]; then
        count="${count% *} 1"
    fi
    if [ "$status" != 0 ]; then
        printf '!! %s: exit status %s\n' "$*" "$status"
    fi
    passed=$((passed + ${count% *}))
    failed=$((failed + ${count#* }))
}

part tests/check-deps.sh
part tests/check-headers.sh
part tests/check-symbols.sh "$build"
part "$build/unit"
for script in tests/*/run.sh; do
    [ ! -e "$script" ] || part sh "$script"
done

rm -f "$log" "$log.status"
echo
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
