#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/damage/run.sh
#        LONG=1: the golden files and meshes baked in other ways; 500,000 flips,
#        100,000 edits
#
# Every prefix and every flipped bit of small files, and edits: see damage.c.
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
--position-bits 24 --profile compact
--position-bits 6 --profile quality
--measure --lossless
--topology join
END
}

every_promise_is_kept() {
    # shellcheck disable=SC2086 # words on purpose
    "$build/damage" 0 500 $(printf '%s.pmesh ' $files)
}

# Keeps the line at the end: what all files together came to.
tell() {
    "$build/damage" "$@" >"$dir/told"
    status=$?
    cat "$dir/told"
    grep '^all: ' "$dir/told" >>"$dir/all"
    return $status
}

# total WORDS: the sum of their numbers in these lines.
total() {
    sed -n "s/.*; \([0-9]*\) $1,.*/\1/p" "$dir/all" |
        awk '{ sum += $1 } END { print sum + 0 }'
}

if [ -n "${LONG-}" ]; then
    try bake_all
    for file in $files $(ls $golden/*.pmesh | sed 's/\.pmesh$//'); do
        echo "$file.pmesh"
    done | sort -u >"$dir/list"
    small=$(xargs -I{} find {} -size -11b <"$dir/list")
    large=$(xargs -I{} find {} -size +10b <"$dir/list")
    # shellcheck disable=SC2086 # words on purpose
    try 'small files, all bits' tell 0 4000 $small
    cat "$dir/told"
    # shellcheck disable=SC2086
    try 'larger files, 20,000 bits each' tell 20000 4000 $large
    cat "$dir/told"
    flips=$(total 'bits flipped')
    edits=$(total edits)
    echo "$flips bits flipped, $edits edits"
    try '500,000 flips' test "$flips" -ge 500000
    try '100,000 edits' test "$edits" -ge 100000
else
    try 'every promise is kept' every_promise_is_kept
fi
summary
