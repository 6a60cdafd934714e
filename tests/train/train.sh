#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: TRAIN=build/release/train tests/train/train.sh MESH...
#
# Makes the tables that streams start from anew: format/tables.c and appendix C
# of SPEC.md. Meshes named here are not to be measured with these tables.
set -eu
new=$(mktemp) || exit 1
trap 'rm -f "$new"' EXIT
"$TRAIN" "$@" >"$new"
cp "$new" format/tables.c

dimensions='shape [3][2][2] reach [2][2] degree [12][2] state [5][5][5][2]
    span [2][14][10] predict [3][9][3][7][2] along [2][9][3][5]
    across [2][14][3] flag [1680] rank [2][4][32] residual [60][20]
    low [60][3]'
awk '{ print } /^## Appendix C/ { on = 1 } on && /^$/ && ++blank == 2 { exit }' \
    SPEC.md >"$new"
awk -v dimensions="$dimensions" '
    BEGIN {
        n = split(dimensions, word)
        for (i = 1; i < n; i += 2)
            size[word[i]] = word[i + 1]
    }
    / = \{$/ && /^    \./ {
        name = substr($1, 2)
        printf "%s%s:\n\n```\n", toupper(name), size[name]
        line = ""
        next
    }
    /^    }/ { print line; printf "```\n\n"; next }
    /^        / {
        gsub(",", "")
        for (i = 1; i <= NF; i++) {
            if (length(line) + length($i) > 79) {
                print line
                line = ""
            }
            line = line == "" ? $i : line " " $i
        }
    }' format/tables.c >>"$new"
# No blank line at the end.
sed -e :a -e '/^\n*$/{$d;N;ba' -e '}' "$new" >SPEC.md
