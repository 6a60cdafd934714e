# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# batch: many files, one process each; one that fails stops no other.

mkdir -p in/sub in/.hidden
torus 12 in/a.obj
torus 14 in/sub/a.obj
torus 16 "in/with blank.obj"
cp in/a.obj in/.hidden/no.obj
cp in/a.obj in/notes.txt
same() {
    "$PMESH" bake "$1" -q -o same.pmesh && cmp -s same.pmesh "$2"
}
check 'batch of a folder' 0 batch in -o out --json
ok 'it is JSON' is_json
ok 'three files are baked' test "$(json done)" = 3
ok 'and no other' test "$(find out -type f | sort | tr '\n' ' ')" = \
    'out/a.pmesh out/sub/a.pmesh out/with blank.pmesh '
ok 'the same bytes as by bake' same in/sub/a.obj out/sub/a.pmesh
ok 'their sizes are summed up' test "$(json bytes)" = \
    "$(cat out/*.pmesh out/sub/a.pmesh | wc -c | tr -d ' ')"

check 'batch --resume' 0 batch in -o out --resume --json
ok 'nothing is left to do' test "$(json skipped)" = 3
sleep 0.01
touch in/a.obj
check 'resume after a change' 0 batch in -o out --resume --json
ok 'the changed file is baked again' test "$(json done)$(json skipped)" = 12

"$PMESH" extract out/a.pmesh -q -o in/a.ply
check 'two files of one stem' 0 batch in -o two -q
ok 'both keep their ending' test -s two/a.obj.pmesh -a -s two/a.ply.pmesh
ok 'other names stay' test -s two/sub/a.pmesh
rm in/a.ply
check 'bake options' 0 batch in/a.obj -o q -q -- --profile quality
ok 'reach bake' test "$("$PMESH" info q/in/a.pmesh | grep -c quality)" = 1

printf 'in/a.obj\r\n\n../d/in/sub/a.obj\n%s\n' "$PWD/in/with blank.obj" >list
check 'a list of paths' 0 batch list -o l -q
ok 'outputs stay below the folder' test -s l/in/a.pmesh -a \
    -s l/d/in/sub/a.pmesh -a -s "l$PWD/in/with blank.pmesh"
timeout 60 "$PMESH" batch - -o piped -q -j 3 <list
ok 'a list by a pipe, three at a time' cmp -s l/in/a.pmesh piped/in/a.pmesh

echo 'f 1 2 3' >in/bad.obj
check 'one bad file' 3 batch in -o bad --report r.jsonl
ok 'it is named' err '^pmesh: in/bad.obj'
ok 'the others are baked' out '^3 of 4 files baked, 0 skipped, 1 failed$'
ok 'a line of the report each' test "$(grep -c '^{.*}$' r.jsonl)" = 4
ok 'the report says which failed' grep -q \
    '"input": "in/bad.obj".*"status": "failed","exit": 3' r.jsonl
ok "and holds bake's own" grep -q '"bake": {"schema": "pmesh-bake-1"' r.jsonl
sed 1q r.jsonl >"$work/out"
ok 'a line is JSON' is_json
check 'it fails again' 3 batch in -o bad --resume --report r.jsonl -q
ok 'the report goes on' test "$(wc -l <r.jsonl)" = 8
rm in/bad.obj

check 'options that bake does not know' 2 batch in -o never -j 1 -- --nonsense
check 'no folder' 2 batch in
check 'nothing to bake' 2 batch -o out
check 'a missing folder' 1 batch nowhere -o out
check 'a mesh twice' 2 batch in/a.obj in/a.obj -o out
check 'a file in the way of the folder' 1 batch in/a.obj -o in/notes.txt
mkdir none
check 'an empty folder' 0 batch none -o out --json
ok 'is nothing to do' test "$(json files)" = 0

# Killed at any moment: outputs are whole or missing, --resume does the rest.
mkdir many
for i in 1 2 3 4 5 6 7 8 9 10 11 12; do
    torus $((20 + i)) many/$i.obj
done
timeout -s KILL 0.2 "$PMESH" batch many -o killed -q -j 2 2>/dev/null
sleep 0.5 # children end what they have begun
for file in killed/*.pmesh; do
    [ ! -e "$file" ] || "$PMESH" verify -q "$file" ||
        ok "$file is whole" false
done
check 'resume after SIGKILL' 0 batch many -o killed --resume --json
ok 'does the rest' test $(($(json done) + $(json skipped))) = 12
check 'an undisturbed run' 0 batch many -o calm -q -j 1
ok 'gives the same files' diff -r -x '.pmesh-*' killed calm
