#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/demo.sh PMESH OUT_DIR
# From a mesh to its levels and a picture of them; shows every command.
set -eu
pmesh=$1
out=$2
mkdir -p "$out"

show() {
    printf '$ %s\n' "$*"
    "$@"
}

show "$pmesh" sample -o "$out/sample.obj"
show "$pmesh" bake "$out/sample.obj" -o "$out/sample.pmesh"
for percent in 1 10 50; do
    show "$pmesh" extract "$out/sample.pmesh" --ratio $percent% \
        -o "$out/lod_$percent.obj"
done
show "$pmesh" info "$out/sample.pmesh" --levels
show "$pmesh" sheet "$out/sample.pmesh" -o "$out/sheet.png"
echo
wc -c "$out"/sample.obj "$out"/sample.pmesh "$out"/lod_*.obj
echo "look at $out/sheet.png"
