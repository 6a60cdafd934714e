#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/speed.sh
#
# Speed and memory against what they must and aim to be, each beside a peer in
# the same process: see bench_speed.cpp. Writes speed.csv and speed.svg, and
# prints the table with geometric means over the models.
# MODELS: "bunny koala armadillo"; set but empty: all. RUNS: rounds (9).
MODELS=${MODELS-bunny koala armadillo}
. tests/bench/common.sh
need "$tools/bench_speed" "make bench-speed"
need python3 "make bench-deps"
mkdir -p "$OUT"

{
    echo model,faces,what,ours,peer,unit,figure,must,aim
    models | while read -r model; do
        progress "$(basename "$model" .obj)"
        "$tools/bench_speed" "${RUNS:-9}" "$model"
    done
} >"$OUT/speed.csv"
machine >"$OUT/speed-machine.txt"
cat "$OUT/speed-machine.txt"
awk -F , -f tests/bench/speed.awk "$OUT/speed.csv"
python3 tests/bench/plot.py speed "$OUT/speed.csv" "$OUT/speed.svg"
