#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/fuzz/coverage.sh build/coverage
#
# Lines and branches of decoder/ and format/ that are reached by the unit tests,
# by the targets with their committed corpus and with what fuzzing left in
# build/corpus: a table for each file, by llvm-cov. Lines that are not reached
# are listed in BUILD/coverage.txt.
set -eu
build=$1
profiles=$build/profiles
rm -rf "$profiles"
mkdir -p "$profiles"
objects="$build/unit"

for program in "$build"/fuzz/*; do
    name=$(basename "$program")
    set --
    for folder in tests/fuzz/corpus/$name build/corpus/$name \
        build/seeds/$name; do
        [ ! -d "$folder" ] || set -- "$@" "$folder"
    done
    case $name in
    dec_* | tool_*) set -- "$@" tests/golden ;;
    esac
    LLVM_PROFILE_FILE=$profiles/$name.raw "$program" -q "$@" \
        >/dev/null 2>&1 || echo "$name: a file fails"
    objects="$objects -object $program"
done
table() {
    # shellcheck disable=SC2086 # words on purpose
    llvm-profdata merge -o "$build/$1.data" $2
    # shellcheck disable=SC2086
    llvm-cov report $objects -instr-profile="$build/$1.data" \
        --show-branch-summary --show-region-summary=false decoder format
}
echo "== the targets alone"
table fuzz "$profiles/*.raw"
LLVM_PROFILE_FILE=$profiles/unit.raw "$build/unit" >/dev/null
echo "== with the unit tests"
table all "$profiles/*.raw"
# shellcheck disable=SC2086
llvm-cov show $objects -instr-profile="$build/all.data" decoder format |
    grep -E '^ *[0-9]+\| *0\||^[^ ].*:$' >"$build/coverage.txt"
echo "lines that are not reached: $build/coverage.txt"
