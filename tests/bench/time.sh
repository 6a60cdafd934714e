#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/time.sh
# Time and memory of bake and extract, for each model and for a generated mesh
# of BIG triangles (2000000; 0: none), and of simplify where the papers give
# times. Writes time.csv and prints it.
. tests/bench/common.sh
need /usr/bin/time "make bench-deps"
dir=$OUT/time
mkdir -p "$dir"

# clock NAME FACES WHAT COMMAND...: one row
clock() {
    name=$1
    count=$2
    what=$3
    shift 3
    /usr/bin/time -f '%e %U %S %M' -o "$dir/clock" "$@" >/dev/null
    awk -v head="$name,$count,$what" -v n="$count" '{
        cpu = $2 + $3
        printf "%s,%.2f,%.2f,%.1f,%.3f\n", head, $1, cpu, $4 / 1024,
            cpu ? n / cpu / 1e6 : 0
    }' "$dir/clock"
}

# all_of MODEL
all_of() {
    label=$(basename "$1" .obj)
    total=$(faces "$1")
    clock "$label" "$total" bake \
        "$PMESH" bake -q "$1" -o "$dir/model.pmesh"
    clock "$label" "$total" extract \
        "$PMESH" extract -q "$dir/model.pmesh" -o "$dir/full.ply"
    clock "$label" "$total" extract-10% \
        "$PMESH" extract -q "$dir/model.pmesh" --ratio 10% -o "$dir/tenth.ply"
    clock "$label" "$total" verify "$PMESH" verify "$dir/model.pmesh"
}

# What the papers timed: a bunny of 70,000 triangles to 100 (15 s in 1997), and
# 50,000 with attributes to 10,000 and 1,500 (20 and 23 s in 1998).
of_the_papers() {
    case $(basename "$1" .obj) in
    bunny) set -- "$1" 100 ;;
    pizza) set -- "$1" 10000 1500 ;;
    *) return ;;
    esac
    model=$1
    shift
    for count; do
        clock "$(basename "$model" .obj)" "$(faces "$model")" \
            "simplify-$count" "$PMESH" simplify -q "$model" --faces "$count" \
            -o "$dir/lod.obj"
    done
}

{
    echo 'model,faces,command,wall_s,cpu_s,peak_mib,mfaces_per_cpu_s'
    models | while read -r model; do
        all_of "$model"
        of_the_papers "$model"
    done
    big=${BIG:-2000000}
    if [ "$big" -gt 0 ]; then
        "$PMESH" sample --faces "$big" -o "$dir/generated.obj"
        all_of "$dir/generated.obj"
    fi
} >"$OUT/time.csv"
awk -F , '{ printf "%-12s %8s %-12s %7s %7s %9s %s\n", $1, $2, $3, $4, $5, $6,
    $7 }' "$OUT/time.csv"
