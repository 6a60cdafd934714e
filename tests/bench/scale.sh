#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/scale.sh
#
# Time and memory by face of generated meshes of 70 thousand to 8 million faces:
# contractions with their log, whole bake, decode, and meshopt_simplify for
# comparison. Writes scale.csv and scale.svg; prints the growth from the
# smallest to the largest mesh. SIZES: faces; RUNS: rounds (3).
. tests/bench/common.sh
sizes=${SIZES:-70000 250000 1000000 2000000 4000000 8000000}
need "$tools/bench_speed" "make bench-scale"
need python3 "make bench-deps"
mkdir -p "$OUT"

{
    echo faces,what,us_per_face,bytes_per_face
    for size in $sizes; do
        progress "$size faces"
        "$tools/bench_speed" "${RUNS:-3}" scale "$size"
    done
} >"$OUT/scale.csv"
machine >"$OUT/scale-machine.txt"
cat "$OUT/scale-machine.txt"
awk -F , '
    { printf "%9s %-22s %12s %15s\n", $1, $2, $3, $4 }
    NR == 1 { next }
    !($2 in first) { names[++n] = $2; first[$2] = $3 }
    { last[$2] = $3 }
    END {
        for (i = 1; i <= n; i++)
            printf "time per face, largest / smallest mesh: %-22s %.2f%s\n",
                names[i], last[names[i]] / first[names[i]],
                names[i] ~ /meshopt/ ? "" : " (must <2)"
    }' "$OUT/scale.csv"
python3 tests/bench/plot.py scale "$OUT/scale.csv" "$OUT/scale.svg"
