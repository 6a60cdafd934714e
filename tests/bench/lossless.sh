#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/lossless.sh
# What the exact positions of --lossless cost at 12, 14 and 16 bits, positions
# only, in bits per vertex: of the layer, and of the complete file. The floats
# themselves are 96. Writes lossless.csv and prints it with the means.
. tests/bench/common.sh
dir=$OUT/lossless
mkdir -p "$dir"

number() {
    sed -n "s/.*\"$1\": \([0-9]*\).*/\1/p" "$dir/report" | head -n 1
}

{
    echo model,vertices,layer 12,file 12,layer 14,file 14,layer 16,file 16
    models | while read -r model; do
        row=
        for bits in 12 14 16; do
            "$PMESH" bake --json --lossless "$model" --position-bits $bits \
                --no-attributes -o "$dir/a.pmesh" >"$dir/report"
            row=$row,$(number lossless),$(number bytes)
        done
        echo "$(basename "$model" .obj),$(number vertices)$row"
    done
} >"$OUT/lossless.csv"

awk -F , '
    NR == 1 {
        printf "%-12s %8s", $1, $2
        for (i = 3; i <= 8; i++) printf " %8s", $i
        print ""
    }
    NR > 1 {
        printf "%-12s %8d", $1, $2
        n += $2
        for (i = 3; i <= 8; i++) {
            printf " %8.2f", 8 * $i / $2
            sum[i] += $i
        }
        print ""
    }
    END {
        if (n < 1) { print "no models"; exit 1 }
        printf "%-12s %8d", "all", n
        for (i = 3; i <= 8; i++) printf " %8.2f", 8 * sum[i] / n
        print ""
    }' "$OUT/lossless.csv"
