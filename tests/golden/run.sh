#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/golden/run.sh
#
# The golden files decode to what hashes.txt says. They are what a decoder of
# this version of the format reads for ever: when this test fails, either the
# decoder is wrong or the format changed and has a new version. Version 0 is a
# draft: its files are made again, by `make golden`, with every change.
set -u
golden=tests/golden
build=$(dirname "$PMESH")
suite=golden
. tests/harness.sh

hashes_are_those_on_record() {
    "$build/golden_decode" $golden/*.pmesh >"$dir/hashes" || return 1
    diff $golden/hashes.txt "$dir/hashes"
}

files_verify() {
    for file in "$golden"/*.pmesh; do
        "$PMESH" verify "$file" || return 1
    done
}

# The encoder may change its mind about a mesh, but must still make a set that
# reaches every kind of chunk, from all the meshes, whatever the threads.
set_can_be_made() {
    mkdir "$dir/one" "$dir/two"
    "$build/golden_bake" "$dir/one" 1 && "$build/golden_bake" "$dir/two" 2 &&
        diff -r "$dir/one" "$dir/two" &&
        (cd "$dir/one" && ls) >"$dir/made" &&
        (cd $golden && ls ./*.pmesh) | sed 's|^\./||' | diff "$dir/made" -
}

set_is_small() {
    test "$(cat $golden/*.pmesh | wc -c)" -lt 300000
}

every_option_is_in_some_file() {
    for file in "$golden"/*.pmesh; do
        "$PMESH" info --json "$file" || return 1
    done >"$dir/info"
    for word in '"compact"' '"balanced"' '"quality"' '"subset"' '"optimal"' \
        '"normal"' '"texcoord"' '"color"' '"generic"' '"moss"' \
        '"position_bits": 4,' '"position_bits": 24,'; do
        grep -q "$word" "$dir/info" || { echo "none has $word"; return 1; }
    done
}

try hashes_are_those_on_record
try files_verify
try set_can_be_made
try set_is_small
try every_option_is_in_some_file
summary
