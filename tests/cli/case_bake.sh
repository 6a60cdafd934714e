# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# Baking: what it reports, and what it says to bad input.

check 'bake' 0 bake "$torus" -o a.pmesh
ok 'bake has nothing to warn of' silent
ok 'the report counts faces' out '4608 faces, 2304 vertices'
check 'bake -q' 0 bake "$torus" -o q.pmesh -q
ok 'bake -q reports nothing' test ! -s "$work/out"
ok 'bake -q warns of nothing' silent
check 'bake -v' 0 bake "$torus" -o v.pmesh -v
ok 'bake -v prints the level table' out '^level '
check 'bake -j 2' 0 bake "$torus" -o j.pmesh -q -j 2
check 'bake again, with a progress report' 0 \
    bake "$torus" -o p.pmesh --progress
for copy in q v j p; do
    ok "the same bytes ($copy)" cmp -s a.pmesh $copy.pmesh
done
check 'bake a .pmesh again' 0 bake a.pmesh -o again.pmesh -q
check 'but not onto itself' 1 bake a.pmesh -o a.pmesh

check 'bake --json' 0 bake "$torus" -o a.pmesh --json
ok 'it is JSON' is_json
ok 'schema' test "$(json schema)" = pmesh-bake-1
ok 'faces' test "$(json faces)" = 4608
ok 'vertices' test "$(json vertices)" = 2304
ok 'bytes' test "$(json bytes)" = "$(size a.pmesh)"
for key in tool version input output levels timings dropped warnings; do
    ok "--json has $key" out "^  \"$key\": "
done
check 'a name that needs escapes' 0 bake "$torus" --json \
    -o "$(printf 'a"\\\001\377.pmesh')"
ok 'escapes are valid JSON' is_json

for option in '--profile compact' '--profile quality' '--placement optimal' \
    '--metric accumulated' '--position-bits 8' '--position-bits 24' \
    '--base-faces 1000' '--max-error 0.01' '--weld 1e-9' '--threshold 0.01' \
    '--lossless --weld 1e-9' '--base-ratio 25%' '--base-vertices 300' \
    '--cost length' '--cost camera --camera 0,0,9' \
    '--cost quadric-camera --camera 0,0,-9' '--generic-weight 1' \
    '--normal-weight 0 --uv-weight 0.5 --color-weight 1e6'; do
    # shellcheck disable=SC2086 # two words on purpose
    check "bake $option" 0 bake "$torus" -q -o o.pmesh $option
    check "verify after $option" 0 verify -q o.pmesh
done

check 'the first stop counts' 0 bake "$torus" -o o.pmesh --json \
    --base-faces 100 --base-vertices 90 --base-ratio 29%
ok 'it was the ratio' test "$(json end)$(json base_faces)" = faces1336
check 'or another one' 0 bake "$torus" -o o.pmesh --json \
    --base-faces 100 --base-vertices 900
ok 'the vertices' test "$(json end)$(json base_vertices)" = vertices900
check 'or the error' 0 bake "$torus" -o o.pmesh --json --base-faces 100 \
    --max-error 0.001
ok 'it was' test "$(json end)" = error
check 'more than there is to contract' 0 bake "$torus" -o o.pmesh --json \
    --base-faces 1
ok 'is told' test "$(json end)" = exhausted
ok 'and warned of' err 'nothing more can be contracted'
check 'bake --measure' 0 bake "$torus" -o m.pmesh --json --measure
ok 'levels are measured' out '"furthest": '
check 'bake --measure -v' 0 bake "$torus" -o m.pmesh -v --measure
ok 'and listed' out 'rms    furthest$'
check 'verify a measured file' 0 verify m.pmesh
check 'info of a measured file' 0 info --json m.pmesh
ok 'info knows' test "$(json measured)" = true
ok 'and tells' out '"rms": '
check 'plan of a measured file' 0 plan m.pmesh --faces 1000
ok 'tells what was measured' out '^measured .* rms, .* at most$'
check 'plan --json of it' 0 plan m.pmesh --faces 1000 --json
ok 'is near what is bounded' awk -v rms="$(json rms)" \
    -v most="$(json furthest)" \
    'BEGIN { exit !(0 < rms && rms < most) }'
