# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# Meshes out of whole, cut and damaged files.

cp "$baked" t.pmesh
bytes=$(size t.pmesh)
check 'info for its numbers' 0 info --json t.pmesh
base=$(json base_faces)
head_bytes=$(sed -n 's/.*{"bytes": \([0-9]*\),.*/\1/p' "$work/out" | head -n 1)

check 'all of it' 0 extract t.pmesh -o full.obj
ok 'no warning for a whole file' silent
ok 'full detail' test "$(faces full.obj)" = 4608
for format in obj ply stl off gltf glb drc; do
    check "into $format" 0 extract t.pmesh -q -o "m.$format"
    check "$format bakes again" 0 bake "m.$format" --json -o back.pmesh
    ok "$format keeps every face" test "$(json faces)" = 4608
done
check 'format for a name that does not tell' 0 \
    extract t.pmesh -q -o plain --format obj
ok 'the same as by name' cmp -s plain full.obj
"$PMESH" extract - -q -o - --format obj <t.pmesh >pipe.obj
ok 'from pipe to pipe' cmp -s pipe.obj full.obj

for n in "$base" 300 1000 1001 4607 4608 4000000000; do
    check "--faces $n" 0 extract t.pmesh -q -o n.obj --faces "$n"
    ok "--faces $n: not more, at most one less" between "$(faces n.obj)" \
        $((n > 4608 ? 4608 : n - 2)) "$n"
done
check '--ratio 25%' 0 extract t.pmesh -q -o n.obj --ratio 25%
ok '--ratio 25% is of the full mesh' between "$(faces n.obj)" 1150 1152
check '--inflate' 0 extract t.pmesh -q -o fat.obj --ratio 25% --inflate
differ() { ! cmp -s "$1" "$2"; }
faces_of() { grep '^f' "$1" >"$1.faces"; }
faces_of n.obj
faces_of fat.obj
ok '--inflate keeps the faces' cmp -s n.obj.faces fat.obj.faces
ok '--inflate moves vertices' differ n.obj fat.obj
check '--inflate of all' 0 extract t.pmesh -q -o fat.ply --inflate
check '... and without' 0 extract t.pmesh -q -o full.ply
check 'full detail is not inflated' 0 compare full.ply fat.ply --fail-above 1e-6
check '--faces below the base mesh' 0 extract t.pmesh -o n.obj --faces 1
ok '--faces below the base mesh: a warning' err "warning: 1 faces .*$base"
ok '--faces below the base mesh: it is written' test "$(faces n.obj)" = "$base"
check '--error 0' 0 extract t.pmesh -q -o n.obj --error 0
ok '--error 0 is full detail' test "$(faces n.obj)" = 4608
check '--error, generous' 0 extract t.pmesh -q -o n.obj --error 100
ok '--error, generous, is coarse' test "$(faces n.obj)" -le 1000

half=$((bytes / 2))
head -c $half t.pmesh >cut.pmesh
check 'a file cut in half' 0 extract cut.pmesh -o cut.obj
ok 'the warning says how much was there' \
    err "warning: cut off: $half of $bytes bytes"
ok 'it has faces' between "$(faces cut.obj)" "$base" 4607
check 'quiet about the cut' 0 extract cut.pmesh -q -o n.obj
ok 'no warning with -q' silent
check '--bytes' 0 extract t.pmesh -o n.obj --bytes $half
ok '--bytes is as if cut' cmp -s cut.obj n.obj
ok '--bytes as asked is no warning' silent
check 'the same faces of the whole file' 0 \
    extract t.pmesh -q -o n.obj --faces "$(faces cut.obj)"
ok 'a prefix shows what the whole file shows' cmp -s cut.obj n.obj
check '--strict' 4 extract cut.pmesh -o x.obj --strict
check '--strict with a whole file' 0 extract t.pmesh -q -o n.obj --strict
check '--error that is not there' 5 extract cut.pmesh -o x.obj --error 0
ok 'nothing was written' absent x.obj
check 'one byte short' 0 extract t.pmesh -q -o n.obj --bytes $((bytes - 1))
check 'one byte before the base mesh is complete' 4 \
    extract t.pmesh -o x.obj --bytes $((head_bytes - 1))
check 'just the base mesh' 0 extract t.pmesh -q -o n.obj --bytes "$head_bytes"
ok 'just the base mesh: its faces' test "$(faces n.obj)" = "$base"
: >empty.pmesh
check 'an empty file' 4 extract empty.pmesh -o x.obj
check 'no .pmesh' 4 extract full.obj -o x.off
last=0
for percent in 20 40 60 80 99; do
    head -c $((bytes * percent / 100)) t.pmesh >cut.pmesh
    check "$percent % of the bytes" 0 extract cut.pmesh -q -o n.obj
    ok "$percent %: not fewer faces" test "$(faces n.obj)" -ge "$last"
    last=$(faces n.obj)
done

cp t.pmesh bad.pmesh
flip bad.pmesh $((bytes * 3 / 4))
check 'a damaged file' 4 extract bad.pmesh -o x.obj
ok 'the message names the byte' err 'bad.pmesh:byte [0-9]*: '
ok 'no output' absent x.obj
check '--salvage' 0 extract bad.pmesh -o salvage.obj --salvage
ok '--salvage warns' err 'warning: .*salvaged'
check 'the same faces of the good file' 0 \
    extract t.pmesh -q -o n.obj --faces "$(faces salvage.obj)"
ok 'what was salvaged is genuine' cmp -s salvage.obj n.obj
check '--salvage of a good file' 0 extract t.pmesh -o n.obj --salvage
ok '--salvage of a good file is silent' silent
cp t.pmesh bad.pmesh
flip bad.pmesh $((head_bytes - 8))
check '--salvage without a base mesh' 4 extract bad.pmesh -o x.obj --salvage
cat t.pmesh full.obj >tail.pmesh
check 'bytes behind the end' 0 extract tail.pmesh -o n.obj
ok 'bytes behind the end do not matter' cmp -s n.obj full.obj
