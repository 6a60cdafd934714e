# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# Surfaces that are not manifold, or in pieces.

# 300 leaves of two triangles, apart from each other.
awk 'BEGIN { for (i = 0; i < 300; i++) {
    x = i % 17; y = i % 13; z = i % 11
    print "v", x, y, z; print "v", x + .3, y, z; print "v", x, y + .3, z
    print "v", x + .3, y + .3, z + .1
    print "f", 4 * i + 1, 4 * i + 2, 4 * i + 3
    print "f", 4 * i + 3, 4 * i + 2, 4 * i + 4 } }' >leaves.obj
check 'bake leaves' 0 bake leaves.obj -o l.pmesh --base-faces 50
ok 'the report tells that pieces join' out 'joined: .* 300 pieces'
check 'leaves in JSON' 0 bake leaves.obj -o l.pmesh --base-faces 50 --json
ok 'they join' test "$(json joined)" = true
ok 'the base is as wanted' between "$(json base_faces)" 1 50
ok 'the pieces are counted' test "$(json components)" = 300
ok 'fewer are left' between "$(json base_components)" 1 50
check 'verify leaves' 0 verify l.pmesh
check 'info of leaves' 0 info l.pmesh
ok 'info says so' out '^levels .*, joined$'
check 'all leaves' 0 extract -q l.pmesh -o l.obj
ok 'are there' test "$(faces l.obj)" = 600
check 'at their places' 0 compare leaves.obj l.obj --fail-above 0.001
check 'keep leaves' 0 bake leaves.obj -o k.pmesh --base-faces 50 --json \
    --topology keep
ok 'they do not join' test "$(json joined)" = false
ok 'each keeps a face' between "$(json base_faces)" 300 600
check 'leaves and a Draco base' 0 bake leaves.obj -o d.pmesh --base draco --json
ok 'auto keeps them then' test "$(json joined)" = false
check 'a Draco base that should join' 0 bake leaves.obj -o d.pmesh \
    --base draco --topology join --base-faces 50
ok 'is coded natively, with a warning' err 'coded natively'
check 'a torus' 0 bake "$torus" -o t.pmesh --json
ok 'stays as it is' test "$(json joined)" = false
check 'a torus that may join' 0 bake "$torus" -o j.pmesh -q --topology join
check 'verify it' 0 verify j.pmesh
check 'a threshold' 0 bake leaves.obj -o t.pmesh --threshold 2 --json
ok 'joins' test "$(json joined)" = true
check 'a threshold without joining' 2 bake leaves.obj -o x.pmesh \
    --threshold 2 --topology keep
check 'an unknown topology' 2 bake leaves.obj -o x.pmesh --topology glue
ok 'nothing was written' absent x.pmesh
