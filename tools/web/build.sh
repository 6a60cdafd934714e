#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tools/web/build.sh FOLDER VERSION
#
# Builds the npm package "pmesh" in FOLDER: the decoder as WebAssembly without
# imports (clang and wasm-ld; no emscripten, no C library), compressed within
# wasm.js and bare, and the modules of src/. Needs no Node.
#
# -Os with vectors: 1.4 times the time of native code; -O3 would save a tenth of
# it for a third more bytes.
set -eu
folder=$1
version=$2
web=tools/web
for tool in clang wasm-ld; do
    command -v $tool >/dev/null || {
        echo "$tool is missing: make web-deps installs what the package needs" >&2
        exit 1
    }
done
mkdir -p "$folder"
tools/amalgamate.sh "$folder/c" "$version"

# The linker is called by itself: clang would run a wasm-opt that it finds.
sed 's|"decoder/pmesh_decode.h"|"pmesh_decode.c"|' $web/pmesh_wasm.c \
    >"$folder/c/module.c"
clang --target=wasm32 -std=c11 -Os -msimd128 -mbulk-memory -msign-ext \
    -mnontrapping-fptoint -ffp-contract=off -ffreestanding -DNDEBUG \
    -Wall -Wextra -Werror -I$web/libc -c "$folder/c/module.c" \
    -o "$folder/c/module.o"
wasm-ld --no-entry --strip-all --gc-sections --stack-first \
    -z stack-size=131072 "$folder/c/module.o" -o "$folder/decoder.wasm"

{
    echo "// The decoder, gzip and base64; made by tools/web/build.sh."
    printf 'export const compressed = "'
    gzip -9 -n -c "$folder/decoder.wasm" | base64 | tr -d '\n'
    echo '";'
} >"$folder/wasm.js"
cp $web/src/*.js $web/src/*.d.ts $web/README.md LICENSE "$folder/"
sed "s|\"version\": \".*\"|\"version\": \"$version\"|" $web/package.json \
    >"$folder/package.json"
rm -r "$folder/c"
