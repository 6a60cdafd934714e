# SPDX-License-Identifier: MIT
# Sourced by the benchmarks. From the environment:
#   PMESH         the program (build/release/pmesh)
#   PMESH_MODELS  folder of models (../shared/models)
#   MODELS        names without .obj, to take fewer than all
#   OUT           folder for what is measured (build/bench)
# shellcheck shell=sh
set -eu
PMESH=${PMESH:-build/release/pmesh}
PMESH_MODELS=${PMESH_MODELS:-../shared/models}
OUT=${OUT:-build/bench}

need() {
    command -v "$1" >/dev/null && return
    echo "$1 is missing: $2" >&2
    exit 1
}

# The OBJ files to measure, one a line.
models() {
    if [ -n "${MODELS-}" ]; then
        for name in $MODELS; do
            echo "$PMESH_MODELS/$name.obj"
        done
    else
        find "$PMESH_MODELS" -maxdepth 1 -name '*.obj' | sort
    fi
}

# Triangles of an OBJ file.
faces() {
    awk '$1 == "f" { n += NF - 3 } END { print n + 0 }' "$1"
}

# An OBJ file without anything but positions and polygons.
positions_only() {
    awk '
        $1 == "v" { print $1, $2, $3, $4 }
        $1 == "f" { gsub(/\/[^ \t\r]*/, ""); print }' "$1"
}

bytes() {
    wc -c <"$1" | tr -d ' '
}