check 'info of another' 0 info --json a.pmesh
ok 'others are not' test "$(json measured)" = false
check 'a cost with camera needs one' 2 bake "$torus" -o o.pmesh --cost camera
check 'the others do not' 2 bake "$torus" -o o.pmesh --camera 1,2,3
check 'it has three coordinates' 2 bake "$torus" -o o.pmesh --cost camera \
    --camera 1,2
check 'a negative weight' 2 bake "$torus" -o o.pmesh --uv-weight -1

check 'bake --base draco' 0 bake "$torus" -o d.pmesh --base draco \
    --base-faces 500 --json
ok 'the report names the base coder' test "$(json base_coder)" = draco
check 'verify a Draco base' 0 verify d.pmesh
check 'info of a Draco base' 0 info d.pmesh
ok 'info names the base coder' out '^base mesh .* draco coder$'
check 'info --json of a Draco base' 0 info d.pmesh --json
ok 'info --json names it, too' test "$(json base_coder)" = draco
check 'extract from a Draco base' 0 extract -q d.pmesh -o d.obj
ok 'all faces are there' test "$(faces d.obj)" = 4608
check 'extract the base' 0 extract -q d.pmesh --faces 500 -o d.obj
ok 'it has the size' test "$(faces d.obj)" = 500
check 'compare with a Draco base' 0 compare d.pmesh a.pmesh --fail-above 0
check 'sheet of a Draco base' 0 sheet d.pmesh -o d.png --size 120
check 'bake a Draco base again' 0 bake d.pmesh -o again.pmesh -q
cp d.pmesh bad.pmesh
flip bad.pmesh $(($(size d.pmesh) / 20))
check 'a damaged Draco base' 4 verify bad.pmesh
head -c $(($(size d.pmesh) / 20)) d.pmesh >bad.pmesh
check 'a Draco base that is cut off' 4 extract bad.pmesh -o bad.obj

tetra='v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4'
mesh() { printf '%s\n' "$@" >m.obj; }

mesh "$tetra"
check 'the smallest closed mesh' 0 bake m.obj -o m.pmesh -q
check 'it is good' 0 verify m.pmesh
mesh 'v 0 0 0' 'v 1 0 0' 'v 0 1 0'
check 'no triangle' 3 bake m.obj -o x.pmesh
ok 'no triangle: the file is named' err '^pmesh: m.obj:'
: >m.obj
check 'empty file' 3 bake m.obj -o x.pmesh
mesh 'v 0 0 0' 'v 1 0 0' 'v 0 1 0' 'f 1 2 9'
check 'index out of range' 3 bake m.obj -o x.pmesh
ok 'index out of range: the line is named' err 'm.obj:line 4:'
mesh 'v nan 0 0' 'v 1 0 0' 'v 0 1 0' 'f 1 2 3'
check 'no finite face' 3 bake m.obj -o x.pmesh
ok 'nothing was written' absent x.pmesh
mesh "$tetra" 'v nan 0 0' 'f 1 2 5'
check 'a position that is not finite' 0 bake m.obj -o m.pmesh
ok 'one counted warning' test "$(grep -c 'm.obj: warning: 1 ' "$work/err")" = 1
mesh "$tetra" 'f 1 3 2' 'f 1 1 2'
check 'a copy and a degenerate face' 0 bake m.obj -o m.pmesh
ok 'both are counted' test "$(grep -c 'm.obj: warning: 1 ' "$work/err")" = 2
check 'and in JSON' 0 bake m.obj -o m.pmesh --json
ok 'two warnings in JSON' test "$(json warning_count)" = 2
check 'random bytes' 3 bake "$PMESH" -o x.pmesh
printf '%s\n' ply 'format ascii 1.0' 'element vertex 4000000000' \
    'property float x' 'property float y' 'property float z' \
    'element face 1' 'property list uchar int vertex_indices' \
    end_header '0 0 0' >m.ply
check 'counts that the file cannot back' 3 bake m.ply -o x.pmesh
