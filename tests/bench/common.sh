# SPDX-License-Identifier: MIT
# Sourced by the benchmarks. From the environment:
#   PMESH         the program (build/release/pmesh)
#   PMESH_MODELS  folder of models (../shared/models)
#   MODELS        names without .obj, to take fewer than all
#   OUT           folder for what is measured (build/bench)
#   MESHDIST      a second opinion on distances, see rms
# Functions in (parentheses) run in a subshell: their variables are their own.
# shellcheck shell=sh
set -eu
PMESH=${PMESH:-build/release/pmesh}
PMESH_MODELS=${PMESH_MODELS:-../shared/models}
OUT=${OUT:-build/bench}
# shellcheck disable=SC2034 # some use it
tools=${PMESH%/*} # the benchmarks' own programs lie next to it

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

# Says on standard error what a long benchmark is at.
progress() {
    echo "  $*" >&2
}

# Triangles of an OBJ file.
faces() {
    awk '$1 == "f" { n += NF - 3 } END { print n + 0 }' "$1"
}

# What was measured, on what.
machine() {
    date -u '+%Y-%m-%d'
    uname -srm
    sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | sort | uniq -c |
        awk '{ $1 = $1 " x"; print }'
    awk '/^MemTotal/ { printf "%.0f GiB\n", $2 / 1048576 }' /proc/meminfo
    ${CXX:-c++} --version | sed -n 1p
    dpkg-query -W -f '${Package} ${Version}\n' libmeshoptimizer-dev \
        libcgal-dev libopenmesh-dev libdraco-dev libtinyobjloader-dev \
        libtinygltf-dev 2>/dev/null
    echo "load at the end: $(cut -d ' ' -f 1-3 /proc/loadavg)"
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

# json FILE KEY...: the first numbers of these names, separated by commas
json() (
    file=$1
    shift
    tr ',{}' '[\n*]' <"$file" | awk -F '": *' -v keys="$*" '
        { sub(/^[ \t]*"/, "") }
        !($1 in value) { value[$1] = $2 + 0 }
        END {
            n = split(keys, key, " ")
            for (i = 1; i <= n; i++) {
                if (!(key[i] in value)) exit 1
                printf "%s%.17g", (i > 1 ? "," : ""), value[key[i]]
            }
            print ""
        }'
)

# rms ORIGINAL MESH: the two-sided root mean square of the distance, relative
# to the diagonal of the original's bounding box. The meter is `pmesh compare`,
# or MESHDIST: called the same way, it prints JSON with "rms_rel" or "rms".
rms() {
    ${MESHDIST:-$PMESH compare --json} "$1" "$2" | tr ',{}' '[\n*]' |
        awk -F '": *' '
            $1 ~ /"rms$/ { any = $2 }
            $1 ~ /"rms_rel$/ { any = $2; exit }
            END { if (any == "") exit 1; print any }'
}

# target MODEL PERCENT: so many of its faces
target() {
    awk -v n="$(faces "$1")" -v p="$2" \
        'BEGIN { printf "%d\n", n * p / 100 + 0.5 }'
}

# base_faces MODEL PERCENT...: a base mesh no finer than any of these levels
base_faces() (
    model=$1
    shift
    for percent; do
        target "$model" "$percent"
    done | awk 'BEGIN { n = 200 } $1 < n { n = $1 } END { print n }'
)

# bake MODEL OUT KIND BITS OPTION...: positions only; the report to OUT.json.
# KIND is a profile, or "optimal": quality with optimal placement.
bake() (
    model=$1 out=$2 kind=$3 bits=$4
    shift 4
    case $kind in
    optimal) set -- --profile quality --placement optimal "$@" ;;
    *) set -- --profile "$kind" "$@" ;;
    esac
    "$PMESH" bake -q --json "$model" --no-attributes --position-bits "$bits" \
        "$@" -o "$out" >"$out.json"
)

# draco MESH OUT BITS
draco() {
    draco_encoder -i "$1" -o "$2" -cl 10 -qp "$3" >"$2.log"
}
