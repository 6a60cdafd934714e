#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/attributes.sh
#
# What simplification does to attributes: joint quadrics against geometry alone
# and, if MESHOPT_JS names the meshopt_simplifier.js of the npm package
# meshoptimizer, against that; see bench_attributes.cpp.
#
# Writes attributes.csv and prints it. PERCENTS: levels (25 5); SUBJECTS: files
# below PMESH_MODELS, or "gouraud", a sphere made for this.
. tests/bench/common.sh
percents=${PERCENTS:-25 5}
subjects=${SUBJECTS:-gouraud spot.obj human.obj pizza.obj CesiumMan.glb
FlightHelmet/FlightHelmet.gltf}
need "$tools/bench_attributes" "make bench-attributes"
dir=$OUT/attributes
mkdir -p "$dir"

{
    echo model,tool,percent,target,faces,rms,normal,texcoord,color,psnr,flips,open
    for subject in $subjects; do
        progress "$subject"
        [ "$subject" = gouraud ] || subject=$PMESH_MODELS/$subject
        # shellcheck disable=SC2086 # words on purpose
        "$tools/bench_attributes" "$subject" "$dir" $percents
    done
} >"$OUT/attributes.csv"

awk -F , '{ printf "%-13s %-15s %7s %7s %7s %10s %9s %9s %9s %6s %5s %5s\n",
    $1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12 }' "$OUT/attributes.csv"
