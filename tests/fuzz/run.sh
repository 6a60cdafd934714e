#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/fuzz/run.sh
#
# Every target takes its files below corpus/ and, if it decodes streams, the
# golden ones. The corpus is what fuzzing found, by the name of the mistake, and
# small files that together reach far (reach-NN).
set -u
build=$(dirname "$PMESH")
suite=fuzz
. tests/harness.sh
export ASAN_OPTIONS="allocator_may_return_null=1"

replay() {
    "$build/fuzz/$1" -q "$corpus" $golden
}

corpus_is_small() {
    test "$(cat tests/fuzz/corpus/*/* | wc -c)" -lt 300000
}

# No target is forgotten, and no folder of files without its target.
every_target_has_files() {
    for program in "$build"/fuzz/*; do
        ls tests/fuzz/corpus/"$(basename "$program")"/* >"$dir/files" ||
            return 1
    done
    for folder in tests/fuzz/corpus/*; do
        test -e tests/fuzz/target_"$(basename "$folder")".c || return 1
    done
}

driver_fails_without_files() {
    ! "$build/fuzz/number" -q "$dir/none"
}

try corpus_is_small
try every_target_has_files
try driver_fails_without_files
for corpus in tests/fuzz/corpus/*; do
    name=$(basename "$corpus")
    case $name in
    dec_scene | tool_scene) golden=tests/golden/scene.pmesh ;;
    dec_* | tool_*) golden=$(find tests/golden -name '*.pmesh' -size -12k) ;;
    *) golden= ;;
    esac
    try "$name" replay "$name"
done
summary
