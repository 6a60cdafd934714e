#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/web/run.sh
#
# The npm package in node, with a server on loopback: the same bits as native
# code, loading, workers. With NPM=1, as `make check-web` sets it, also the
# viewer's page in headless Chromium, for which npm brings playwright-core and
# three.js. What is skipped is said.
set -u
status=0
passed=0
failed=0
web=build/web
mkdir -p $web
dir=$(mktemp -d $web/test-XXXXXX) && dir=$PWD/$dir || exit 1
trap 'rm -rf "$dir"' EXIT

skip() {
    echo "web: $1"
}

finish() {
    echo "$passed passed, $failed failed"
    [ "$failed" = 0 ] && [ "$status" = 0 ]
    exit
}

# run_tests FILE...: in node; adds up what passed
run_tests() {
    timeout 300 node --no-warnings --test --test-timeout=120000 \
        --test-reporter=tap "$@" >"$dir/tap" 2>&1 || status=$?
    for word in pass fail; do
        count=$(sed -n "s/^# $word \([0-9]*\)\$/\1/p" "$dir/tap" | tail -n 1)
        case $word in
        pass) passed=$((passed + ${count:-0})) ;;
        fail) failed=$((failed + ${count:-1})) ;;
        esac
    done
    sed -n 's|.*# first picture|web: first picture|p' "$dir/tap"
    [ $status = 0 ] || sed -n '/^ *not ok/,/^ *\.\.\./p' "$dir/tap" |
        head -n 100
}

for tool in clang wasm-ld node; do
    command -v $tool >/dev/null || {
        skip "skipped, there is no $tool (make check-web installs it)"
        finish
    }
done
tools/web/build.sh $web/pmesh 0.0.0 || exit 1
"$PMESH" sample -o "$dir/a.ply" --faces 70k &&
    "$PMESH" bake -q "$dir/a.ply" -o "$dir/a.pmesh" &&
    "$PMESH" bake -q "$dir/a.ply" -o "$dir/b.pmesh" --no-attributes &&
    "$PMESH" bake -q "$dir/a.ply" -o "$dir/d.pmesh" --base draco || exit 1
mkdir -p "$dir/zoo/tail" && python3 tests/scene/zoo.py "$dir/zoo" || exit 1
for scene in "$dir"/zoo/*.glb; do
    "$PMESH" bake -q "$scene" -o "${scene%.glb}.pmesh" &&
        "$PMESH" bake -q "$scene" -o "$dir/zoo/tail/${scene##*/}" || exit 1
done
PMESH_ZOO=$dir/zoo
PMESH_DRACO=$dir/d.pmesh
export PMESH_ZOO PMESH_DRACO
PMESH_GOLDEN=$PWD/tests/golden/ PMESH_SAMPLE=$dir/a.pmesh
PMESH_OTHER=$dir/b.pmesh
export PMESH PMESH_GOLDEN PMESH_SAMPLE PMESH_OTHER

# Beside the package, where "pmesh" is found.
mkdir -p $web/node_modules $web/tests
ln -sfn ../pmesh $web/node_modules/pmesh
cp tests/web/*.mjs $web/tests
run_tests $web/tests/*.test.mjs

[ "${NPM-}" = 1 ] || {
    skip "the viewer in a browser is left to make check-web"
    finish
}
CHROMIUM=$(command -v chromium || command -v chromium-browser) || {
    skip "browser skipped, there is no chromium"
    finish
}
SHOTS=$PWD/$web/shots
PACKAGE=$PWD/$web/pmesh
export CHROMIUM SHOTS PACKAGE
lock=tests/web/browser/package-lock.json
if ! cmp -s $lock $web/browser/installed; then
    mkdir -p $web/browser
    cp tests/web/browser/package.json $lock $web/browser/
    (cd $web/browser && npm ci --ignore-scripts --no-audit --no-fund --silent) &&
        cp $lock $web/browser/installed || exit 1
fi
tools/web/viewer/build.sh $web/pmesh $web/viewer.html || exit 1
cp tests/web/server.mjs tests/web/glb.mjs tests/web/browser/*.mjs $web/browser/
ln -sfn ../viewer/node_modules/three $web/node_modules/three
run_tests $web/browser/three.check.mjs
run_tests $web/browser/gltf.check.mjs
run_tests $web/browser/worker.check.mjs
run_tests $web/browser/viewer.check.mjs
THREE=$PWD/$web/viewer/node_modules/three
export THREE
run_tests $web/browser/progressive.check.mjs
finish
