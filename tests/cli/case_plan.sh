# SPDX-License-Identifier: MIT
# shellcheck shell=sh disable=SC2154
# plan: the level table answers.

cp "$baked" t.pmesh
check 'plan --faces' 0 plan t.pmesh --faces 1000
ok 'it names level, bytes, faces and error' sh -c \
    "grep -c '^level \|^bytes \|^faces \|^error ' '$work/out' | grep -qx 4"
check 'plan --json' 0 plan t.pmesh --faces 1000 --json
ok 'it is JSON' is_json
bytes=$(json bytes)
planned=$(json faces)
error=$(json error)
ok 'at most that many faces' between "$planned" 200 1000
check 'extract up to the planned bytes' 0 extract t.pmesh --bytes "$bytes" \
    -o level.obj
ok 'gives the planned faces' test "$(faces level.obj)" = "$planned"
check 'plan --error' 0 plan t.pmesh --error "$error" --json
ok 'its own error gives the same level' test "$(json faces)" = "$planned"
check 'plan --bytes' 0 plan t.pmesh --bytes "$bytes" --json
ok 'its own bytes give the same level' test "$(json faces)" = "$planned"
check 'plan --bytes less' 0 plan t.pmesh --bytes $((bytes - 1)) --json
ok 'a byte less gives a coarser one' test "$(json faces)" -lt "$planned"

check 'plan --pixels' 0 plan t.pmesh --pixels 1 --distance 1 --json
near=$(json faces)
check 'plan --pixels from afar' 0 plan t.pmesh --pixels 1 --distance 100 --json
ok 'further away is coarser' test "$(json faces)" -lt "$near"
ok 'the error covers at most a pixel' awk -v p="$(json pixels)" \
    'BEGIN { exit !(p <= 1) }'
check 'two limits' 0 plan t.pmesh --pixels 0 --distance 1 --faces 1000 --json
ok 'the coarser one wins' test "$(json faces)" = "$planned"
head -c 1000 t.pmesh >start.pmesh
check 'the first kilobyte is enough' 0 plan start.pmesh --error 0 --json
ok 'error 0 is the full mesh' test "$(json faces)" = 4608

check 'no limit' 2 plan t.pmesh
check 'pixels without distance' 2 plan t.pmesh --pixels 1
check 'two files' 2 plan t.pmesh t.pmesh --faces 1
check 'plan of another file' 4 plan "$torus" --faces 1
check 'plan of a missing file' 1 plan nope.pmesh --faces 1
