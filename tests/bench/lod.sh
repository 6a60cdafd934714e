#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/lod.sh
#
# Levels of pmesh files against contraction in strict quadric order (see
# bench_qem.cpp) at equal face counts: what batches and compact codes cost.
# "balanced" and "quality" against subset placement, "optimal" (quality with
# optimal placement) against optimal placement. Both sides start from the full
# mesh of the file and place vertices on its grid; distances are to the model.
#
# Writes lod.csv and prints ratios of the distances, ours / strict, for both
# metrics of the reference. Levels that miss the face count by 2 % are left out
# of means. BITS: of the positions (12); PERCENTS (50 25 10 5 2 1); MESHDIST:
# see common.sh.
. tests/bench/common.sh
grid=${BITS:-12}
percents=${PERCENTS:-50 25 10 5 2 1}
need "$tools/bench_qem" "make bench-lod"
dir=$OUT/lod
mkdir -p "$dir"

# measure NAME TOOL PERCENT TARGET LEVEL: one row
measure() {
    distance=$(rms "$dir/$1.obj" "$5")
    echo "$1,$2,$3,$4,$(faces "$5"),$distance"
}

# ours NAME KIND
ours() {
    # shellcheck disable=SC2086,SC2046 # words on purpose
    bake "$dir/$1.obj" "$dir/$2.pmesh" "$2" "$grid" \
        --base-faces $(base_faces "$dir/$1.obj" $percents)
    "$PMESH" extract -q "$dir/$2.pmesh" -o "$dir/full.obj"
    for percent in $percents; do
        want=$(target "$dir/full.obj" "$percent")
        "$PMESH" extract -q "$dir/$2.pmesh" --faces "$want" -o "$dir/level.obj"
        measure "$1" "$2" "$percent" "$want" "$dir/level.obj"
    done
}

{
    echo model,tool,percent,target,faces,rms
    models | while read -r model; do
        name=$(basename "$model" .obj)
        positions_only "$model" >"$dir/$name.obj"
        for kind in balanced quality optimal; do
            progress "$name: $kind"
            ours "$name" "$kind"
        done
        progress "$name: strict order"
        # shellcheck disable=SC2086 # words on purpose
        "$tools/bench_qem" "$dir/full.obj" "$grid" "$dir" $percents \
            >"$dir/strict.csv"
        while IFS=, read -r tool percent want _; do
            measure "$name" "$tool" "$percent" "$want" \
                "$dir/${tool}_$percent.obj"
        done <"$dir/strict.csv"
    done
} >"$OUT/lod.csv"
for metric in accumulated memoryless; do
    awk -F , -v percents="$percents" -v metric="$metric" \
        -f tests/bench/lod.awk "$OUT/lod.csv"
done
