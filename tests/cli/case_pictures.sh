# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# Pictures and figures: sheets with heat and quadrics, plot, stats.

png() { [ "$(head -c 4 "$1" | tail -c 3)" = PNG ]; }
for heat in cost error weights; do
    check "sheet --heat $heat" 0 sheet "$baked" -o $heat.png --size 120 \
        --faces 300,1k --heat $heat
    ok 'it is a picture' png $heat.png
    check "sheet --heat $heat again" 0 sheet "$baked" -o again.png --size 120 \
        --faces 300,1k --heat $heat
    ok 'the same bytes' cmp -s $heat.png again.png
done
check 'sheet without heat' 0 sheet "$baked" -o plain.png --size 120 \
    --faces 300,1k
for heat in cost error weights; do
    ok "$heat is something else" test ! "$(cmp -s $heat.png plain.png)"
    cmp -s $heat.png plain.png && ok "$heat colours" false
done
check 'sheet --ellipsoids' 0 sheet "$torus" -o e.png --size 240 \
    --ellipsoids 100 --wire
ok 'it is a picture' png e.png
check 'sheet --heat error of a mesh file' 2 sheet "$torus" -o x.png \
    --heat error
check 'sheet of weights that are not there' 3 sheet "$torus" -o x.png \
    --heat weights --weights color:r
cat >v.json <<'END'
{ "pmesh_guide": 1, "weights": [
    { "sphere": { "center": [3, 0, 0], "radius": 1 }, "weight": 1 } ],
  "cameras": [{ "name": "top", "yaw": 0, "pitch": 90 }] }
END
check 'sheet of the weights of a guide' 0 sheet "$torus" -o w.png --size 120 \
    --heat weights --guide v.json
check 'sheet by a camera of the guide' 0 sheet "$torus" -o t.png --size 120 \
    --guide v.json --camera top
check 'sheet by the same angles' 0 sheet "$torus" -o u.png --size 120 \
    --yaw 0 --pitch 90
ok 'is the same' cmp -s t.png u.png
check 'sheet by no such camera' 3 sheet "$torus" -o x.png --guide v.json \
    --camera front
check 'sheet by a camera of nothing' 2 sheet "$torus" -o x.png --camera top
ok 'nothing is written' absent x.png

check 'stats' 0 stats "$torus" --at-faces 2k,500
ok 'stats has a line for each' test "$(wc -l <"$work/out")" = 3
ok 'at the sizes asked for' out '^ *500  *[0-9.e-]*  *[0-9.e-]*  *[0-9.e-]*'
check 'stats of a .pmesh' 0 stats "$baked" --at-faces 500 --json
ok 'it is JSON' is_json
ok 'schema' test "$(json schema)" = pmesh-stats-1
check 'stats --metric' 0 stats "$torus" --metric accumulated
check 'stats of nothing' 2 stats
check 'stats of no list' 2 stats "$torus" --at-faces x
check 'stats of a missing file' 1 stats no.obj
# Costs grow on the way down.
check 'stats at two sizes' 0 stats "$torus" --at-faces 3k,300
ok 'costs grow as faces go' awk 'NR == 2 { m = $3 } NR == 3 { exit !($3 > 9 * m) }
    ' "$work/out"

"$PMESH" bake "$torus" -q --profile quality -o quality.pmesh
check 'plot' 0 plot "$baked" quality.pmesh -o rate.svg
ok 'it is SVG' grep -q '^<svg .*xmlns' rate.svg
ok 'it names the files' grep -q '>quality.pmesh</text>' rate.svg
check 'plot again' 0 plot "$baked" quality.pmesh -o again.svg
ok 'the same bytes' cmp -s rate.svg again.svg
check 'plot --measure' 0 plot quality.pmesh -o m.svg --measure
ok 'with a point for each level' test "$(grep -c '<circle' m.svg)" -ge 3
check 'plot of a mesh file' 3 plot "$torus" -o x.svg
check 'plot of nothing' 2 plot -o x.svg
check 'plot of a missing file' 1 plot no.pmesh -o x.svg
