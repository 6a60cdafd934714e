# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# glTF files of a few hundred kilobytes that ask for gigabytes or hours: what
# they share costs them as often as it is named.
cat >hostile.py <<'PY'
import json, struct

POINTS = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
CORNERS = struct.pack("<4H", 0, 1, 2, 0)

# A triangle at accessors 0 and 1, then `more` bytes from 44 on.
def write(name, change, more=b"", buffers=None):
    data = POINTS + CORNERS + more
    d = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
         "nodes": [{"mesh": 0}, {"mesh": 0}],
         "meshes": [{"primitives": [{"attributes": {"POSITION": 0},
                                     "indices": 1}]}],
         "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3,
                        "type": "VEC3"},
                       {"bufferView": 1, "componentType": 5123, "count": 3,
                        "type": "SCALAR"}],
         "bufferViews": [{"buffer": 0, "byteLength": 36},
                         {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
         "buffers": [{"byteLength": len(data)}]}
    change(d)
    text = json.dumps(d, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(data), 0x004E4942) + data
    with open(name, "wb") as out:
        out.write(b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks)

def wide(d):
    d.update(("a%d" % i, 0) for i in range(100000))

def wide_enough(d):
    d["extras"] = {"a%d" % i: 0 for i in range(4096)}

def meshes(d):
    d["accessors"].append({"componentType": 5126, "count": 900000,
                           "type": "VEC3"})
    d["meshes"] = [{"primitives": [{"attributes": {"POSITION": 2},
                                    "mode": 5}]}] * 3000

def elements(d):
    for kind, name in (5126, "VEC3"), (5121, "SCALAR"):
        d["accessors"].append({"componentType": kind, "count": 800000,
                               "type": name})
    part = {"attributes": {"POSITION": 2, "_A": 3}, "indices": 1}
    d["meshes"] = [{"primitives": [part] * 4000}]

LONG = b"\x89PNG" + bytes(400000)

def views(d):
    d["bufferViews"] += [{"buffer": 0, "byteOffset": 44,
                          "byteLength": len(LONG)}] * 3000
    d["extensions"] = {"X_views": {"all": list(range(2, 3002))}}

def view_images(d):
    views(d)
    del d["extensions"]
    d["images"] = [{"bufferView": 2 + i} for i in range(3000)]

def side_images(d):
    d["images"] = [{"uri": "./" * (i % 3) + "long.png"} for i in range(3000)]

def side_buffers(d):
    for i in range(1, 3000):
        d["buffers"].append({"byteLength": len(LONG),
                             "uri": ".//" * (i % 3) + "long.png"})
        d["bufferViews"].append({"buffer": i, "byteLength": 36})
        d["accessors"].append({"bufferView": i + 1, "componentType": 5126,
                               "count": 3, "type": "VEC3"})
        d["meshes"].append({"primitives": [{"attributes": {"POSITION": i + 1},
                                            "indices": 1}]})

# Bytes of a file beside, which buffers that geometry needs and one that only
# an extension may need name: together more than they may come to, if the file
# counts once.
def side_twice(d):
    d["buffers"].append({"byteLength": len(LONG), "uri": "long.png"})
    d["bufferViews"] += [{"buffer": 1, "byteLength": 36},
                         {"buffer": 1, "byteLength": len(LONG)}]
    d["accessors"][0]["bufferView"] = 2
    many = (64 << 20) // len(LONG) + 256 + 128
    d["bufferViews"] += [d["bufferViews"][3]] * many
    d["extensions"] = {"X_views": {"all": list(range(4, 4 + many))}}

def factors(d):
    d["materials"] = [{"pbrMetallicRoughness": {
        "roughnessFactor": 1e300, "baseColorFactor": [-1e39, 0, 0, 1]}}]
    d["meshes"][0]["primitives"][0]["material"] = 0

# A strip of 4000 triangles, in 10,000 nodes.
STRIP = b"".join(struct.pack("<3f", i // 2, i % 2, i * i % 7) for i in range(4002))

def nodes(d):
    d["accessors"][0].update(bufferView=2, count=4002)
    d["bufferViews"].append({"buffer": 0, "byteOffset": 44,
                             "byteLength": len(STRIP)})
    d["meshes"] = [{"primitives": [{"attributes": {"POSITION": 0},
                                    "mode": 5}]}]
    d["nodes"] = [{"mesh": 0}] * 10000
    d["scenes"] = [{"nodes": list(range(10000))}]

# A document that packs to next to nothing.
def many(d):
    d["nodes"] += [{}] * 600000

# Numbers of which conversions to whole ones are undefined, or others.
def numbers(d):
    d["skins"] = [{"joints": [1e300, -1, 0.5, 2**53 + 2, 1]}]
    d["nodes"] = [{"mesh": 0, "skin": 0}] + [
        {"mesh": 0, "skin": bad} for bad in (1e300, -1, -1e300, 2**64)]
    d["extensions"] = {"X": {"bad": [1e300, -1, 2**63, 2**64, None]}}

open("long.png", "wb").write(LONG)
write("wide.glb", wide)
write("wide-enough.glb", wide_enough)
write("meshes.glb", meshes)
write("elements.glb", elements)
write("views.glb", views, LONG)
write("view-images.glb", view_images, LONG)
write("side-images.glb", side_images)
write("side-buffers.glb", side_buffers)
write("side-twice.glb", side_twice)
write("factors.glb", factors)
write("nodes.glb", nodes, STRIP)
write("numbers.glb", numbers)
write("many.glb", many)
for n, bad in enumerate((1e300, -1, 0.5, 2**32, 2**53 + 2, 2**64, None)):
    write("mesh-%d.glb" % n, lambda d: d["nodes"][1].update(mesh=bad))
    write("bind-%d.glb" % n, lambda d: d.update(
        skins=[{"joints": [0], "inverseBindMatrices": bad}]))
PY
python3 hostile.py

# refused NAME WORDS: with that message, in less than the minute of check.
refused() {
    check "$1" 3 bake "$1.glb" -o x.pmesh
    ok 'says why' err "$2"
}
refused wide 'more than 4096 members'
check 'as many members' 0 bake wide-enough.glb -q -o x.pmesh
refused meshes 'expand to more than a file of this size may'
refused elements 'share too many elements for a file of this size'
refused views 'the views are longer than a file of this size may have'
refused view-images 'the views are longer than a file of this size may have'
refused side-images 'read too often for a file of this size'
refused side-buffers 'read too often for a file of this size'
refused side-twice 'the views are longer than a file of this size may have'

check 'factors beyond floats' 0 bake factors.glb -q -o x.pmesh
check 'as OBJ' 0 extract x.pmesh -q -o x.obj
ok 'are the largest there are' grep -q '^Pr 3.4028235e+38$' x.mtl
ok 'and the least' grep -q '^Kd -3.4028235e+38 0 0$' x.mtl

check 'a mesh in many nodes' 0 bake nodes.glb -q -o x.pmesh
check 'as glTF' 0 extract x.pmesh -q -o x.glb
check 'but not as many of them' 1 extract x.pmesh -q -o x.obj
ok 'says why' err 'the scene expands to more than'

check 'a document that packs too well' 0 bake many.glb -q -o x.pmesh
ok 'is stored as it is' test "$(wc -c <x.pmesh)" -gt 1800000
check 'and read' 0 extract x.pmesh -q -o x.glb

check 'joints that are none' 0 bake numbers.glb -q -o x.pmesh
for kind in mesh bind; do
    for n in 0 1 2 3 4 5 6; do
        check "a number that is none for a $kind, $n" 3 bake $kind-$n.glb \
            -o x.pmesh
    done
done
