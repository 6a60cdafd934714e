#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/bench/skin.sh [MODEL.glb]
#
# A skinned, animated mesh at 50, 25 and 10 % of its faces: RMS distance of the
# deformed level to the deformed original, as a share of the diagonal, at five
# times of its animation, against that at rest.
set -u
PMESH_MODELS=${PMESH_MODELS:-../shared/models}
model=${1-$PMESH_MODELS/CesiumMan.glb}
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT

rms() {
    "$PMESH" compare --json "$1" "$2" 2>"$dir/warnings" |
        sed -n 's/.*"rms_rel": *\([-+.0-9eE]*\).*/\1/p' | head -n 1
}

"$PMESH" bake -q "$model" -o "$dir/a.pmesh" || exit 1
echo "percent time rms_rel"
for percent in 50 25 10; do
    "$PMESH" extract -q "$dir/a.pmesh" --ratio $percent% -o "$dir/lod.glb"
    for time in 0.1 0.5 0.9 1.3 1.7; do
        python3 tests/scene/pose.py "$model" $time "$dir/a.obj"
        python3 tests/scene/pose.py "$dir/lod.glb" $time "$dir/b.obj"
        echo "$percent $time $(rms "$dir/a.obj" "$dir/b.obj")"
    done
    # At rest: of the bind pose, which is what both files hold.
    "$PMESH" extract -q "$dir/a.pmesh" --ratio $percent% -o "$dir/rest.obj"
    echo "$percent rest $(rms "$model" "$dir/rest.obj")"
done
