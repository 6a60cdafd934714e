# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# glTF files with more in them than one mesh.

# Two quads in two nodes: one triangle pair each, as text.
cat >two.gltf <<'END'
{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0,"name":"near"},{"mesh":1,"scale":[4,4,4]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]},
{"primitives":[{"attributes":{"POSITION":0}}],"name":"second"}],
"materials":[{"name":"unused"}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
"min":[0,0,0],"max":[1,1,0]}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":
"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}
END
check 'a glTF file of two meshes' 0 bake two.gltf -o two.pmesh --json
ok 'it is a scene' out '"scene": true'
ok 'of two meshes' test "$(json meshes)" = 2
for nodes in '"children":[0]' '"children":[1]' '"children":[1],"mesh":0'; do
    sed "s/\"mesh\":0,\"name\":\"near\"/$nodes/" two.gltf >loop.gltf
    check "nodes that are no tree ($nodes)" 3 bake loop.gltf -o loop.pmesh
    ok 'are named' err 'is met twice: the nodes are not a tree'
done
check '--merge' 0 bake two.gltf -o one.pmesh --merge --json
ok '--merge makes one mesh' out '"scene": false'
check 'info of a scene' 0 info two.pmesh --levels
ok 'info knows the scale' out 'scale 4'
check 'info of a scene as JSON' 0 info two.pmesh --json
ok 'it is JSON' is_json
check 'verify a scene' 0 verify two.pmesh
ok 'verify counts the meshes' out 'a scene of 2 meshes'
check 'out again' 0 extract two.pmesh -o back.gltf
ok 'nodes have their names' grep -q '"near"' back.gltf
ok 'the report counts faces' out '2 of 2 faces, 2 meshes'
check 'to another format' 0 extract two.pmesh -q -o back.obj
ok 'both meshes are there' test "$(faces back.obj)" = 2
ok 'it names a library' grep -q '^mtllib back.mtl$' back.obj
ok 'which has the material' grep -q '^newmtl unused$' back.mtl
rm back.mtl
check 'to standard output' 0 extract two.pmesh -q --format obj -o -
ok 'there is no library' test ! -e back.mtl
mkdir held.mtl
check 'where a library cannot be' 1 extract two.pmesh -q -o held.obj
ok 'the message names it' err 'held.mtl: '
ok 'there is no mesh without it' test ! -e held.obj
sed 's/{"name":"unused"}/{"name":"a"},{"name":"a"},{}/' two.gltf >names.gltf
"$PMESH" bake names.gltf -q -o names.pmesh
check 'materials of one name' 0 extract names.pmesh -q -o names.obj
ok 'get several' test "$(grep newmtl names.mtl | sort -u | wc -l)" = 3
check 'one mesh' 0 extract two.pmesh -q --mesh 1 -o back.obj
ok 'one mesh is one' test "$(faces back.obj)" = 1
# Of ten nodes the first nine show a torus, the tenth shows another one.
cat >many.py <<'END'
import json, math, struct, base64
n = 24
turn = [2 * math.pi * i / n for i in range(n)]
at = [((2 + math.cos(u)) * math.cos(v), (2 + math.cos(u)) * math.sin(v),
       math.sin(u)) for u in turn for v in turn]
face = [f for i in range(n) for k in range(n)
        for a, b, c, d in [[(i + y) % n * n + (k + x) % n
                            for y in (0, 1) for x in (0, 1)]]
        for f in [(a, c, b), (b, c, d)]]
