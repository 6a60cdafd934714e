#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/faults/run.sh
#        KILLS=200: so many processes killed; STEP=1: every so manieth allocation
#
# Memory that runs out at any allocation, disks that fail at any call, processes
# killed at any call and at any time, small stacks: a command does its work, or
# says in one line why not and leaves all files as they were.
set -u
build=$(dirname "$PMESH")
suite=faults
. tests/harness.sh
case $PMESH in
/*) ;;
*) PMESH=$PWD/$PMESH ;;
esac
case $(uname) in
Linux) ;;
*) echo "faults: skipped, this is no Linux" && exit 0 ;;
esac
if grep -q __asan_init "$PMESH"; then
    echo "faults: skipped, the sanitizer has an allocator of its own"
    exit 0
fi
shim=$dir/shim.so
${CC:-cc} -O1 -shared -fPIC tests/faults/shim.c -o "$shim" -ldl || exit 1
work=$dir/work
mkdir "$work"

# ---- inputs ----------------------------------------------------------------

"$PMESH" extract -q tests/golden/seam.pmesh -o "$work/in.ply"
"$PMESH" extract -q tests/golden/seam.pmesh -o "$work/in.obj" # with materials
rm -f "$work/in.mtl"
"$PMESH" extract -q tests/golden/cuts.pmesh -o "$work/in.stl"
"$PMESH" extract -q tests/golden/cuts.pmesh -o "$work/in.off"
cp tests/golden/leaves-moving.pmesh "$work/in.pmesh"
printf '%s' '{"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0},{"mesh":1}],"materials":[{}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]},
{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":
"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}' \
    >"$work/in.gltf"
"$PMESH" bake -q "$work/in.gltf" -o "$work/scene.pmesh"

# ---- one call fails --------------------------------------------------------

# The command did its work or failed cleanly; its output is the right one, or the
# old one. Disks may fail behind the rename, where the right one is there already.
judge() {
    code=$1
    ls -A "$work" >"$dir/after"
    if [ "$code" = 0 ]; then
        cmp -s "$dir/right" "$work/$output" && return 0
    elif [ "$code" -le 5 ] && [ "$(grep -c '^pmesh: ' "$dir/err")" -ge 1 ] &&
        cmp -s "$dir/before" "$dir/after" && is_whole; then
        return 0
    fi
    echo "$2: exit code $code"
    cat "$dir/err"
    diff "$dir/before" "$dir/after"
    return 1
}

is_whole() {
    cmp -s "$dir/old" "$work/$output" ||
        { [ "$kind" != memory ] && cmp -s "$dir/right" "$work/$output"; }
}

# prepare KIND OUTPUT ARGUMENT...: the right output, the old one, and how many
# calls there are.
prepare() {
    kind=$1
    output=$2
    shift 2
    cd "$work" || return 1
    rm -f out.*
    LD_PRELOAD=$shim FAULT=$kind FAULT_COUNT=$dir/count "$PMESH" "$@" \
        -o "$output" >/dev/null 2>"$dir/err" || { cat "$dir/err"; return 1; }
    mv "$output" "$dir/right"
    echo old >"$dir/old"
    cp "$dir/old" "$output"
    ls -A >"$dir/before"
    calls=$(cat "$dir/count")
    [ "$calls" -gt 5 ]
}

# every_fault KIND OUTPUT ARGUMENT...: each call fails, alone and with all behind.
every_fault() {
    prepare "$@" || return 1
    shift 2
    step=1
    [ "$kind" != memory ] || step=$((STEP > 0 ? STEP : 1 + calls / 25))
    k=1
    while [ "$k" -le "$calls" ]; do
        for on in '' 1; do
            cp "$dir/old" "$output"
            LD_PRELOAD=$shim FAULT=$kind FAULT_AT=$k FAULT_ON=$on \
                "$PMESH" "$@" -o "$output" >/dev/null 2>"$dir/err"
            judge $? "call $k of $calls${on:+ and on}" || return 1
        done
        k=$((k + step))
    done
    rm -f "$output"
}

# The same, but killed before each call: only a temporary file may be left.
every_kill() {
    prepare "$@" || return 1
    shift 2
    k=1
    while [ "$k" -le "$calls" ]; do
        LD_PRELOAD=$shim FAULT=kill FAULT_AT=$k "$PMESH" "$@" -o "$output" \
            >/dev/null 2>"$dir/err"
        code=$?
        rm -f .pmesh-??????
        ls -A >"$dir/after"
        [ $code = 137 ] && cmp "$dir/before" "$dir/after" && is_whole || {
            echo "killed at call $k of $calls: exit code $code"
            return 1
        }
        k=$((k + 1))
    done
    rm -f "$output"
}

# N processes killed at random times of a bake over an older file.
random_kills() {
    cd "$work" || return 1
    "$PMESH" bake -q big.obj -o "$dir/right" || return 1
    echo old >"$dir/old"
    cp "$dir/old" big.pmesh
    awk -v n="$1" 'BEGIN { srand(7); while (n--) print rand() * 0.4 }' |
        while read -r delay; do
            timeout -s KILL "$delay" "$PMESH" bake -q big.obj -o big.pmesh
            rm -f .pmesh-??????
            if cmp -s "$dir/right" big.pmesh; then
                echo new >>"$dir/kills"
                cp "$dir/old" big.pmesh
            elif cmp -s "$dir/old" big.pmesh; then
                echo old >>"$dir/kills"
            else
                echo broken >>"$dir/kills"
            fi
        done
    [ "$(wc -l <"$dir/kills")" = "$1" ] && ! grep -q broken "$dir/kills"
}

# ---- small stacks ----------------------------------------------------------

# nodes N: a chain of nodes, the last of which has the mesh.
nodes() {
    awk -v n="$1" 'BEGIN {
        printf "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],"
        printf "\"nodes\":["
        for (i = 1; i < n; i++) printf "{\"children\":[%d]},", i
        printf "{\"mesh\":0}],"
        print "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
    }'
    sed -n '/^"accessors"/,$p' in.gltf
}

small_stack() {
    cd "$work" || return 1
    (ulimit -s 256 && "$PMESH" "$@" 2>"$dir/err" >/dev/null)
    code=$?
    rm -f small.*
    [ $code -le "$most" ] && return 0
    echo "exit code $code"
    cat "$dir/err"
    return 1
}

commands_run_in_256_kib_of_stack() {
    most=0
    for input in in.obj in.ply in.stl in.off in.gltf chain.gltf star.obj; do
        small_stack bake $input -o small.pmesh || return 1
    done
    for to in small.obj small.ply small.glb; do
        small_stack extract in.pmesh -o $to || return 1
        small_stack extract scene.pmesh -o $to || return 1
    done
    small_stack bake chain.gltf --merge -o small.pmesh &&
        small_stack extract scene.pmesh --draco -o small.glb &&
        small_stack extract scene.pmesh --meshopt -o small.glb &&
        small_stack verify in.pmesh && small_stack info in.pmesh --levels &&
        small_stack simplify in.obj --faces 20 -o small.obj &&
        small_stack compare in.obj in.ply &&
        small_stack sheet in.pmesh -o small.png || return 1
    most=5 # refused, but not by a signal
    small_stack bake deep.gltf -o small.pmesh
}

(
    cd "$work" || exit 1
    nodes 5000 >chain.gltf
    awk 'BEGIN { for (i = 0; i < 100000; i++) printf "[" }' >deep.gltf
    awk 'BEGIN { # one face of 5,000 corners, in and out in turns
        n = 5000; pi = atan2(0, -1)
        for (i = 0; i < n; i++) {
            r = 1 + i % 2
            print "v", r * cos(2 * pi * i / n), r * sin(2 * pi * i / n), 0
        }
        printf "f"; for (i = 1; i <= n; i++) printf " %d", i; print ""
    }' >star.obj
    awk -v n=60 'BEGIN { # a wavy plane of 7,200 faces
        for (i = 0; i <= n; i++) for (j = 0; j <= n; j++)
            print "v", i, j, 3 * sin(i / 5) * cos(j / 7)
        for (i = 0; i < n; i++) for (j = 1; j <= n; j++) {
            p = i * (n + 1) + j
            print "f", p, p + n + 1, p + 1
            print "f", p + 1, p + n + 1, p + n + 2
        }
    }' >big.obj
)

STEP=${STEP-0}
for input in obj ply stl off gltf; do
    try "memory runs out: bake of $input" \
        every_fault memory out.pmesh bake -q in.$input
done
try 'memory runs out: a lossless bake' \
    every_fault memory out.pmesh bake -q --lossless in.ply
try 'memory runs out: a Draco base' \
    every_fault memory out.pmesh bake -q --base draco in.off
for output in obj ply stl gltf; do
    try "memory runs out: extract to $output" \
        every_fault memory out.$output extract -q in.pmesh
done
for options in '' --draco --meshopt '--lods 1,0.5'; do
    # shellcheck disable=SC2086 # words on purpose
    try "memory runs out: extract of a scene $options" \
        every_fault memory out.glb extract -q scene.pmesh $options
done
try 'memory runs out: simplify' \
    every_fault memory out.ply simplify -q in.obj --faces 30
try 'memory runs out: sheet' every_fault memory out.png sheet in.pmesh
try 'the disk fails: bake' every_fault disk out.pmesh bake -q in.ply
try 'the disk fails: extract' every_fault disk out.obj extract -q in.pmesh
try 'killed at every call: bake' every_kill kill out.pmesh bake -q in.ply
try 'killed at every call: extract' every_kill kill out.glb \
    extract -q scene.pmesh
try 'killed at random' random_kills "${KILLS:-20}"
sort "$dir/kills" | uniq -c
try commands_run_in_256_kib_of_stack
summary
