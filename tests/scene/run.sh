#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/scene/run.sh
#        VALIDATE="node tests/scene/validate.js": each output, too
#        TRANSFORM=gltf-transform: also of files by Draco and meshoptimizer
#        (make check-gltf sets both)
#
# glTF scenes in and out: everything but geometry is as it was, all of the
# geometry comes back, any prefix and budget is a scene. Takes a generated zoo
# and the glTF files of PMESH_MODELS, if they are there.
set -u
PMESH_MODELS=${PMESH_MODELS:-../shared/models}
suite=scene
. tests/harness.sh
here=tests/scene

bakes_as_a_scene() {
    "$PMESH" bake --json "$model" -o "$dir/a.pmesh" >"$dir/report.json" &&
        grep -q '"scene": true' "$dir/report.json" &&
        "$PMESH" verify "$dir/a.pmesh"
}

bakes_the_same_again() {
    "$PMESH" bake -q "$model" -o "$dir/b.pmesh" -j 2 &&
        cmp "$dir/a.pmesh" "$dir/b.pmesh"
}

# The first number behind a key of `pmesh info`.
info() {
    "$PMESH" info --json "$dir/a.pmesh" |
        sed -n "s/.*\"$1\": *\([-+.0-9eE]*\).*/\1/p" | head -n 1
}

comes_back_whole() {
    "$PMESH" extract -q "$dir/a.pmesh" -o "$dir/full.glb" &&
        "$PMESH" extract -q "$dir/a.pmesh" -o "$dir/full.gltf" &&
        python3 $here/compare.py "$model" "$dir/full.glb" full &&
        python3 $here/compare.py "$model" "$dir/full.gltf" full
}

faces_written() {
    sed -n 's/.*: \([0-9]*\) of .* faces, .* meshes.*/\1/p' "$dir/said"
}

# How often the scene shows the mesh that it shows most often.
most_instances() {
    python3 -c 'import collections, json, sys
nodes = json.load(open(sys.argv[1]))["nodes"]
count = collections.Counter(n["mesh"] for n in nodes if "mesh" in n)
print(max(count.values()))' "$dir/full.gltf"
}

# Faces count as they are drawn; a split adds two to each instance.
budgets_are_met_without_cracks() {
    "$PMESH" extract "$dir/a.pmesh" -o "$dir/lod.glb" >"$dir/said"
    full=$(faces_written)
    "$PMESH" extract "$dir/a.pmesh" --faces 1 -o "$dir/lod.glb" \
        >"$dir/said" 2>"$dir/warning"
    base=$(faces_written)
    step=$((2 * $(most_instances)))
    for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
        budget=$((base + (full - base) * i * i / 400))
        "$PMESH" extract "$dir/a.pmesh" --faces "$budget" \
            -o "$dir/lod$i.glb" >"$dir/said" || return 1
        count=$(faces_written)
        echo "$count faces for a budget of $budget"
        test "$count" -le "$budget" && test "$count" -ge $((budget - step)) ||
            return 1
        python3 $here/compare.py "$model" "$dir/lod$i.glb" || return 1
    done
    python3 $here/cracks.py "$dir/full.glb" "$dir"/lod*.glb
}

prefixes_are_scenes() {
    size=$(wc -c <"$dir/a.pmesh")
    base=$("$PMESH" info --json "$dir/a.pmesh" |
        sed -n 's/.*{"bytes": \([0-9]*\).*/\1/p' | head -n 1)
    last=0
    for percent in 0 5 10 20 40 60 80 99; do
        head -c $((base + (size - base) * percent / 100)) "$dir/a.pmesh" \
            >"$dir/cut.pmesh"
        "$PMESH" extract "$dir/cut.pmesh" -o "$dir/cut$percent.glb" \
            >"$dir/said" || return 1
        count=$(faces_written)
        test "$count" -ge "$last" || return 1
        last=$count
    done
    head -c $((base - 1)) "$dir/a.pmesh" >"$dir/cut.pmesh"
    ! "$PMESH" extract -q "$dir/cut.pmesh" -o "$dir/x.glb"
}

first_mesh_comes_within_16_kib() {
    head -c 16384 "$dir/a.pmesh" >"$dir/cut.pmesh"
    "$PMESH" extract -q "$dir/cut.pmesh" --mesh 0 -o "$dir/x.glb"
}

# An ordinary GLB, whose primitives show the base meshes, with the scene in it.
glb_holds_the_scene() {
    glb=$dir/progressive.glb
    "$PMESH" bake -q "$model" -o "$glb" && "$PMESH" verify "$glb" &&
        python3 $here/compare.py "$model" "$glb" &&
        python3 $here/schema.py "$glb" &&
        "$PMESH" extract -q "$glb" -o "$dir/again.glb" &&
        cmp "$dir/full.glb" "$dir/again.glb" || return 1
    "$PMESH" info --json "$glb" | grep -q '"scene": true' || return 1
    size=$(wc -c <"$glb")
    head -c $((size - 4)) "$glb" >"$dir/cut.glb" # within the end chunk
    "$PMESH" extract -q "$dir/cut.glb" -o "$dir/again.glb" &&
        ! "$PMESH" verify "$dir/cut.glb"
}

