#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/fuzz/afl.sh TARGET_PROGRAM SECONDS
#
# Runs a target under AFL++, which mutates in other ways than libFuzzer: a
# process for each input, read from a file by the driver. Findings are in
# build/afl/out/NAME/default/crashes and hangs; the last line is one for
# LEDGER.md, by the wall clock.
set -u
program=$1
seconds=$2
name=$(basename "$program")
seeds=build/seeds
out=build/afl/out/$name
[ -e $seeds/done ] || { tests/fuzz/seeds.sh $seeds && touch $seeds/done; } ||
    exit 1
rm -rf "$out"
mkdir -p build/afl/out
AFL_NO_UI=1 AFL_SKIP_CPUFREQ=1 AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES=1 \
    AFL_NO_AFFINITY=1 afl-fuzz -i "$seeds/$name" -o "$out" -V "$seconds" \
    -- "$program" -q @@ || exit 1
count() {
    find "$out/default/$1" -type f -name 'id:*' | wc -l
}
runs=$(sed -n 's/^execs_done *: *//p' "$out/default/fuzzer_stats")
bad=$(($(count crashes) + $(count hangs)))
echo "| $(date +%F) | $(git rev-parse --short HEAD) | $name (afl) |" \
    "${runs:-?} | $seconds | $bad |"
[ "$bad" = 0 ]
