#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/quality.sh
#
# Surface distance at equal face counts: levels of pmesh files, and meshes of
# pmesh simplify, against the results of meshoptimizer and CGAL.
#
# Writes quality.csv and prints, of the cases that met the face count within
# 2 %: geometric means, with the number of cases and the worst, of
#   rms / LT     distance relative to CGAL's Lindstrom-Turk
#   rms / mo     the same to meshoptimizer
#   max / GH     largest distance relative to CGAL's Garland-Heckbert
#   normal / LT  angle of the normals relative to CGAL's Lindstrom-Turk
# and sums over all models of folds, flipped faces and non-manifold edges.
# BITS: of the positions (14); PERCENTS: levels to compare (50 10 1); MESHDIST:
# see common.sh; without it nobody counts flipped faces.
. tests/bench/common.sh
bits=${BITS:-14}
percents=${PERCENTS:-50 10 1}
need "$tools/bench_simplify" "make bench-quality"
dir=$OUT/quality
mkdir -p "$dir"

# quality ORIGINAL MESH: rms,max,normal_deg,folds,flipped,nonmanifold_edges of
# the meter; of what it says of both meshes, that of the latter comes last
quality() {
    ${MESHDIST:-$PMESH compare --json} "$1" "$2" | tr ',{}' '[\n*]' |
        awk -F '": *' '
            { sub(/^[ \t]*"/, ""); value[$1] = $2 }
            END {
                for (k in value)
                    if (k ~ /_rel$/)
                        value[substr(k, 1, length(k) - 4)] = value[k]
                n = split("rms max normal_deg folds flipped " \
                          "nonmanifold_edges", key, " ")
                for (i = 1; i <= n; i++)
                    printf "%s%s", value[key[i]], i < n ? "," : "\n"
            }'
}

# measure MODEL TOOL PERCENT TARGET CPU LEVEL: one row
measure() {
    distance=$(quality "$1" "$6")
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
    echo model,tool,percent,target,faces,rms,max,normal_deg,folds,flipped,\
nonmanifold_edges,cpu_s
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
    function heading(title,   p) {
        printf "%-17s", title
        for (p = 1; p <= n; p++)
            printf " %16s", percent[p] "%"
        print ""
    }
    # Of one column, relative to that of a tool.
    function ratios(title, column, base,   t, p, m, own, other, sum, count, most) {
        heading(title)
        for (t = 1; t <= tools; t++) {
            printf "%-17s", order[t]
            for (p = 1; p <= n; p++) {
                sum = count = most = 0
                for (m in models) {
                    other = value[m, base, percent[p], column]
                    own = value[m, order[t], percent[p], column]
                    if (!(other > 0 && own > 0))
                        continue
                    sum += log(own / other)
                    count++
                    if (own / other > most)
                        most = own / other
                }
                printf " %16s", count ? sprintf("%.3f (%d, %.2f)", \
                    exp(sum / count), count, most) : "-"
            }
            print ""
        }
        print ""
    }
    function sums(title,   t, p) {
        heading(title)
        for (t = 1; t <= tools; t++) {
            printf "%-17s", order[t]
            for (p = 1; p <= n; p++)
                printf " %16s", total[order[t], percent[p], 9] "/" \
                    total[order[t], percent[p], 10] "/" \
                    total[order[t], percent[p], 11]
            print ""
        }
    }
    BEGIN { n = split(percents, percent, " ") }
    NR > 1 {
        if (!($2 in seen)) { seen[$2]; order[++tools] = $2 }
        models[$1]
        if (!($5 <= 1.02 * $4 && $5 >= 0.98 * $4))
            next
        for (i = 6; i <= 11; i++) {
            value[$1, $2, $3, i] = $i
            total[$2, $3, i] += $i
        }
    }
    END {
        ratios("rms / LT", 6, "cgal-lt")
        ratios("rms / mo", 6, "meshopt")
        ratios("max / GH", 7, "cgal-gh")
        ratios("normal / LT", 8, "cgal-lt")
        sums("folds/flips/nm")
    }' "$OUT/quality.csv"
