#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/web/run.sh
#
# The npm package in node, with a server on loopback: the same bits as native
# code, loading, workers. three.js and a real browser are tests/browser.
set -u
for tool in clang wasm-ld node; do
    command -v $tool >/dev/null || {
        echo "web: skipped, there is no $tool (make check-web installs it)"
        echo "0 passed, 0 failed"
        exit 0
    }
done
status=0
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
package=build/web/pmesh
tools/web/build.sh $package 0.0.0 || exit 1
# Beside the package, where "pmesh" is found.
tests=build/web/tests
mkdir -p build/web/node_modules $tests
ln -sfn ../pmesh build/web/node_modules/pmesh
cp tests/web/*.mjs $tests

"$PMESH" sample -o "$dir/a.ply" --faces 30k &&
    "$PMESH" bake -q "$dir/a.ply" -o "$dir/a.pmesh" &&
    "$PMESH" bake -q "$dir/a.ply" -o "$dir/b.pmesh" --no-attributes || exit 1

PMESH_GOLDEN=$PWD/tests/golden/ PMESH_SAMPLE=$dir/a.pmesh PMESH_OTHER=$dir/b.pmesh \
    timeout 120 node --no-warnings --test --test-timeout=60000 --test-reporter=tap $tests/*.test.mjs \
    >"$dir/tap" 2>&1 || status=$?
count() {
    sed -n "s/^# $1 \([0-9]*\)\$/\1/p" "$dir/tap" | tail -n 1
}
passed=$(count pass)
failed=$(count fail)
[ "${failed:-1}" = 0 ] || sed -n '/^ *not ok/,/^ *\.\.\./p' "$dir/tap" |
    head -n 100
echo "${passed:-0} passed, ${failed:-1} failed"
[ "${failed:-1}" = 0 ] && [ "$status" = 0 ]
