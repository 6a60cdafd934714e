#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/quality.sh
#
# Surface distance at equal face counts: levels of pmesh files, and meshes of
# pmesh simplify, against the results of meshoptimizer and CGAL.
#
# Writes quality.csv and prints geometric means relative to CGAL's
# Lindstrom-Turk, of the cases that met the face count within 2 %.
# BITS: of the positions (14); PERCENTS: levels to compare (50 10 1); MESHDIST:
# see common.sh.
. tests/bench/common.sh
bits=${BITS:-14}
percents=${PERCENTS:-50 10 1}
need "$tools/bench_simplify" "make bench-quality"
dir=$OUT/quality
mkdir -p "$dir"

# measure MODEL TOOL PERCENT TARGET CPU LEVEL: one row
measure() {
    distance=$(rms "$1" "$6")
    echo "$(basename "$1" .obj),$2,$3,$4,$(faces "$6"),$distance,$5"
}

# ours MODEL KIND
ours() {
    # shellcheck disable=SC2086,SC2046 # words on purpose
    bake "$1" "$dir/$2.pmesh" "$2" "$bits" \
        --base-faces $(base_faces "$1" $percents)
    for percent in $percents; do
        want=$(target "$1" "$percent")
        rm -f "$dir/level.obj"
        "$PMESH" extract -q "$dir/$2.pmesh" --faces "$want" \
            -o "$dir/level.obj" || [ $? = 5 ] # the base mesh is finer
        if [ -e "$dir/level.obj" ]; then
            measure "$1" "$2" "$percent" "$want" 0 "$dir/level.obj"
        fi
    done
}

# simplify MODEL PLACEMENT
simplify() {
    for percent in $percents; do
        want=$(target "$1" "$percent")
        "$PMESH" simplify "$1" -q --no-attributes --placement "$2" \
            --faces "$want" -o "$dir/level.obj"
        measure "$1" "simplify-$2" "$percent" "$want" 0 "$dir/level.obj"
    done
}

{
    echo model,tool,percent,target,faces,rms,cpu_s
    models | while read -r model; do
        progress "$(basename "$model" .obj)"
        # shellcheck disable=SC2086 # words on purpose
        "$tools/bench_simplify" "$model" "$dir" $percents >"$dir/peers.csv"
        while IFS=, read -r tool percent target _ cpu; do
            measure "$model" "$tool" "$percent" "$target" "$cpu" \
                "$dir/${tool}_$percent.obj"
        done <"$dir/peers.csv"
        for kind in balanced quality optimal; do
            ours "$model" "$kind"
        done
        for placement in optimal endpoint; do
            simplify "$model" "$placement"
        done
    done
} >"$OUT/quality.csv"

awk -F , -v percents="$percents" '
    NR > 1 {
        if (!($2 in seen)) { seen[$2]; order[++tools] = $2 }
        if ($5 <= 1.02 * $4 && $5 >= 0.98 * $4 && $6 > 0)
            rms[$1, $2, $3] = $6
        models[$1]
    }
    END {
        n = split(percents, percent, " ")
        printf "%-17s", "rms / LT"
        for (p = 1; p <= n; p++)
            printf " %9s%% (n)", percent[p]
        print ""
        for (t = 1; t <= tools; t++) {
            printf "%-17s", order[t]
            for (p = 1; p <= n; p++) {
                sum = count = 0
                for (m in models) {
                    base = rms[m, "cgal-lt", percent[p]]
                    own = rms[m, order[t], percent[p]]
                    if (base > 0 && own > 0) { sum += log(own / base); count++ }
                }
                printf " %10s (%d)", \
                    count ? sprintf("%.3f", exp(sum / count)) : "-", count
            }
            print ""
        }
    }' "$OUT/quality.csv"
