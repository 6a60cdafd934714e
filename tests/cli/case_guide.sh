# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# Guidance: where weights come from, and what guide files may say.

check 'guide' 0 guide "$torus" -o t.guide.json
ok 'guide is silent' silent
cp t.guide.json "$work/out"
ok 'it writes JSON' is_json
check 'bake by an empty guide' 0 bake "$torus" -q -o e.pmesh \
    --guide t.guide.json
ok 'which changes no byte' cmp -s e.pmesh "$baked"
check 'guide without output' 2 guide "$torus"
check 'guide of nothing' 1 guide no.obj -o g.json

# right FILE: vertices that an OBJ file has at x > 0.
right() { awk '/^v/ && $2 > 0 { n++ } END { print n + 0 }' "$1"; }
# level NAME OPTION...: sets kept, the vertices at 600 faces that are at x > 0.
level() {
    name=$1
    shift
    check "bake $name" 0 bake -q -o w.pmesh "$@"
    check "verify $name" 0 verify -q w.pmesh
    "$PMESH" extract -q w.pmesh --faces 600 -o w.obj
    kept=$(right w.obj)
}
level plain "$torus"
plain=$kept

cat >box.json <<'END'
{ "pmesh_guide": 1, "weights": [
    { "all": true, "weight": 0.5 },
    { "box": [[0, -9, -9], [9, 9, 9]], "weight": 1 } ] }
END
level 'weights of a box' "$torus" --guide box.json
ok 'the box keeps more' test "$kept" -gt $((plain + 40))

# The same weights as colours, as quality, and in an attribute of glTF.
awk '/^v / { print $0, ($2 > 0), 0, ($2 <= 0) * 0.5; next } { print }' \
    "$torus" >c.obj
level 'weights of colours' c.obj --weights color:r --no-attributes
ok 'colours keep more' test "$kept" -gt $((plain + 40))
level 'a difference of colours' c.obj --weights color:r-b --no-attributes
ok 'a difference keeps more' test "$kept" -gt $((plain + 40))
awk '/^v / { v[n++] = $2 " " $3 " " $4 " " ($2 > 0 ? 1 : 0.5) }
     /^f / { f[m++] = "3 " $2 - 1 " " $3 - 1 " " $4 - 1 }
     END {
        print "ply\nformat ascii 1.0\nelement vertex " n
        print "property float x\nproperty float y\nproperty float z"
        print "property float quality\nelement face " m
        print "property list uchar int vertex_indices\nend_header"
        for (i = 0; i < n; i++) print v[i]
        for (i = 0; i < m; i++) print f[i]
     }' "$torus" >q.ply
level 'weights of a quality' q.ply --weights attr:quality --no-attributes
ok 'quality keeps more' test "$kept" -gt $((plain + 40))

# A picture whose left half is black, at u = 0 or 0.5 to 1.
{
    printf '\211PNG\015\012\032\012\000\000\000\015IHDR\000\000\000\002\000\000'
    printf '\000\001\010\000\000\000\000\321I\040V\000\000\000\013IDATx\234ch\370'
    printf '\017\000\002\002\001\200nV\213\023\000\000\000\000IEND\256B`\202'
} >half.png
awk '/^v / { print; print "vt", ($2 > 0) ? 0.75 : 0.25, 0.5; next }
     /^f / { print "f", $2 "/" $2, $3 "/" $3, $4 "/" $4 }' "$torus" >t.obj
if "$PMESH" bake t.obj -q -o x.pmesh --weights texture:half.png 2>/dev/null; then
    level 'weights of a picture' t.obj --weights texture:half.png \
        --no-attributes
    ok 'the picture keeps more' test "$kept" -gt $((plain + 40))
else
    ok 'a picture can be read' false
fi

check 'weights into a guide' 0 guide q.ply --weights attr:quality -o w.json
check 'bake by them' 0 bake q.ply --no-attributes -q -o a.pmesh --guide w.json
check 'or directly' 0 bake q.ply --no-attributes -q -o b.pmesh \
    --weights attr:quality
ok 'is the same' cmp -s a.pmesh b.pmesh

# The guide serves another mesh: half the vertices in another order.
torus 30 other.obj
check 'bake another mesh by it' 0 bake other.obj -o o.pmesh --guide w.json
ok 'with a warning' err 'warning: .*another mesh.*nearest'
"$PMESH" extract -q o.pmesh --faces 600 -o o.obj
"$PMESH" bake other.obj -q -o p.pmesh
"$PMESH" extract -q p.pmesh --faces 600 -o p.obj
ok 'weights are carried over' test "$(right o.obj)" -gt $(($(right p.obj) + 40))
cat >numbers.json <<'END'
{ "pmesh_guide": 1, "source": { "hash": "0123456789abcdef" },
  "locks": [{ "vertices": [1, 2] }] }
END
check 'numbers of another mesh without places' 3 bake "$torus" -o a.pmesh \
    --guide numbers.json
ok 'says what is missing' err 'locks\[0\].vertices: .*source.positions'

