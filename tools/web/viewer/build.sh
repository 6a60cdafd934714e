#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tools/web/viewer/build.sh PACKAGE OUT.html
#
# Bundles the page of `pmesh view` from the npm package in PACKAGE, three.js and
# the modules here. Needs Node, and npm for a first time: what package-lock.json
# names is kept beside OUT.
set -eu
package=$1
out=$2
viewer=tools/web/viewer
for tool in node npm; do
    command -v $tool >/dev/null || {
        echo "$tool is missing: the viewer's page is bundled by esbuild" >&2
        exit 1
    }
done
kept=$(dirname "$out")/viewer
mkdir -p "$kept"
if ! cmp -s $viewer/package-lock.json "$kept/installed"; then
    cp $viewer/package.json $viewer/package-lock.json "$kept/"
    (cd "$kept" && npm ci --ignore-scripts --no-audit --no-fund --silent)
    cp $viewer/package-lock.json "$kept/installed"
fi
root=$PWD
(cd "$kept" && node "$root/$viewer/bundle.mjs" "$root/$viewer" \
    "$root/$package" page.html)
mv "$kept/page.html" "$out"