data = b"".join(struct.pack("<3f", *p) for p in at)
split = len(data)
data += b"".join(struct.pack("<3I", *f) for f in face)
mesh = {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}
json.dump({"asset": {"version": "2.0"}, "scene": 0,
    "scenes": [{"nodes": list(range(10))}],
    "nodes": [{"mesh": i // 9, "translation": [7 * i, 0, 0]}
              for i in range(10)],
    "meshes": [mesh, mesh],
    "accessors": [
        {"bufferView": 0, "componentType": 5126, "count": len(at),
         "type": "VEC3", "min": [-3, -3, -1], "max": [3, 3, 1]},
        {"bufferView": 1, "componentType": 5125, "count": 3 * len(face),
         "type": "SCALAR"}],
    "bufferViews": [
        {"buffer": 0, "byteLength": split},
        {"buffer": 0, "byteOffset": split, "byteLength": len(data) - split}],
    "buffers": [{"byteLength": len(data), "uri":
        "data:application/octet-stream;base64," +
        base64.b64encode(data).decode()}]}, open("many.gltf", "w"))
END
python3 many.py
check 'a scene of instances' 0 bake many.gltf -q -o many.pmesh
check 'all of it' 0 extract many.pmesh -q -o many.obj
all=$(faces many.obj)
for bound in 2000 4000 9000; do
    check "at most $bound faces" 0 extract many.pmesh --faces $bound -o many.obj
    got=$(faces many.obj)
    ok 'count as they are drawn' test "$got" -le $bound
    ok 'and come near' test "$got" -gt $((bound * 9 / 10))
    ok 'and are told so' out "many.obj: $got of $all faces"
done
check 'a share of them' 0 extract many.pmesh -q --ratio 50% -o many.obj
ok 'is one of what is drawn' test "$(faces many.obj)" -le $((all / 2))
check 'levels' 0 extract two.pmesh -q --lods 100%,50% -o x.glb
for lods in '' 50%,100% 0% 120% 1,x 1,; do
    check "levels \"$lods\"" 1 extract two.pmesh --lods "$lods" -o x.glb
done
check 'levels of a mesh' 2 extract one.pmesh --lods 100%,50% -o x.glb
check 'levels into another format' 1 extract two.pmesh --lods 1 -o x.obj
check 'Draco of a mesh' 2 extract one.pmesh --draco -o x.glb
check 'Draco and meshopt' 2 extract two.pmesh --draco --meshopt -o x.glb
check 'Draco into another format' 1 extract two.pmesh --draco -o x.obj
check 'Draco' 0 extract two.pmesh --draco -q -o packed.glb
check 'it is the scene' 0 compare two.gltf packed.glb
# Two images, one in a file whose name has a blank, one that is not below.
mkdir -p pictures/in && printf '\211PNG\r\n\032\n12345678' >'pictures/in/a b.png'
cp 'pictures/in/a b.png' outside.png
sed 's|"scene":0|"scene":0,"images":[{"uri":"in/a%20b.png"},\
{"uri":"../outside.png"}],"textures":[{"source":0},{"source":1}]|
s|{"name":"unused"}|{"name":"paint","pbrMetallicRoughness":\
{"baseColorTexture":{"index":0}},"normalTexture":{"index":1}}|' \
    two.gltf >pictures/in.gltf
check 'textures that stay' 0 bake pictures/in.gltf -o out.pmesh \
    --textures external --json
ok 'the report names them' out 'image 0 stays in in/a%20b.png'
ok 'and those out of reach' out 'image 1 stays outside: '
ok 'they take no bytes' test "$(json resource_bytes)" = 0
check 'the scene shows them' 0 extract out.pmesh -q -o pictures/out.gltf
ok 'by their paths' grep -q '"uri": "in/a%20b.png"' pictures/out.gltf
check 'bake that' 0 bake pictures/out.gltf -o in.pmesh --json
ok 'which takes them in' test "$(json resource_bytes)" -gt 15
check 'into a GLB' 0 bake pictures/in.gltf -q -o pictures/out.glb \
    --textures external
ok 'they stay there, too' grep -q 'in/a%20b.png' pictures/out.glb
check 'as OBJ' 0 extract out.pmesh -q -o pictures/out.obj
ok 'the library has the path' grep -q '^map_Kd in/a b.png$' pictures/out.mtl
ok 'but none that leads out' test "$(grep -c outside pictures/out.mtl)" = 0
check 'a GLB with a scene' 0 bake two.gltf -q -o tail.glb
ok 'info sees the scene' "$PMESH" info --json tail.glb
check 'verify it' 0 verify tail.glb
check 'extract from it' 0 extract tail.glb -q -o x.glb
check 'compare it' 0 compare two.gltf tail.glb
check 'a GLB of what is no scene' 2 bake back.obj -o x.glb
check 'a mesh that is not there' 2 extract two.pmesh --mesh 2 -o x.obj
check '--mesh of a single mesh' 2 extract one.pmesh --mesh 1 -o x.obj
check 'compare scene and input' 0 compare two.gltf two.pmesh
"$PMESH" extract - -q -o - --format glb <two.pmesh >pipe.glb
check 'from pipe to pipe' 0 bake pipe.glb -q -o again.pmesh
bytes=$(size two.pmesh)
head -c $((bytes - 1)) two.pmesh >cut.pmesh
check 'verify a scene that is cut off' 4 verify cut.pmesh
check '--strict' 4 extract cut.pmesh --strict -o x.glb
head -c 20 two.pmesh >cut.pmesh
check 'cut off within the header' 4 extract cut.pmesh -o x.glb
check 'info of that' 4 info cut.pmesh
cp two.pmesh bad.pmesh
flip bad.pmesh $((bytes - 30))
check 'a damaged scene' 4 extract bad.pmesh -o x.glb
ok 'the message names the byte' err 'bad.pmesh:byte [0-9]*: '
check '--salvage a scene' 0 extract bad.pmesh -q --salvage --mesh 0 -o x.obj
