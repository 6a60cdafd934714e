#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/decode.sh
#
# Time to decode complete files, positions only, against Draco's decoder on its
# best compression, both in one process and on one core: see bench_decode.cpp.
# Writes decode.csv and prints it with geometric means.
# MODELS: "bunny koala armadillo"; set but empty: all. KINDS: of pmesh files
# ("compact balanced quality"). BITS: of positions (12); PAIRS: of runs (9).
MODELS=${MODELS-bunny koala armadillo}
. tests/bench/common.sh
kinds=${KINDS:-compact balanced quality}
grid=${BITS:-12}
need draco_encoder "make bench-deps"
need "$tools/bench_decode" "make bench-decode"
dir=$OUT/decode
mkdir -p "$dir"

{
    echo model,profile,faces,splits,pmesh_ms,draco_ms,ratio,msplits_per_s
    models | while read -r model; do
        name=$(basename "$model" .obj)
        progress "$name"
        positions_only "$model" >"$dir/$name.obj"
        draco "$dir/$name.obj" "$dir/$name.drc" "$grid"
        for kind in $kinds; do
            bake "$dir/$name.obj" "$dir/$name.$kind.pmesh" "$kind" "$grid"
            times=$("$tools/bench_decode" "${PAIRS:-9}" \
                "$dir/$name.$kind.pmesh" "$dir/$name.drc")
            echo "$name,$kind,$times"
        done
    done
} >"$OUT/decode.csv"

awk -F , '
    { printf "%-12s %-9s %8s %8s %9s %9s %7s %s\n", $1, $2, $3, $4, $5, $6, $7,
        $8 }
    NR > 1 {
        if (!($2 in n)) kind[++kinds] = $2
        n[$2]++
        ratio[$2] += log($7)
        speed[$2] += log($8)
    }
    END {
        for (k = 1; k <= kinds; k++)
            printf "%-9s geometric mean: %.2f times the time of Draco, " \
                "%.2f million splits/s\n", kind[k],
                exp(ratio[kind[k]] / n[kind[k]]),
                exp(speed[kind[k]] / n[kind[k]])
    }' "$OUT/decode.csv"
