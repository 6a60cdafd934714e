#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/check-symbols.sh BUILD_DIR
#
# Checks what the linker sees: only pmesh_ leaves the shared library; names
# with linkage begin with pmesh_, enc_ or dec_; no writable data, hence no
# global state; the decoder needs nothing but six functions of the C library.
set -u
build=$1
bad=0

# complain_of RULE: every line of the standard input breaks it
complain_of() {
    while read -r line; do
        echo "$line: $1"
        bad=$((bad + 1))
    done
}

if nm "$build/libpmesh.a" | grep -q ' __asan_'; then
    echo "check-symbols: skipped, sanitizers add symbols of their own"
    exit 0
fi
report=$(mktemp) || exit 1
trap 'rm -f "$report"' EXIT

nm -D --defined-only "$build/libpmesh.so" | awk '{ print $NF }' |
    grep -v '^pmesh_' >"$report"
complain_of "exported without pmesh_" <"$report"

nm -Ag --defined-only "$build/libpmesh.a" |
    awk '$NF !~ /^(pmesh|enc|dec)_/ { print $1, $NF }' >"$report"
complain_of "linkage without pmesh_, enc_ or dec_" <"$report"

# Constant tables of pointers are .data.rel.ro: read-only once loaded.
objdump -t "$build/libpmesh.a" | awk -F '\t' '
    NF == 2 {
        n = split($1, left, " ")
        m = split($2, right, " ")
        section = left[n]
        if (right[1] !~ /^0*$/ && section !~ /^[.]data[.]rel[.]ro/ &&
            section ~ /^([.](data|bss|tdata|tbss)|[*]COM[*])/)
            print section, right[m]
    }' >"$report"
complain_of "writable data" <"$report"

# The rest of the pattern is what compilers call by themselves.
nm -A "$build/libpmesh-dec.a" | awk '
    $(NF - 1) == "U" { users[$NF] = users[$NF] " " $1 }
    $(NF - 1) != "U" { defined[$NF] }
    END {
        for (name in users)
            if (!(name in defined))
                print name users[name]
    }' |
    grep -vE '^(malloc|free|mem(cpy|move|set|cmp)|__mem[a-z]*_chk|'\
'_GLOBAL_OFFSET_TABLE_|__stack_chk_fail|__assert_fail|'\
'__(u?div|u?mod|u?divmod|mul|ashl|ashr|lshr|clz|ctz|popcount|fix|float)'\
'[a-z]*[0-9]?) ' >"$report"
complain_of "not among the functions a decoder may need" <"$report"

echo "check-symbols: $bad violations"
[ "$bad" = 0 ]
