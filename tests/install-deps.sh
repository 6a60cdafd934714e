#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/install-deps.sh [--check] GROUP...
# of the groups build, test, bench, cross, fuzz, afl and web.
#
# Installs the Debian packages of what is missing, by apt-get as root or
# through sudo. If nothing is missing it does nothing, offline too. --check
# only says what is missing.
set -u
missing=

# need PACKAGE COMMAND...: the package is missing if the command fails
need() {
    package=$1
    shift
    "$@" >/dev/null 2>&1 || missing="$missing $package"
}

program() {
    command -v "$1"
}

header() {
    echo "#include <$1>" |
        ${CXX:-c++} -std=c++17 ${CXXFLAGS:-} -E -x c++ -
}

group_build() {
    need gcc program "${CC:-cc}"
    need g++ program "${CXX:-c++}"
    need binutils program "${AR:-ar}"
    need libdraco-dev header draco/draco_features.h
    need libmeshoptimizer-dev header meshoptimizer.h
    need libstb-dev header stb/stb_image_write.h
    need libtinygltf-dev header tiny_gltf.h
    need nlohmann-json3-dev header nlohmann/json.hpp
    need zlib1g-dev header zlib.h
}

group_test() {
    need draco program draco_decoder
    need python3 program python3
    need pkg-config program pkg-config
}

group_bench() {
    need draco program draco_encoder
    need libcgal-dev header CGAL/version.h
    need libeigen3-dev header eigen3/Eigen/Core
    need libopenmesh-dev header OpenMesh/Core/System/config.h
    need libtinyobjloader-dev header tiny_obj_loader.h
    need python3 program python3
    need time test -x /usr/bin/time
}

# A static program of that machine's C library.
links() {
    echo 'int main(void) { return 0; }' | "$@" -x c - -o /dev/null
}

group_cross() {
    need gcc program gcc
    need clang program clang
    need gcc-i686-linux-gnu program i686-linux-gnu-gcc
    need libc6-dev-i386-cross links i686-linux-gnu-gcc -static
    need gcc-aarch64-linux-gnu program aarch64-linux-gnu-gcc
    need libc6-dev-arm64-cross links aarch64-linux-gnu-gcc -static
    need gcc-s390x-linux-gnu program s390x-linux-gnu-gcc
    need libc6-dev-s390x-cross links s390x-linux-gnu-gcc -static
    need qemu-user program qemu-s390x
    need lld program wasm-ld
    need wasi-libc test -e /usr/lib/wasm32-wasi/libc.a
    need libclang-rt-dev-wasm32 links clang --target=wasm32-wasi
    need nodejs program node
}

group_fuzz() {
    need clang program clang
    need libclang-rt-dev links clang -fsanitize=address
    need llvm program llvm-cov
    need python3 program python3
}

group_afl() {
    need afl++ program afl-clang-fast
}

group_web() {
    need clang program clang
    need lld program wasm-ld
    need binaryen program wasm-opt
    need zopfli program zopfli
    need nodejs program node
    need npm program npm
    need chromium program chromium
}

only_check=false
if [ "${1-}" = --check ]; then
    only_check=true
    shift
fi
for group; do
    "group_$group"
done

[ -n "$missing" ] || exit 0
if $only_check; then
    echo "missing:$missing (install with: make deps)" >&2
    exit 1
fi
if ! command -v apt-get >/dev/null; then
    echo "missing:$missing (these are Debian's names; install by hand)" >&2
    exit 1
fi
sudo=
if [ "$(id -u)" != 0 ]; then
    if ! sudo -n true 2>/dev/null; then
        echo "missing:$missing (as root: apt-get install$missing)" >&2
        exit 1
    fi
    sudo="sudo -n"
fi

echo "installing$missing"
apt="$sudo env DEBIAN_FRONTEND=noninteractive apt-get -q"
apt="$apt -o DPkg::Lock::Timeout=600"
$apt update || echo "package lists not updated; trying with the old ones" >&2
# shellcheck disable=SC2086 # words on purpose
exec $apt install -y --no-install-recommends $missing