cat >all.json <<'END'
{ "pmesh_guide": 1, "comment": "one of each", "factor": 20,
  "weights": [{ "sphere": { "center": [3, 0, 0], "radius": 1, "falloff": 0.5 },
                "weight": 0.9 }],
  "locks": [{ "vertices": [0, 5] }, { "positions": [[-3, 0, 0]] }],
  "contours": [{ "vertices": [48, 96, 144], "closed": true, "importance": 2 },
               { "crease": 40, "seams": true, "borders": true }],
  "planes": [{ "box": [[-9, -9, 0.9], [9, 9, 9]] }],
  "points": [{ "vertices": [100], "importance": 0.5 }],
  "segments": [{ "name": "right", "box": [[1, -9, -9], [9, 9, 9]],
                 "share": 0.6 }],
  "cameras": [{ "name": "top", "yaw": 0, "pitch": 90 }] }
END
for placement in subset optimal; do
    check "bake by a guide with one of each, $placement" 0 bake "$torus" -q \
        -o all.pmesh --guide all.json --placement $placement
    ok 'without a word' silent
    check 'verify it' 0 verify -q all.pmesh
done
if command -v python3 >/dev/null && python3 -c 'import jsonschema' 2>/dev/null
then
    for file in all.json box.json t.guide.json; do
        ok "$file follows the schema" python3 -c '
import json, sys, jsonschema
jsonschema.validate(json.load(open(sys.argv[1])), json.load(open(sys.argv[2])))
' $file "$cases/../../tools/guide.schema.json"
    done
fi

# bad TEXT WHAT: a guide with TEXT is refused, by a message with WHAT.
bad() {
    printf '%s' "$1" >bad.json
    check "refuses $1" 3 bake "$torus" -o a.pmesh --guide bad.json
    ok 'says where' err "bad.json:.*$2"
}
bad '{' 'not JSON'
bad '[]' 'pmesh_guide'
bad '{"pmesh_guide":2}' 'version 1'
bad '{"pmesh_guide":1,"lock":[]}' 'lock: no member'
bad '{"pmesh_guide":1,"locks":{}}' 'locks: a list'
bad '{"pmesh_guide":1,"locks":[{"vertices":[99999]}]}' 'vertex 99999'
bad '{"pmesh_guide":1,"locks":[{"vertices":[-1]}]}' 'vertex numbers'
bad '{"pmesh_guide":1,"locks":[3]}' 'locks.0.: an object'
bad '{"pmesh_guide":1,"points":[{"box":[[0,0,0]]}]}' 'two corners'
bad '{"pmesh_guide":1,"points":[{"all":true,"importance":-1}]}' 'importance'
bad '{"pmesh_guide":1,"weights":[{"all":true}]}' 'weight is missing'
bad '{"pmesh_guide":1,"weights":[{"all":true,"weight":2}]}' '0 .. 1'
bad '{"pmesh_guide":1,"weights":[{"values":[1,2]}]}' '2 weights for 2304'
bad '{"pmesh_guide":1,"weights":[{"values":["a"]}]}' 'a number'
bad '{"pmesh_guide":1,"contours":[{"all":true}]}' 'a path'
bad '{"pmesh_guide":1,"factor":1}' 'factor'
bad '{"pmesh_guide":1,"segments":[{"all":true,"share":"x"}]}' 'share'
bad '{"pmesh_guide":1,"cameras":[{"yaw":1}]}' 'cameras.0'
check 'a guide that is not there' 1 bake "$torus" -o a.pmesh --guide no.json
check 'weights that the mesh has not' 3 bake "$torus" -o a.pmesh \
    --weights color:r
check 'an attribute that the mesh has not' 3 bake "$torus" -o a.pmesh \
    --weights attr:heat
check 'weights by no known source' 3 bake "$torus" -o a.pmesh --weights heat
check 'a picture that is none' 3 bake t.obj -o a.pmesh \
    --weights texture:t.obj
check 'a picture that is not there' 3 bake t.obj -o a.pmesh \
    --weights texture:no.png
ok 'nothing is written' absent a.pmesh.tmp

check 'bake --crease' 0 bake "$torus" -q -o r.pmesh --crease 10
check 'bake --contours' 0 bake t.obj -q -o r.pmesh --contours all

# A mesh none of whose vertices is near to anything.
awk '/^element vertex/ { print; v = $3; next }
     /^end_header/ { print; for (; v > 0; v--) print "nan 0 0 1"; body = 1 }
     body && $1 != 3 { next } { if ($0 != "end_header") print }' q.ply >nan.ply
printf '{"pmesh_guide": 1, "%s": [{"positions": [[0, 0, 0]], %s}]}' \
    weights '"weight": 1' >near.json
check 'a guide for a mesh without places' 3 bake nan.ply -o a.pmesh \
    --guide near.json
ok 'says so' err 'near.json: weights\[0\].positions: .*finite place'

# However deep it is, and however often a few bytes name everything.
awk 'BEGIN { printf "{\"pmesh_guide\": 1, \"source\": "
             for (i = 0; i < 200000; i++) printf "["
             for (i = 0; i < 200000; i++) printf "]"
             print "}" }' >deep.json
check 'a deep guide' 3 bake "$torus" -o a.pmesh --guide deep.json
ok 'says what is wrong' err 'deep.json: source: an object is expected'
awk 'BEGIN { printf "{\"pmesh_guide\": 1, \"points\": [{\"all\": 0}"
             for (i = 0; i < 40000; i++) printf ",{\"all\": 0}"
             print "]}" }' >all.json
check 'a guide that names too much' 3 bake "$torus" -o a.pmesh \
    --guide all.json
ok 'says so' err 'all.json: points\[[0-9]*\]: .*more than 2^26 vertices'
