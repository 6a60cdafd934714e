#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/spec/run.sh
#
# SPEC.md against the code: the worked example is what the program writes, the
# tables of appendix C are those of format/tables.c, and every section that a
# message names exists.
set -u
suite=spec
. tests/harness.sh

# The lines of a part of SPEC.md, from a heading to the next of its level.
part() {
    awk -v from="$1" 'index($0, "## ") == 1 { on = index($0, from) == 1 } on' \
        SPEC.md
}

example_is_what_the_program_writes() {
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n' >"$dir/t.obj"
    printf 'f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >>"$dir/t.obj"
    "$PMESH" bake -q "$dir/t.obj" -o "$dir/t.pmesh" || return 1
    part "## Appendix B" | sed -n 's/^[0-9a-f]\{8\}: //p' | tr -s ' \n' '\n\n' |
        sed '/^$/d' >"$dir/spec"
    od -An -v -tx1 "$dir/t.pmesh" | tr -s ' \n' '\n\n' | sed '/^$/d' \
        >"$dir/file"
    test -s "$dir/spec" && cmp "$dir/spec" "$dir/file"
}

tables_are_those_of_the_code() {
    part "## Appendix C" | awk '/^```/ { on = !on; next } on' |
        tr -s ' ' '\n' >"$dir/spec"
    sed -n 's/,//g; s/^        //p' format/tables.c | tr -s ' ' '\n' \
        >"$dir/code"
    test -s "$dir/spec" && cmp "$dir/spec" "$dir/code"
}

sections_exist() {
    grep -rhoE 'SPEC [0-9]+(\.[0-9]+)?' format decoder encoder | sort -u |
        while read -r _ section; do
            grep -qE "^##+ $section " SPEC.md || {
                echo "no section $section"
                exit 1
            }
        done
}

try example_is_what_the_program_writes
try tables_are_those_of_the_code
try sections_exist
summary
