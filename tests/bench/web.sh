#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/bench/web.sh
#
# Size of the decoder for the web, and its time for complete files in headless
# Chromium: beside Draco's WebAssembly in the same page, and beside native code
# of both (bench_decode, right before). Positions only, of 14 bits.
# MODELS: "bunny koala armadillo"; RUNS: of each decoder in the page (9).
MODELS=${MODELS-bunny koala armadillo}
. "$(dirname "$0")/common.sh"
need draco_encoder "make bench-deps"
need chromium "make web-deps"
need "$tools/bench_decode" "make bench-web"
dir=$OUT/web
web=build/web
mkdir -p "$dir" $web/browser
tools/web/build.sh $web/pmesh 0.0.0
lock=tests/web/browser/package-lock.json
if ! cmp -s $lock $web/browser/installed; then
    cp tests/web/browser/package.json $lock $web/browser/
    (cd $web/browser && npm ci --ignore-scripts --no-audit --no-fund --silent)
    cp $lock $web/browser/installed
fi
cp tests/web/server.mjs tests/web/browser/bench.mjs $web/browser/
zipped() {
    cat "$@" | gzip -9 | wc -c
}
{
    echo "gzip: decoder.wasm $(zipped $web/pmesh/decoder.wasm), in a module" \
        "$(zipped $web/pmesh/wasm.js), scripts" \
        "$(zipped $web/pmesh/index.js $web/pmesh/decoder.js \
            $web/pmesh/source.js)"
    models | while read -r model; do
        name=$(basename "$model" .obj)
        progress "$name"
        positions_only "$model" >"$dir/$name.obj"
        draco "$dir/$name.obj" "$dir/$name.drc" 14
        bake "$dir/$name.obj" "$dir/$name.pmesh" balanced 14
        native=$("$tools/bench_decode" 9 "$dir/$name.pmesh" "$dir/$name.drc" |
            awk -F , '{ printf "pmesh %.1f ms, draco %.1f ms", $3, $4 }')
        page=$(PMESH_FILE=$dir/$name.pmesh DRACO_FILE=$dir/$name.drc \
            DRACO=$web/browser/node_modules/draco3d PACKAGE=$web/pmesh \
            CHROMIUM=$(command -v chromium) node $web/browser/bench.mjs)
        echo "$name: native $native; page: $page"
    done
} | tee "$OUT/web.txt"
