#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/size.sh
# Bytes of complete files at 12 bits, positions only: Draco's best compression
# against every profile. Writes size.csv and prints it with sums and geometric
# means of pmesh / Draco.
. tests/bench/common.sh
need draco_encoder "make bench-deps"
dir=$OUT/size
mkdir -p "$dir"

{
    echo model,faces,draco,compact,balanced,quality
    models | while read -r model; do
        name=$(basename "$model" .obj)
        positions_only "$model" >"$dir/$name.obj"
        draco_encoder -i "$dir/$name.obj" -o "$dir/$name.drc" -cl 10 -qp 12 \
            >"$dir/$name.draco.log"
        row=$name,$(faces "$dir/$name.obj"),$(bytes "$dir/$name.drc")
        for profile in compact balanced quality; do
            "$PMESH" bake -q "$dir/$name.obj" --profile $profile \
                --position-bits 12 --no-attributes \
                -o "$dir/$name.$profile.pmesh" >/dev/null
            row=$row,$(bytes "$dir/$name.$profile.pmesh")
        done
        echo "$row"
    done
} >"$OUT/size.csv"

awk -F , '
    NR == 1 { split($0, title); printf row, $1, $2, $3, $4, $5, $6 }
    NR > 1 {
        printf row, $1, $2, $3, $4, $5, $6
        for (i = 2; i <= 6; i++) {
            sum[i] += $i
            mean[i] += log($i / $3)
        }
    }
    END {
        n = NR - 1
        if (n < 1) { print "no models"; exit 1 }
        printf row, "sum", sum[2], sum[3], sum[4], sum[5], sum[6]
        printf "%-12s %8s %8.3f %8.3f %8.3f %8.3f\n", "sum/draco", "", 1,
            sum[4] / sum[3], sum[5] / sum[3], sum[6] / sum[3]
        printf "%-12s %8s %8.3f %8.3f %8.3f %8.3f\n", "geo. mean", "", 1,
            exp(mean[4] / n), exp(mean[5] / n), exp(mean[6] / n)
    }' row='%-12s %8s %8s %8s %8s %8s\n' "$OUT/size.csv"
