#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/reference/run.sh
#        FILES=10000 MENDED=2000 DAMAGED=500: how many of each, see agree.c
#
# The decoder of this directory, written from SPEC.md alone, agrees with the
# library: on what the golden files and random ones show at several numbers of
# faces, on prefixes of them, on files that no encoder makes, and on which
# damaged files are none. Prints how many, and which elements of the format were
# not met.
set -u
build=$(dirname "$PMESH")
suite=reference
. tests/harness.sh
# Single meshes: scenes are not read by it.
golden=$(ls tests/golden/*.pmesh | grep -v /scene)

# Neither code nor headers, but for those of C and its own.
reference_shares_nothing() {
    grep -H '#include "' tests/reference/ref*.[ch] |
        grep -v '"tests/reference/ref[a-z_]*[.]h"$' && return 1
    nm -u "$build"/tests/reference/ref*.o | grep pmesh_ && return 1
    return 0
}

reference_reads_golden_files() {
    for file in $golden; do
        "$build/reference" "$file" >"$dir/dump" || { echo "$file"; return 1; }
        grep -q '^face' "$dir/dump" || return 1
    done
}

reference_rejects_what_is_cut_off() {
    head -c 300 tests/golden/closed.pmesh >"$dir/cut"
    ! "$build/reference" "$dir/cut" >"$dir/dump" &&
        grep -q '^incomplete' "$dir/dump"
}

decoders_agree() {
    "$build/reference_agree" "${FILES:-300}" "${MENDED:-300}" \
        "${DAMAGED:-50}" $golden >"$dir/agree"
    status=$?
    cat "$dir/agree"
    return $status
}

try reference_shares_nothing
try reference_reads_golden_files
try reference_rejects_what_is_cut_off
try decoders_agree
cat "$dir/agree"
summary
