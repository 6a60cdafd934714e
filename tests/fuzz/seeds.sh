#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/fuzz/seeds.sh OUT [MESHES]
#
# Makes OUT/TARGET/*, what fuzzing starts from: golden files and small bakes for
# the targets that decode, small meshes in every format for those that import
# (and the files below MESHES of at most 4 KB, by their endings), texts.
set -eu
out=$1
meshes=${2-}
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
decoding="oneshot stream prefix alloc nolimit blocks raw"

# seed TARGET FILE [NAME]
seed() {
    mkdir -p "$out/$1"
    cp "$2" "$out/$1/${3-$(basename "$2")}"
}

# sample FILE FACES
sample() {
    "$PMESH" simplify "$tmp/sample.ply" --faces "$2" -o "$tmp/$1" >/dev/null
}

bake() {
    name=$1
    shift
    "$PMESH" bake "$@" -q -o "$tmp/$name.pmesh" || return 0
    small "$tmp/$name.pmesh"
}

small() {
    for target in $decoding; do
        seed "dec_$target" "$1"
    done
    seed tool_verify "$1"
}

# scene FILE NAME: unless it is none
scene() {
    "$PMESH" info "$1" | grep -q '^format  *scene' || return 0
    for target in dec_scene dec_alloc tool_scene; do
        seed $target "$1" "$2"
    done
}

for file in tests/golden/*.pmesh; do
    [ "$(wc -c <"$file")" -lt 5000 ] || continue
    small "$file"
done

"$PMESH" sample --faces 4000 -o "$tmp/sample.ply" >/dev/null
sample shell.obj 150
for ending in obj ply stl off gltf glb drc; do
    sample "tiny.$ending" 30
    seed "imp_$ending" "$tmp/tiny.$ending"
done
seed imp_scene "$tmp/tiny.glb"
seed imp_scene "$tmp/tiny.gltf"

for profile in compact balanced quality; do
    for placement in subset optimal; do
        bake "$profile-$placement" "$tmp/shell.obj" --profile $profile \
            --placement $placement --base-faces 20
    done
done
bake lossless "$tmp/tiny.ply" --lossless
bake draco "$tmp/shell.obj" --base draco
bake measured "$tmp/shell.obj" --measure --lossless

mkdir "$tmp/zoo"
python3 tests/scene/zoo.py "$tmp/zoo"
for file in "$tmp"/zoo/*.gl*; do
    if [ "$(wc -c <"$file")" -lt 14000 ]; then
        seed "imp_${file##*.}" "$file"
        seed imp_scene "$file"
    fi
    "$PMESH" bake "$file" -q -o "$tmp/scene.pmesh" &&
        scene "$tmp/scene.pmesh" "$(basename "$file").pmesh"
done 2>/dev/null
"$PMESH" bake "$tmp/tiny.glb" -q -o "$tmp/tiny-scene.glb"
seed tool_scene "$tmp/tiny-scene.glb"
for style in meshopt draco; do
    "$PMESH" extract "$tmp/scene.pmesh" -q --$style -o "$tmp/$style.glb"
    seed imp_glb "$tmp/$style.glb"
    seed imp_scene "$tmp/$style.glb"
done

if [ -n "$meshes" ]; then
    for ending in obj ply stl off gltf glb; do
        find "$meshes" -name "*.$ending" -size -5k | while read -r file; do
            name=$(echo "$file" | tr / _)
            seed "imp_$ending" "$file" "$name"
            case $ending in
            gltf | glb) seed imp_scene "$file" "$name" ;;
            esac
        done
    done
fi

"$PMESH" guide "$tmp/tiny.obj" -o "$tmp/tiny.guide.json" >/dev/null
seed guide "$tmp/tiny.guide.json"
n=0
while read -r line; do
    n=$((n + 1))
    echo "$line" | sed 's/  /\n\n/; s/ ; /\n/g; :again; s/^\([^\n]*\) /\1\n/;
        t again' >"$tmp/$n"
    seed cli "$tmp/$n"
done <<'.'
bake a.obj -o c.pmesh --profile quality --json
bake a.obj -o c.pmesh --guide s  {"pmesh_guide": 1, "locks": [{"all": true}]}
bake a.obj -o c.pmesh --weights texture:s
extract b.pmesh --faces 1 -o c.ply
extract b.pmesh --ratio 50% -o - --format obj
info b.pmesh --json
verify b.pmesh s
compare a.obj b.pmesh --json
simplify a.obj -o c.obj --faces 1
session s  load a.obj ; faces 2 ; weight 1 sphere 0 0 0 2 ; undo ; save c.ply
stats a.obj
plot b.pmesh -o c.svg
guide a.obj -o c.guide.json
plan b.pmesh --pixels 1 --distance 3
view b.pmesh -o c.html
sheet b.pmesh -o c.png --heat error
.
for text in 0 -0 1.5e300 123456789012345678901234567890 0.1e-400 nan -inf \
    2.2250738585072011e-308 9007199254740993 1e23 .5 5. 0x10; do
    n=$((n + 1))
    printf %s "$text" >"$tmp/$n"
    seed number "$tmp/$n"
done
printf 'a "quoted" \\ \1\377 \342\202\254 text' >"$tmp/text"
seed json "$tmp/text"
for text in "a/b.bin" "../a" "%2e%2e/a" "data:;base64,AAEC" "http://a/b"; do
    n=$((n + 1))
    printf %s "$text" >"$tmp/$n"
    seed uri "$tmp/$n"
done
