#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/corrupt/run.sh [LIST]
#
# Files that break one rule of SPEC.md each, made field by field by the program
# `corrupt`: the decoder names status, offset and rule as expected, `pmesh
# verify` refuses them all, and every rule has a file (musts.txt). With LIST,
# writes the rules and their files there.
set -u
build=$(dirname "$PMESH")
suite=corrupt
. tests/harness.sh
mkdir "$dir/files"

decoder_answers_as_expected() {
    "$build/corrupt" "$dir/files" >"$dir/answers"
}

there_are_as_many_as_promised() {
    [ "$(wc -l <"$dir/answers")" -ge 200 ] &&
        [ "$(cut -f 1 "$dir/answers" | sort | uniq -d | wc -l)" = 0 ]
}

# Exit code 4, and a message that names byte and rule; but a file that is none
# is only called that.
verify_refuses_them_all() {
    while IFS='	' read -r name status offset rule; do
        "$PMESH" verify -q "$dir/files/$name.pmesh" 2>"$dir/message"
        code=$?
        expected="byte $offset: .*($rule); "
        [ "$status" != -10 ] ||
            expected=': not a .pmesh file; no level is good'
        [ $code = 4 ] && grep -q "$expected" "$dir/message" || {
            echo "$name: exit code $code, $(cat "$dir/message")"
            return 1
        }
    done <"$dir/answers"
}

# Each line of musts.txt is in SPEC.md; without them, SPEC.md has no MUST left.
every_must_has_its_file() {
    cut -f 1 "$dir/answers" >"$dir/names"
    awk -v names="$dir/names" -f tests/corrupt/musts.awk SPEC.md \
        tests/corrupt/musts.txt >"$dir/list"
    status=$?
    [ $status = 0 ] || cat "$dir/list"
    return $status
}

try decoder_answers_as_expected
try there_are_as_many_as_promised
try verify_refuses_them_all
try every_must_has_its_file
[ $# -eq 0 ] || cp "$dir/list" "$1"
tail -n 1 "$dir/list"
summary
