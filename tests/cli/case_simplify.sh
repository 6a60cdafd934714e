# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# Fewer faces without a .pmesh in between. The torus has 4608 faces.

check 'simplify' 0 simplify "$torus" -o n.obj --faces 500
ok 'no warning' silent
ok 'one line of report' out '500 of 4608 faces'
ok '--faces' between "$(faces n.obj)" 499 500
check 'the same again' 0 simplify "$torus" -q -o again.obj -n 500
ok 'the same bytes' cmp -s n.obj again.obj
check '--ratio' 0 simplify "$torus" -q -o n.obj --ratio 25%
ok '--ratio is met' between "$(faces n.obj)" 1151 1152
check '--vertices' 0 simplify "$torus" -o n.obj --vertices 300 --json
ok '--vertices is met' test "$(json vertices)" = 300
ok 'why it ended' out '"end": "vertices"'
check '--error' 0 simplify "$torus" -o n.obj --error 0.01 --json
ok '--error: why it ended' out '"end": "error"'
ok '--error: fewer faces' between "$(json faces)" 4 4000
check '--error 0' 0 simplify "$torus" -q -o n.obj --error 0
ok '--error 0: nothing may be lost' test "$(faces n.obj)" = 4608
check '--ratio 0' 0 simplify "$torus" -o n.obj --ratio 0
ok '--ratio 0: as far as it goes' between "$(faces n.obj)" 4 40
ok '--ratio 0: a warning' err 'warning: stopped at'
check 'the first of several bounds' 0 \
    simplify "$torus" -q -o n.obj --faces 100 --ratio 50%
ok 'the first of several bounds is met' between "$(faces n.obj)" 2303 2304
check 'more faces than there are' 0 simplify "$torus" -o n.obj --faces 1M
ok 'more faces than there are: all' test "$(faces n.obj)" = 4608

for format in obj ply stl off gltf glb drc; do
    check "into $format" 0 simplify "$torus" -q -o "s.$format" --faces 400
    check "$format is a mesh" 0 bake "s.$format" --json -o back.pmesh
    ok "$format has the faces" between "$(json faces)" 399 400
done
"$PMESH" simplify - -q -o - --format obj --faces 500 <"$torus" >pipe.obj
ok 'from pipe to pipe' cmp -s pipe.obj again.obj
check 'of a .pmesh' 0 simplify "$baked" -q -o n.obj --faces 300
ok 'of a .pmesh: its faces' between "$(faces n.obj)" 299 300

for placement in optimal line midpoint endpoint volume hull; do
    check "--placement $placement" 0 simplify "$torus" -q -o "$placement.obj" \
        --faces 300 --placement $placement
done
places() { # FILE, as the torus was written
    awk '$1 == "v" { printf "%.6f %.6f %.6f\n", $2, $3, $4 }' "$1" | sort
}
places "$torus" >all
places endpoint.obj | comm -23 - all >strange
ok 'endpoint: vertices of the input' test ! -s strange
places optimal.obj | comm -23 - all >strange
ok 'optimal: other vertices' test "$(size strange)" -gt 1000
for cost in quadric length; do
    check "--cost $cost" 0 simplify "$torus" -q -o n.obj -n 300 --cost $cost
done
for cost in camera quadric-camera; do
    check "--cost $cost" 0 simplify "$torus" -o n.obj -n 300 --cost $cost \
        --camera 0,0,9 --json
    ok "--cost $cost: costs are told" out '"cost_max": [0-9]'
    check "--cost $cost without --camera" 2 \
        simplify "$torus" -o x.obj -n 300 --cost $cost
done
check '--camera without use' 2 simplify "$torus" -o x.obj -n 9 --camera 0,0,9
for camera in '' 1,2 1,2,3,4 1,2,x 1,,2 nan,0,0; do
    check "--camera '$camera'" 2 simplify "$torus" -o x.obj -n 9 \
        --cost camera --camera "$camera"
done
check '--metric and --memory' 0 simplify "$torus" -q -o n.obj -n 300 \
    --metric accumulated --memory 0
check 'weights' 0 simplify "$torus" -q -o n.obj -n 300 --normal-weight 0 \
    --uv-weight 0.5 --color-weight 0
check '--no-attributes' 0 simplify "$torus" -q -o n.obj -n 300 --no-attributes
ok '--no-attributes: none' test "$(grep -cE '^v[nt] ' n.obj)" = 0

cat >two.off <<'MESH'
OFF
8 8 0
0 0 0
1 0 0
0 1 0
0 0 1
5 0 0
6 0 0
5 1 0
5 0 1
3 0 2 1
3 0 1 3
3 1 2 3
3 2 0 3
3 4 6 5
3 4 5 7
3 5 6 7
3 6 4 7
MESH
check 'exhausted' 0 simplify two.off -o n.obj --faces 2
ok 'exhausted: a warning says where' err 'warning: stopped at 8 faces'
ok 'exhausted: it is written' test "$(faces n.obj)" = 8
check '--loose' 0 simplify two.off -q -o n.obj --faces 4 --loose
ok '--loose lets a piece vanish' test "$(faces n.obj)" = 4
printf 'OFF\n3 1 0\n0 0 0\n0 0 0\n1 0 0\n3 0 1 2\n' >flat.off
check 'no face with an area' 3 simplify flat.off -o x.obj --faces 1

check 'without a bound' 2 simplify "$torus" -o x.obj
ok 'without a bound: they are named' err '--faces'
check 'without input' 2 simplify -o x.obj --faces 9
check 'two inputs' 2 simplify "$torus" "$torus" -o x.obj --faces 9
check 'without output' 2 simplify "$torus" --faces 9
check 'a name that does not tell' 2 simplify "$torus" -o x --faces 9
check 'stdout without --format' 2 simplify "$torus" -o - --faces 9
check '--json and -o -' 2 simplify "$torus" -o - --format obj --json -n 9
check 'no such file' 1 simplify nothing.obj -o x.obj --faces 9
check 'onto the input' 1 simplify again.obj -o again.obj --faces 9
ok 'nothing was written' absent x.obj
