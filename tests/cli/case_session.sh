# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# Sessions by script.

cat >walk.txt <<END
load $torus  # 4608 faces
faces 600
weight 1 sphere 3 0 0 1
faces 4608
faces 600
save guided.obj
undo
undo
undo
faces 600
save plain.obj
END
check 'session' 0 session walk.txt
ok 'one line for each action' test "$(wc -l <"$work/out")" = 11
ok 'with the faces it leads to' out '^faces 600  *600 faces  error [0-9.e-]*$'
right() { awk '/^v/ && $2 > 2.2 { n++ } END { print n + 0 }' "$1"; }
ok 'as many faces as asked' test "$(faces guided.obj)" = 600
ok 'more where it was painted' test "$(right guided.obj)" -gt \
    $((3 * $(right plain.obj) / 2))
check 'session -q' 0 session -q walk.txt
ok 'says nothing' test ! -s "$work/out"

cat >cut.txt <<END
load $torus
faces 500
plane 2 box -9 -9 0.8 9 9 9
point vertices 0 17
contour 1 vertices 0 48 96
faces 300
cut 0 box 1 -9 -9 9 9 9
save cut.obj
END
check 'a cut by region' 0 session cut.txt
ok 'is finer there' test "$(faces cut.obj)" -gt 1000
ok 'tells what it forced' out 'contractions out of order'

# bad LINE WHAT: a second line that is refused, by a message with WHAT.
bad() {
    printf 'load %s\n%s\n' "$torus" "$1" >bad.txt
    check "refuses $1" 2 session bad.txt
    ok 'says where' err "bad.txt:line 2: .*$2"
}
bad 'faces' 'a number'
bad 'faces 5k' 'k. is too much'
bad 'paint 1 all' "unknown action 'paint'"
bad 'weight 2 all' 'out of range\|argument'
bad 'weight 1 cone 1 2 3' 'sphere, box'
bad 'weight 1 sphere 1 2 3' 'a number'
bad 'weight 1 all of it' 'too much'
bad 'point vertices 1 x' 'vertex numbers'
bad 'point vertices 99999' 'vertex 99999'
bad 'undo' 'nothing to undo'
bad 'save x.abc' 'no mesh format'
printf 'faces 3\n' >bad.txt
check 'nothing is loaded' 2 session bad.txt
printf 'load no.obj\n' >bad.txt
check 'a mesh that is not there' 1 session bad.txt
check 'a script that is not there' 1 session no.txt
check 'no script' 2 session