levels_make_chains() {
    "$PMESH" extract -q "$dir/a.pmesh" --lods 100%,50%,0.2 -o "$dir/lods.glb" &&
        python3 $here/lods.py "$dir/full.glb" "$dir/lods.glb" 3
}

packs_by_meshopt() {
    "$PMESH" extract -q "$dir/a.pmesh" --meshopt -o "$dir/packed.glb" &&
        "$PMESH" compare --json --samples 1000 "$dir/full.glb" \
            "$dir/packed.glb" >"$dir/said" &&
        grep -q '"max": 0,' "$dir/said" &&
        "$PMESH" extract -q "$dir/a.pmesh" --meshopt --lods 1,0.5 \
            -o "$dir/packed.gltf"
}

# Vertices come in another order: baked again, they are compared by place.
packs_by_draco() {
    "$PMESH" extract -q "$dir/a.pmesh" --draco -o "$dir/draco.glb" &&
        python3 $here/draco.py "$dir/full.glb" "$dir/draco.glb" &&
        "$PMESH" extract -q "$dir/a.pmesh" --draco --lods 1,0.5 --inflate \
            -o "$dir/draco.gltf" &&
        "$PMESH" bake -q "$dir/draco.gltf" -o "$dir/b.pmesh" || return 1
    case $model in
    "$dir"/zoo/*) ;;
    *) return 0 ;; # large
    esac
    "$PMESH" bake -q "$dir/draco.glb" -o "$dir/b.pmesh" &&
        "$PMESH" extract -q "$dir/b.pmesh" -o "$dir/again.glb" &&
        python3 $here/compare.py "$dir/full.glb" "$dir/again.glb" full
}

merges_into_other_formats() {
    "$PMESH" extract -q "$dir/a.pmesh" -o "$dir/full.obj" &&
        python3 $here/mtl.py "$model" "$dir/full.glb" "$dir/full.obj" &&
        "$PMESH" compare "$model" "$dir/full.obj" --samples 2000 &&
        "$PMESH" extract -q "$dir/a.pmesh" --mesh 0 -o "$dir/one.ply"
}

is_valid() {
    # shellcheck disable=SC2086 # words on purpose
    $VALIDATE "$model" "$dir/full.glb" "$dir/full.gltf" "$dir"/lod*.glb \
        "$dir"/cut[0-9]*.glb "$dir/progressive.glb" "$dir/packed.glb" \
        "$dir/packed.gltf" "$dir/lods.glb" "$dir/draco.glb" "$dir/draco.gltf"
}

scene() {
    model=$1
    name=$(basename "$model")
    rm -f "$dir"/*.glb
    try "$name: bakes as a scene" bakes_as_a_scene
    try "$name: bakes the same again" bakes_the_same_again
    try "$name: comes back whole" comes_back_whole
    try "$name: budgets are met without cracks" budgets_are_met_without_cracks
    try "$name: prefixes are scenes" prefixes_are_scenes
    # Twelve morph targets make a base mesh that is no ordinary one.
    [ "$name" = morphs.glb ] || try "$name: first mesh comes within 16 KiB" \
        first_mesh_comes_within_16_kib
    try "$name: a GLB holds the scene" glb_holds_the_scene
    try "$name: levels make chains" levels_make_chains
    try "$name: packs by meshopt" packs_by_meshopt
    try "$name: packs by Draco" packs_by_draco
    try "$name: merges into other formats" merges_into_other_formats
    [ -z "${VALIDATE-}" ] || try "$name: is valid" is_valid
}

# In, what is no number is mended; out, there is none.
wild_values_are_mended() {
    wild=$dir/zoo/wild/wild.glb
    "$PMESH" bake "$wild" -o "$dir/a.pmesh" >"$dir/said" 2>"$dir/warning" &&
        grep -q 'warning' "$dir/warning" || return 1
    for faces in 288 100 20; do
        "$PMESH" extract -q "$dir/a.pmesh" --faces $faces -o "$dir/lod.glb" &&
            python3 $here/finite.py "$dir/lod.glb" POSITION NORMAL TANGENT \
                TEXCOORD_0 COLOR_0 _HEAT || return 1
    done
    "$PMESH" simplify -q "$wild" --faces 100 -o "$dir/lod.glb" &&
        python3 $here/finite.py "$dir/lod.glb" POSITION NORMAL TEXCOORD_0 &&
        "$PMESH" bake -q --merge "$wild" -o "$dir/a.pmesh" &&
        "$PMESH" extract -q "$dir/a.pmesh" -o "$dir/lod.glb" &&
        python3 $here/finite.py "$dir/lod.glb" POSITION NORMAL TEXCOORD_0
}

if ! command -v python3 >/dev/null; then
    echo "scene: skipped, there is no python3"
    exit 0
fi
mkdir "$dir/zoo" && python3 $here/zoo.py "$dir/zoo" || exit 1
if [ -n "${TRANSFORM-}" ]; then
    for coder in draco meshopt; do
        for name in skinned textures scenes; do
            $TRANSFORM $coder "$dir/zoo/$name.glb" \
                "$dir/zoo/$name-$coder.glb" >/dev/null || exit 1
        done
    done
fi
for model in "$dir"/zoo/*.glb "$PMESH_MODELS"/*.glb \
    "$PMESH_MODELS"/*/*.gltf; do
    [ ! -e "$model" ] || scene "$model"
done
try wild_values_are_mended
summary
