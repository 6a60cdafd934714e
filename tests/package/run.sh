#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/package/run.sh
# What a user of the libraries meets: install, pkg-config, the static and the
# shared library from C and C++, uninstall, and a build without the Makefile.
set -u
config=$(basename "$(dirname "$PMESH")")
if [ "$config" = sanitize ]; then
    echo "package: skipped, a sanitized library is not for installing"
    exit 0
fi
suite=package
. tests/harness.sh
unset MAKEFLAGS MFLAGS

tree() {
    make config="$config" DESTDIR="$dir/root" PREFIX=/opt/pmesh "$@"
}

flags() {
    PKG_CONFIG_SYSROOT_DIR=$dir/root \
        PKG_CONFIG_PATH=$dir/root/opt/pmesh/lib/pkgconfig pkg-config "$@" pmesh
}

# shellcheck disable=SC2046 # words on purpose
shared() {
    "$@" "$dir/user.c" $(flags --cflags --libs) -o "$dir/user" &&
        LD_LIBRARY_PATH=$dir/root/opt/pmesh/lib "$dir/user"
}

# shellcheck disable=SC2046
static() {
    "${CC:-cc}" "$dir/user.c" $(flags --cflags) \
        "$dir/root/opt/pmesh/lib/libpmesh-dec.a" -o "$dir/user" && "$dir/user"
}

without_makefile() {
    root=$PWD
    (cd "$dir" && "${CC:-cc}" -std=c11 -O2 -I"$root" -c \
        "$root"/format/*.c "$root"/decoder/*.c)
}

# completes WORD...: what bash offers for the last one
completes() {
    root=$dir/root/opt/pmesh bash -c '
        source "$root/share/bash-completion/completions/pmesh"
        COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
        _pmesh "$root/bin/pmesh"
        printf "%s\n" "${COMPREPLY[@]}"' bash "$@"
}

completion() {
    test "$(completes pmesh extr)" = extract &&
        test "$(completes pmesh help ver)" = verify &&
        test "$(completes pmesh bake --profile c)" = compact &&
        test "$(completes pmesh bake --lossl)" = --lossless &&
        test "$(completes pmesh info --lev)" = --levels &&
        test "$(completes pmesh bake READ)" = README.md
}

python_module() {
    PYTHONPATH=$dir/root/opt/pmesh/share/pmesh PYTHONDONTWRITEBYTECODE=1 \
        LD_LIBRARY_PATH=$dir/root/opt/pmesh/lib python3 -c '
import pmesh
data = open("tests/golden/closed.pmesh", "rb").read()
assert pmesh.Decoder(data).face_count > 0'
}

man_page() {
    test -s "$dir/root/opt/pmesh/share/man/man1/pmesh.1"
}

nothing_left() {
    test -z "$(find "$dir/root" ! -type d)"
}

cat >"$dir/user.c" <<'C'
#include <pmesh_decode.h>
#include <pmesh_encode.h>
#include <pmesh_simplify.h>
int main(void)
{
    pmesh_decoder *dec;
    if (pmesh_decoder_create(&dec, 0) != PMESH_OK)
        return 1;
    pmesh_decoder_destroy(dec);
    return 0;
}
C
try install tree install
try program "$dir/root/opt/pmesh/bin/pmesh" --version
try shared_from_c shared "${CC:-cc}"
try shared_from_cxx shared "${CXX:-c++}" -x c++
try static_decoder static
try soname test -e "$dir/root/opt/pmesh/lib/libpmesh.so.0"
try man_page
if command -v bash >/dev/null; then
    try completion
fi
if command -v python3 >/dev/null; then
    try python_module
fi
if [ -e build/web/viewer.html ]; then
    try view "$dir/root/opt/pmesh/bin/pmesh" view tests/golden/closed.pmesh \
        -o "$dir/page.html"
fi
try without_makefile without_makefile
try uninstall tree uninstall
try nothing_left nothing_left
summary
