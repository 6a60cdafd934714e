# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# info and verify.

cp "$baked" t.pmesh
bytes=$(size t.pmesh)
check 'info' 0 info t.pmesh
ok 'info counts faces' out '4608 faces'
check 'info --levels' 0 info t.pmesh --levels
ok 'info --levels has the table' out '^level '
check 'info --json' 0 info t.pmesh --json
ok 'it is JSON' is_json
ok 'faces' test "$(json faces)" = 4608
ok 'vertices' test "$(json vertices)" = 2304
ok 'bytes' test "$(json bytes)" = "$bytes"
ok 'complete' test "$(json complete)" = true
ok 'position_bits' test "$(json position_bits)" = 14
for key in schema tool version format_version meshes base_faces base_vertices \
    profile placement attributes materials content_hash levels; do
    ok "--json has $key" out "^  \"$key\": "
done
hash=$(json content_hash)
levels=$(grep -c '{"bytes": ' "$work/out")

head -c $((bytes / 2)) t.pmesh >cut.pmesh
check 'info of a cut file' 0 info cut.pmesh
ok 'info says that it is cut' out "cut off after $((bytes / 2))"
check 'info --json of a cut file' 0 info cut.pmesh --json
ok 'not complete' test "$(json complete)" = false
ok 'the same hash' test "$(json content_hash)" = "$hash"
ok 'all levels' test "$(grep -c '{"bytes": ' "$work/out")" = "$levels"
"$PMESH" info - --json <cut.pmesh >"$work/out" 2>"$work/err"
judge 'info of standard input' 0 $? 'info -'
head -c 10 t.pmesh >short.pmesh
check 'info of ten bytes' 4 info short.pmesh
: >empty.pmesh
check 'info of nothing' 4 info empty.pmesh
check 'info of another file' 4 info "$torus"
ok 'info of another file: the reason' err 'not a .pmesh file'
check 'info of a missing file' 1 info nope.pmesh

cp t.pmesh u.pmesh
check 'verify two good files' 0 verify t.pmesh u.pmesh
ok 'verify prints a line for each' test "$(wc -l <"$work/out")" -eq 2
check 'verify -q' 0 verify -q t.pmesh
ok 'verify -q is quiet' test ! -s "$work/out"
cp t.pmesh more.pmesh && printf abc >>more.pmesh
check 'verify a file with more behind it' 0 verify more.pmesh
ok 'says so' grep -q 'and 3 bytes behind its end' "$work/out"
check 'verify a cut file' 4 verify cut.pmesh
ok 'it names bytes and level' err 'cut off after .*last good level'
check 'verify nothing' 4 verify empty.pmesh
check 'verify a missing file' 1 verify nope.pmesh
check 'verify a good and a bad file' 4 verify t.pmesh cut.pmesh
"$PMESH" verify cut.pmesh nope.pmesh t.pmesh >"$work/out" 2>"$work/err"
ok 'a file that cannot be read outranks a bad one' test $? = 1
ok 'every file is judged' out '^t.pmesh: good'
check 'verify --json' 4 verify cut.pmesh --json
ok 'verify --json is JSON' is_json
ok 'verify --json: not good' test "$(json good)" = false

for percent in 0 1 2 5 10 25 50 75 90 99; do
    cp t.pmesh bad.pmesh
    flip bad.pmesh $((bytes * percent / 100))
    check "verify finds a flipped bit at $percent %" 4 verify bad.pmesh
done
flip_last=$((bytes - 1))
cp t.pmesh bad.pmesh
flip bad.pmesh $flip_last
check 'verify finds a flipped bit at the end' 4 verify bad.pmesh

# More than anybody reads.
awk 'BEGIN { for (i = 0; i < 300; i++) {
                 print "v", i, 0, 0; print "v", i, 1, 0; print "v", i, 0, 1
                 print "usemtl m" i; print "f -1 -2 -3" } }' >many.obj
check 'bake many materials' 0 bake many.obj -q -o many.pmesh
check 'info of them' 0 info many.pmesh
ok 'it names some' out '^materials    300: m0, m1, .*, m31 and 268 more$'
check 'info --json of them' 0 info many.pmesh --json
ok 'names all' out '"m299"'
awk 'BEGIN { print "{\"asset\": {\"version\": \"2.0\"}, \"nodes\": ["
             for (i = 0; i < 40; i++) print (i ? "," : "") "{\"mesh\": " i "}"
             print "], \"meshes\": ["
             for (i = 0; i < 40; i++) print (i ? "," : "") "{\"primitives\": " \
                 "[{\"attributes\": {\"POSITION\": 0}}]}"
             print "], \"accessors\": [{\"bufferView\": 0, \"count\": 3, " \
                 "\"componentType\": 5126, \"type\": \"VEC3\"}], " \
                 "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 36}], " \
                 "\"buffers\": [{\"byteLength\": 36, \"uri\": \"data:;base64," \
                 "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}" }' \
    >many.gltf
check 'bake many meshes' 0 bake many.gltf -q -o many.pmesh
check 'info of them' 0 info many.pmesh
ok 'it shows some' out '^ *and 8 more$'
ok 'the first 32' test "$(grep -c ' faces, 0 attributes' "$work/out")" = 32
check 'info --json of them' 0 info many.pmesh --json
ok 'has all' test "$(grep -c '"base_bytes"\|"base_faces"' "$work/out")" = 41
