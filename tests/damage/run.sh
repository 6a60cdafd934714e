#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/damage/run.sh
#        LONG=1: the golden files and meshes baked in other ways; 500,000 flips
#
# Every prefix and every flipped bit of small files, see damage.c.
set -u
build=$(dirname "$PMESH")
suite=damage
. tests/harness.sh
golden=tests/golden
files="$golden/triangle $golden/pieces $golden/hub $golden/hubs $golden/cuts
    $golden/joined $golden/measured"

# Options of bake: a file each, of a mesh with all that formats carry.
bake_all() {
    "$PMESH" extract -q $golden/seam.pmesh -o "$dir/seam.ply" || return 1
    n=0
    while read -r options; do
        n=$((n + 1))
        # shellcheck disable=SC2086 # words on purpose
        "$PMESH" bake -q $options "$dir/seam.ply" -o "$dir/$n.pmesh" ||
            return 1
        files="$files $dir/$n"
    done <<'END'
--lossless
--lossless --placement optimal
--bits 24 --profile compact
--bits 6 --profile quality
--measure --lossless
--topology join
END
}

every_promise_is_kept() {
    # shellcheck disable=SC2086 # words on purpose
    "$build/damage" "$1" $(printf '%s.pmesh ' $files)
}

if [ -n "${LONG-}" ]; then
    try bake_all
    files="$files $(ls $golden/*.pmesh | sed 's/\.pmesh$//')"
    every_promise_is_kept 60000 >"$dir/all"
    status=$?
    cat "$dir/all"
    try 'every promise is kept' test $status = 0
    try '500,000 flips' test "$(sed -n \
        's/^all: .*; \([0-9]*\) bits flipped.*/\1/p' "$dir/all")" -ge 500000
else
    try 'every promise is kept' every_promise_is_kept 0
fi
summary
