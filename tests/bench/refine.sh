#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/bench/refine.sh
#
# What it costs to move the visible mesh among decoded splits: faces per second
# between base and full mesh, alone and into bound buffers; frames of 8192
# splits; faces in the ranges to upload for each that changed. Models as in
# common.sh, and a sample of BIG faces (1M).
. "$(dirname "$0")/common.sh"
mkdir -p "$OUT"
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
"$PMESH" sample -o "$dir/sample.ply" --faces "${BIG:-1M}"
{
    models
    echo "$dir/sample.ply"
} | while read -r model; do
    name=$(basename "${model%.*}")
    progress "$name"
    "$PMESH" bake "$model" -o "$dir/$name.pmesh" -q
    (
        program=$PWD/$tools/bench_refine
        cd "$dir" && "$program" "$name.pmesh"
    )
done | tee "$OUT/refine.txt"
