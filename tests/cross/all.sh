#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: CORRUPT=build/release/corrupt tests/cross/all.sh BUILD_DIR [TARGET...]
#
# Builds the decoder and the encoder with other compilers, optimisations and
# for other machines (qemu-user, WebAssembly in node), and compares:
#
#   decoder   hashes of all golden files with tests/golden/hashes.txt
#   verdicts  what it says of bad files, those of tests/corrupt and of fuzzing,
#             and shows of them, with what the first target says
#   encoder   the golden files made anew, with 1 and with 2 threads, with those
#             that the first target makes
#
# i686 has 32-bit pointers, s390x the other byte order and floats computed as
# doubles, aarch64 fused multiplication and unsigned chars. WebAssembly stops at
# a stack overflow: its 64 KiB are what the decoder may take. Prints one line a
# target, and fails if one differs.
set -u
out=$1
shift
wanted=$*
golden=tests/golden
decoder="format/*.c decoder/*.c $golden/golden_decode.c"
encoder="format/*.c decoder/*.c encoder/*.c tools/trig.c tests/unit/shapes.c
    $golden/golden_mesh.c $golden/golden_bake.c"
flags="-std=c11 -ffp-contract=off -D_POSIX_C_SOURCE=200809L -I. -Wall -Wextra
    -Werror"
passed=0
failed=0

hash_of() {
    cat "$@" | sha256sum | cut -c1-12
}

# verdict IS WANTED: as a word, and counted
verdict() {
    if [ "$1" = "$2" ]; then
        passed=$((passed + 1))
        word=equal
    else
        failed=$((failed + 1))
        word=DIFFERS
    fi
}

# build PROGRAM SOURCES COMPILER...
# shellcheck disable=SC2086 # words and patterns on purpose
build() {
    program=$1
    sources=$2
    shift 2
    "$@" $flags $sources -lm -o "$program"
}

decodes() {
    build "$dir/golden_decode" "$decoder" "$@" &&
        $run "$dir/golden_decode" $golden/*.pmesh >"$dir/hashes.txt"
}

# Half of the files of fuzzing are good ones. A crash shows as a file that comes
# last: `end` does not follow.
judges() {
    $run "$dir/golden_decode" "$out"/bad/*.pmesh tests/fuzz/corpus/dec_*/* \
        >"$dir/verdicts.txt"
    [ $? = 1 ] && echo end >>"$dir/verdicts.txt"
}

bakes() {
    # shellcheck disable=SC2086
    build "$dir/golden_bake" "$encoder" "$@" $encoder_only || return 1
    for threads in 1 2; do
        $run "$dir/golden_bake" "$dir/j$threads" $threads || return 1
    done
}

# target NAME RUNNER COMPILER...
target() {
    name=$1
    run=$2
    shift 2
    case " ${wanted:-$name} " in
    *" $name "*) ;;
    *) return ;;
    esac
    dir=$out/$name
    rm -rf "$dir"
    mkdir -p "$dir/j1" "$dir/j2"
    if decodes "$@" >"$dir/log" 2>&1; then
        is=$(hash_of "$dir/hashes.txt")
    else
        is="no result"
    fi
    verdict "$is" "$expected"
    line=$(printf '%-22s %-12s %-7s' "$name" "$is" "$word")
    if judges 2>>"$dir/log"; then
        is=$(hash_of "$dir/verdicts.txt")
    else
        is="no result"
    fi
    : "${verdicts:=$is}"
    verdict "$is" "$verdicts"
    line=$(printf '%s   %-12s %-7s' "$line" "$is" "$word")
    if bakes "$@" >>"$dir/log" 2>&1; then
        is=$(hash_of "$dir"/j1/*)/$(hash_of "$dir"/j2/*)
    else
        is="no result"
    fi
    [ -n "$files" ] || files="${is%/*}/${is%/*}"
    verdict "$is" "$files"
    printf '%s   %-12s %s\n' "$line" "${is%/*}" "$word"
    [ -s "$dir/log" ] && head -n 20 "$dir/log"
    return 0
}

# The x87 computes with 64 bits of mantissa whatever the type: no build at all
# is better than one that gives other results.
x87_is_refused() {
    mkdir -p "$out"
    if build "$out/x87" "$decoder" i686-linux-gnu-gcc -O2 -mfpmath=387 \
        >"$out/log" 2>&1; then
        word=ACCEPTED
    else
        word=$(sed -n 's/.*error: #error.*excess precision.*/refused/p' \
            "$out/log" | head -n 1)
    fi
    is=${word:-failed for another reason}
    verdict "$is" refused
    printf '%-22s %s\n' "i686 x87" "$is"
}

rm -rf "$out/bad"
mkdir -p "$out/bad"
"$CORRUPT" "$out/bad" >/dev/null || exit 1
expected=$(hash_of $golden/hashes.txt)
verdicts=
files=
encoder_only=
printf '%-22s %-20s   %-20s   %s\n' target "decoder's hashes" verdicts \
    "encoder's files"
target gcc-O2 "" gcc -O2
target gcc-O0 "" gcc -O0
target gcc-O3-native "" gcc -O3 -march=native
target clang-O0 "" clang -O0
target clang-O2 "" clang -O2
target clang-O3-native "" clang -O3 -march=native
target clang-unsigned-char "" clang -O2 -funsigned-char
case $(uname -m) in
x86_64 | i?86) i686= ;;
*) i686=qemu-i386 ;;
esac
target i686-O2 "$i686" i686-linux-gnu-gcc -O2 -msse2 -mfpmath=sse -static
target aarch64-O2 qemu-aarch64 aarch64-linux-gnu-gcc -O2 -static
target aarch64-O3 qemu-aarch64 aarch64-linux-gnu-gcc -O3 -static
target s390x-O0 qemu-s390x s390x-linux-gnu-gcc -O0 -static
target s390x-O3 qemu-s390x s390x-linux-gnu-gcc -O3 -static
encoder_only=-Wl,-z,stack-size=1048576
node="node --no-warnings tests/cross/wasi.mjs"
for level in 0 2 3; do
    target wasm32-O$level "$node" \
        clang --target=wasm32-wasi -O$level -Wl,--stack-first
done
[ -n "$wanted" ] || x87_is_refused
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
