# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# Files are whole or absent, whatever the world does.

bake() { check "$1" "$2" bake "$torus" -q -o "$3"; }

check 'missing input' 1 bake nope.obj -o a.pmesh
ok 'missing input: the message names file and reason' err 'nope.obj: No such'
mkdir folder
check 'input is a folder' 1 bake folder -o a.pmesh
bake 'output folder is missing' 1 no/such/a.pmesh
bake 'output is a folder' 1 folder
bake 'output name is empty' 1 ''
check 'odd name in a message' 1 info "$(printf 'a\033[31m\nb\200')"
ok 'refusals leave nothing' only folder

cp "$torus" in
ln in hard
ln -s in soft
for target in in ./in hard soft; do
    check "the output is the input ($target)" 1 \
        bake in --format obj -o $target
done
ok 'the input is as it was' cmp -s "$torus" in
cp "$baked" same.pmesh
check 'extract onto its input' 1 extract same.pmesh -o same.pmesh --format obj
ok 'the file is as it was' cmp -s "$baked" same.pmesh
rm -f in hard soft same.pmesh

printf precious >a.pmesh
printf 'v 0 0\n' >bad.obj
check 'bad input' 3 bake bad.obj -o a.pmesh
ok 'bad input keeps the old output' test "$(cat a.pmesh)" = precious
bake 'the old output is replaced' 0 a.pmesh
ok 'the output is whole' cmp -s a.pmesh "$baked"
ok 'no temporary file is left' only a.pmesh bad.obj folder

ln -s a.pmesh link
printf old >a.pmesh
bake 'output through a symbolic link' 0 link
ok 'the link is still one' test -L link
ok 'the file behind the link is written' cmp -s a.pmesh "$baked"
(umask 027 && "$PMESH" bake "$torus" -q -o mode.pmesh)
# shellcheck disable=SC2012 # the mode is what is asked
ok 'the umask decides the mode' \
    test "$(ls -l mode.pmesh | cut -c 1-10)" = -rw-r-----
rm -f link mode.pmesh a.pmesh

if [ -c /dev/full ]; then
    bake 'full device' 1 /dev/full
    ok 'full device: the reason is told' err 'No space left'
    "$PMESH" info "$baked" >/dev/full 2>"$work/err"
    judge 'full standard output' 1 $? info
    "$PMESH" bake "$torus" -q -o - >/dev/full 2>"$work/err"
    judge 'file to a full standard output' 1 $? 'bake -o -'
fi
bake 'device as output' 0 /dev/null
ok 'a device stays a device' test -c /dev/null
(ulimit -f 1 && exec "$PMESH" bake "$torus" -q -o a.pmesh) 2>"$work/err"
judge 'file size limit' 1 $? 'ulimit -f 1; bake'
ok 'file size limit: nothing is left' only bad.obj folder

"$PMESH" bake - -q --format obj -o - <"$torus" >a.pmesh
ok 'from standard input to standard output' cmp -s a.pmesh "$baked"
# shellcheck disable=SC2002 # a pipe is what is tested
cat "$torus" | "$PMESH" bake - -q -o - | cat >b.pmesh
ok 'from pipe to pipe, format by content' cmp -s b.pmesh "$baked"
mkfifo fifo
# shellcheck disable=SC2016 # the inner shell expands
timeout 20 sh -c 'while read -r line; do echo "$line"; done <"$1" >fifo' \
    sh "$torus" &
check 'named pipe with short writes' 0 bake fifo -q --format obj -o c.pmesh
wait
ok 'named pipe: the same file' cmp -s c.pmesh "$baked"
"$PMESH" info "$baked" --json 2>"$work/err" | :
ok 'a closed pipe is no crash' true

"$PMESH" bake "$torus" -o d.pmesh 0<&- 1>&- 2>&-
ok 'closed standard descriptors: exit code 0' test $? = 0
ok 'closed standard descriptors: the file is right' cmp -s d.pmesh "$baked"
"$PMESH" bake "$torus" -q -o - 1>&- 2>"$work/err"
judge 'output to a closed standard output' 1 $? 'bake -o - >&-'
rm -f ./*.pmesh fifo

old_or_good() { [ "$(head -c 9 "$1")" = old ] || "$PMESH" verify -q "$1"; }
torus 160 big.obj
for signal in INT TERM HUP; do
    for wait in 0.05 0.2 0.4; do
        printf old >big.pmesh
        timeout -s $signal $wait "$PMESH" bake big.obj -q -o big.pmesh
        ok "SIG$signal after $wait s leaves no temporary file" \
            only bad.obj big.obj big.pmesh folder
        ok "SIG$signal after $wait s leaves a whole file" old_or_good big.pmesh
    done
done
