#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/size.sh
#
# Bytes of complete files, positions only, part by part: every profile, and
# "optimal" (quality with optimal placement), against Draco's best compression.
# Writes size.csv and size.svg and prints ratios, pmesh / Draco.
# BITS: of the positions ("12 14").
. tests/bench/common.sh
grids=${BITS:-12 14}
kinds="compact balanced quality optimal"
need draco_encoder "make bench-deps"
dir=$OUT/size
mkdir -p "$dir"

# One row for each coder and grid.
measure() {
    name=$(basename "$1" .obj)
    progress "$name"
    positions_only "$1" >"$dir/$name.obj"
    for grid in $grids; do
        for kind in $kinds; do
            file=$dir/$name.$kind.$grid.pmesh
            bake "$dir/$name.obj" "$file" "$kind" "$grid"
            counts=$(json "$file.json" faces vertices)
            parts=$(json "$file.json" connectivity positions base header)
            echo "$name,$counts,$grid,$kind,$(bytes "$file"),$parts"
        done
        file=$dir/$name.$grid.drc
        draco "$dir/$name.obj" "$file" "$grid"
        echo "$name,$counts,$grid,draco,$(bytes "$file"),,,,"
    done
}

{
    echo model,faces,vertices,bits,coder,bytes,connectivity,positions,base,header
    models | while read -r model; do
        measure "$model"
    done
} >"$OUT/size.csv"
awk -F , -v grids="$grids" -v kinds="$kinds" -f tests/bench/size.awk \
    "$OUT/size.csv"
python3 tests/bench/plot.py size "$OUT/size.csv" "$OUT/size.svg"
echo "$OUT/size.csv $OUT/size.svg"
