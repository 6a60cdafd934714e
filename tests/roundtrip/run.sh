#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/roundtrip/run.sh
#
# From a mesh to a file and back: at full detail within half a grid cell, at a
# face budget within a split, from half of the bytes, and the same bytes again.
# Takes our own sample and the models of PMESH_MODELS (../shared/models), if
# they are there.
set -u
PMESH_MODELS=${PMESH_MODELS:-../shared/models}
suite=roundtrip
. tests/harness.sh

# The first number behind a key of `pmesh info`.
info() {
    "$PMESH" info --json "$dir/a.pmesh" |
        sed -n "s/.*\"$1\": *\([-+.0-9eE]*\).*/\1/p" | head -n 1
}

faces() {
    grep -c '^f ' "$1"
}

verifies() {
    "$PMESH" verify "$dir/a.pmesh"
}

# Half the diagonal of a cell is 0.866 steps.
base_is_coded_as_asked() {
    case $options in
    *"--base draco"*) coder=draco ;;
    *) coder=native ;;
    esac
    "$PMESH" info --json "$dir/a.pmesh" | grep -q "\"base_coder\": \"$coder\""
}

full_detail_is_the_input() {
    "$PMESH" extract -q "$dir/a.pmesh" -o "$dir/full.obj" &&
        test "$(faces "$dir/full.obj")" = "$(info faces)" &&
        "$PMESH" compare "$model" "$dir/full.obj" --samples 20000 \
            --fail-above "$(awk -v s="$(info step)" 'BEGIN { print s * 0.867 }')"
}

budget_is_met() {
    full=$(info faces)
    base=$(info base_faces)
    for budget in $((full / 2)) $((full / 10)) $((full / 50)); do
        [ "$budget" -ge "$base" ] || continue
        "$PMESH" extract -q "$dir/a.pmesh" --faces $budget \
            -o "$dir/level.obj" || return 1
        count=$(faces "$dir/level.obj")
        echo "$count faces for a budget of $budget"
        test "$count" -le $budget && test "$count" -ge $((budget - 2)) ||
            return 1
    done
}

# Of those behind the base mesh, which may be most of the file.
half_the_bytes_are_a_mesh() {
    base=$("$PMESH" info --json "$dir/a.pmesh" |
        sed -n 's/.*{"bytes": \([0-9]*\).*/\1/p' | head -n 1)
    head -c $(((base + $(info bytes)) / 2)) "$dir/a.pmesh" >"$dir/half.pmesh"
    "$PMESH" extract "$dir/half.pmesh" -o "$dir/half.obj" &&
        test "$(faces "$dir/half.obj")" -ge "$(info base_faces)"
}

bytes_are_the_same_again() {
    # shellcheck disable=SC2086 # words on purpose
    "$PMESH" bake -q "$model" -o "$dir/b.pmesh" -j 2 $options &&
        cmp "$dir/a.pmesh" "$dir/b.pmesh"
}

# roundtrip MODEL BAKE_OPTIONS
roundtrip() {
    model=$1
    options=$2
    name="$(basename "$model") $options"
    # shellcheck disable=SC2086
    if ! "$PMESH" bake -q "$model" -o "$dir/a.pmesh" $options >/dev/null; then
        failed=$((failed + 1))
        echo "roundtrip: $name: bake failed"
        return
    fi
    try "$name" verifies
    try "$name" base_is_coded_as_asked
    try "$name" full_detail_is_the_input
    try "$name" budget_is_met
    try "$name" half_the_bytes_are_a_mesh
    try "$name" bytes_are_the_same_again
}

"$PMESH" sample -o "$dir/sample.obj" || exit 1
for profile in compact balanced quality; do
    roundtrip "$dir/sample.obj" "--profile $profile"
done
roundtrip "$dir/sample.obj" "--profile quality --placement optimal"
roundtrip "$dir/sample.obj" "--no-attributes --position-bits 8"
roundtrip "$dir/sample.obj" "--position-bits 20"
roundtrip "$dir/sample.obj" "--lossless --position-bits 10"
roundtrip "$dir/sample.obj" "--lossless --base draco"
for faces in 200 2000 100M; do
    for model in "$dir/sample.obj" "$PMESH_MODELS"/human.obj \
        "$PMESH_MODELS"/cow.obj "$PMESH_MODELS"/CesiumMan.glb; do
        [ ! -e "$model" ] ||
            roundtrip "$model" "--merge --base draco --base-faces $faces"
    done
done
for model in "$PMESH_MODELS"/*.obj; do
    [ -e "$model" ] && roundtrip "$model" ""
done
summary
