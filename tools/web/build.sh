#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tools/web/build.sh FOLDER VERSION
#
# Builds the npm package "pmesh" in FOLDER: the decoder as WebAssembly (clang
# and wasm-ld; no emscripten, no C library), once for single meshes and once
# with scenes, compressed within wasm.js and scene-wasm.js and bare, and the
# modules of src/. Needs no Node.
#
# -Oz, then wasm-opt: 3.9 KB of gzip less than -Os, for a sixth more time; -O3
# would take a quarter less time and 18 KB more. Zopfli saves 2.1 KB of what gzip
# makes. Of the rules that a file can break, the module names the section of
# SPEC.md.
set -eu
folder=$1
version=$2
web=tools/web
for tool in clang wasm-ld wasm-opt zopfli; do
    command -v $tool >/dev/null || {
        echo "$tool is missing: make web-deps installs what the package needs" >&2
        exit 1
    }
done
mkdir -p "$folder"
tools/amalgamate.sh "$folder/c" "$version"
sed -zE 's/"SPEC ([0-9.]+): [^"]*"([[:space:]]*"[^"]*")*/"SPEC \1"/g' \
    "$folder/c/pmesh_decode.c" >"$folder/c/short.c"
sed 's|"decoder/pmesh_scene.h"|"short.c"|' $web/pmesh_wasm.c \
    >"$folder/c/module.c"

# module NAME FLAG...: NAME.wasm. The linker is called by itself: clang would
# run a wasm-opt that it finds, which then fails on names that were stripped.
features="-msimd128 -mbulk-memory -msign-ext -mnontrapping-fptoint"
module() {
    name=$1
    shift
    # shellcheck disable=SC2086 # words on purpose
    clang --target=wasm32 -std=c11 -Oz $features -ffp-contract=off \
        -ffreestanding -DNDEBUG -DPMESH_SMALL "$@" -Wall -Wextra -Werror \
        -I$web/libc -c "$folder/c/module.c" -o "$folder/c/module.o"
    wasm-ld --no-entry --strip-all --gc-sections --stack-first \
        -z stack-size=131072 "$folder/c/module.o" -o "$folder/c/module.wasm"
    wasm-opt -Oz --enable-simd --enable-bulk-memory --enable-sign-ext \
        --enable-nontrapping-float-to-int "$folder/c/module.wasm" \
        -o "$folder/$name.wasm"
}

# text NAME OUT: the module as JavaScript.
text() {
    echo "// $1.wasm, gzip and base64; made by tools/web/build.sh."
    printf 'export const compressed = "'
    zopfli --i30 -c "$folder/$1.wasm" | base64 | tr -d '\n'
    echo '";'
}

module decoder
module scene -DPMESH_WASM_SCENE
text decoder >"$folder/wasm.js"
text scene >"$folder/scene-wasm.js"
cp $web/src/*.js $web/src/*.d.ts $web/README.md LICENSE "$folder/"
sed "s|\"version\": \".*\"|\"version\": \"$version\"|" $web/package.json \
    >"$folder/package.json"
rm -r "$folder/c"
