#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/quality.sh
#
# Surface distance at equal face counts: levels of pmesh files against the
# results of meshoptimizer and CGAL. The meter is `pmesh compare --json`, or
# MESHDIST for a second opinion: called with ORIGINAL LEVEL, it prints JSON
# with "rms_rel" or else "rms": the two-sided root mean square of the distance,
# relative to the diagonal of the original's bounding box.
#
# Writes quality.csv and prints geometric means relative to CGAL's
# Lindstrom-Turk, of the cases that met the face count within 2 %.
# BITS: of the positions (14); PERCENTS: levels to compare (50 10 1).
. tests/bench/common.sh
bits=${BITS:-14}
percents=${PERCENTS:-50 10 1}
simplify=${PMESH%/*}/bench_simplify
meter=${MESHDIST:-$PMESH compare --json}
need "$simplify" "make bench"
dir=$OUT/quality
mkdir -p "$dir"

# measure MODEL TOOL PERCENT TARGET CPU LEVEL: one row
measure() {
    rms=$($meter "$1" "$6" | tr ',{}' '[\n*]' | awk -F '": *' '
        $1 ~ /"rms$/ { any = $2 }
        $1 ~ /"rms_rel$/ { any = $2; exit }
        END { print any }')
    echo "$(basename "$1" .obj),$2,$3,$4,$(faces "$6"),$rms,$5"
}

target() {
    awk -v n="$(faces "$1")" -v p="$2" \
        'BEGIN { printf "%d\n", n * p / 100 + 0.5 }'
}

# A base mesh no finer than the coarsest level asked for.
base_faces() {
    for percent in $percents; do
        target "$1" "$percent"
    done | awk 'BEGIN { n = 200 } $1 < n { n = $1 } END { print n }'
}

# ours MODEL TOOL BAKE_OPTION...
ours() {
    model=$1
    tool=$2
    shift 2
    "$PMESH" bake -q "$model" --no-attributes --position-bits "$bits" \
        --base-faces "$(base_faces "$model")" "$@" -o "$dir/$tool.pmesh" \
        >/dev/null
    for percent in $percents; do
        want=$(target "$model" "$percent")
        rm -f "$dir/level.obj"
        "$PMESH" extract -q "$dir/$tool.pmesh" --faces "$want" \
            -o "$dir/level.obj" || [ $? = 5 ] # the base mesh is finer
        if [ -e "$dir/level.obj" ]; then
            measure "$model" "$tool" "$percent" "$want" 0 "$dir/level.obj"
        fi
    done
}

{
    echo model,tool,percent,target,faces,rms,cpu_s
    models | while read -r model; do
        # shellcheck disable=SC2086 # words on purpose
        "$simplify" "$model" "$dir" $percents >"$dir/peers.csv"
        while IFS=, read -r tool percent target _ cpu; do
            measure "$model" "$tool" "$percent" "$target" "$cpu" \
                "$dir/${tool}_$percent.obj"
        done <"$dir/peers.csv"
        ours "$model" balanced
        ours "$model" quality --profile quality --placement subset
        ours "$model" optimal --profile quality --placement optimal
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
        printf "%-10s", "rms / LT"
        for (p = 1; p <= n; p++)
            printf " %9s%% (n)", percent[p]
        print ""
        for (t = 1; t <= tools; t++) {
            printf "%-10s", order[t]
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
