#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/single/run.sh
# The decoder in two files (make single): every compiler here takes it as C99,
# C11 and C++17 without a warning, all say the same of the same files, and
# nothing but the public functions can be linked to.
set -u
suite=single
. tests/harness.sh
unset MAKEFLAGS MFLAGS
single=$dir/single

# build PROGRAM COMPILER FLAG...
build() {
    program=$1
    shift
    "$@" -Wall -Wextra -Wpedantic -Werror -O1 -ffp-contract=off -I"$single" \
        tests/single/upload.c "$single/pmesh_decode.c" -o "$dir/$program"
}

# Each golden mesh, whole and up to 60 faces, as `program` shows it.
tell() {
    for file in $(ls tests/golden/*.pmesh | grep -v /scene); do
        "$dir/$1" "$file" && "$dir/$1" "$file" 60 || return 1
    done
}

same() {
    build program "$@" && tell program >"$dir/is" && cmp "$dir/said" "$dir/is"
}

# What the example draws last is what the tree's own decoder says.
agrees_with_tree() {
    faces=$("$PMESH" info tests/golden/closed.pmesh |
        sed -n 's/^full detail *\([0-9]*\) faces.*/\1/p')
    "$dir/first" tests/golden/closed.pmesh |
        grep -q "draw *$faces faces of .*, error 0\$"
}

only_public() {
    "${CC:-cc}" -O1 -c -I"$single" "$single/pmesh_decode.c" -o "$dir/one.o" &&
        nm -g --defined-only "$dir/one.o" |
        awk '$2 != "R" { print $NF }' >"$dir/linked" # constant tables aside
    grep -ho 'pmesh_[a-z0-9_]*(' "$single/pmesh_decode.h" | tr -d '(' |
        sort -u >"$dir/public"
    ! grep -vxFf "$dir/public" "$dir/linked"
}

damage_is_told() {
    head -c 100 tests/golden/closed.pmesh >"$dir/bad"
    head -c 4096 /dev/zero >>"$dir/bad"
    ! "$dir/first" "$dir/bad"
}

try generate tools/amalgamate.sh "$single" 0.0.0
try compile build first "${CC:-cc}" -std=c11
tell first >"$dir/said"
for compiler in gcc clang; do
    command -v $compiler >/dev/null || continue
    for standard in c99 c11; do
        try $compiler-$standard same $compiler -std=$standard
    done
done
for compiler in g++ clang++; do
    command -v $compiler >/dev/null || continue
    try $compiler-c++17 same $compiler -std=c++17 -x c++
done
try agrees_with_tree
try only_public
try damage_is_told
summary
