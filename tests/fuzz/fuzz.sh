#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/fuzz/fuzz.sh TARGET_PROGRAM SECONDS
#        MESHES=folder: more seeds for importers; MAX_LEN=bytes (6000)
#
# Runs a target from its seeds, the committed corpus and what earlier runs left
# in build/corpus/NAME. Findings are put into build/found/NAME; the last line is
# one for LEDGER.md.
set -u
program=$1
seconds=$2
name=$(basename "$program")
corpus=build/corpus/$name
found=build/found/$name
seeds=build/seeds
mkdir -p "$corpus" "$found"
[ -e $seeds/done ] || {
    tests/fuzz/seeds.sh $seeds "${MESHES-}" && touch $seeds/done
} || exit 1
set -- "$corpus"
for folder in "$seeds/$name" "tests/fuzz/corpus/$name"; do
    [ ! -d "$folder" ] || set -- "$@" "$folder"
done
case $name in tool_*) dictionary=tests/fuzz/imp.dict ;; *) dictionary=tests/fuzz/$name.dict ;; esac
[ -e "$dictionary" ] || dictionary=tests/fuzz/${name%_*}.dict
[ ! -e "$dictionary" ] || set -- -dict="$dictionary" "$@"

ASAN_OPTIONS=allocator_may_return_null=1:quarantine_size_mb=16 \
    "$program" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=1500 \
    -max_len="${MAX_LEN-6000}" -artifact_prefix="$found/" \
    -print_final_stats=1 "$@" 2>&1 | tee "$found/log"
runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$found/log")
bad=$(find "$found" -type f ! -name log | wc -l)
echo "| $(date +%F) | $(git rev-parse --short HEAD) | $name |" \
    "${runs:-?} | $seconds | $bad |"
[ "$bad" = 0 ]
