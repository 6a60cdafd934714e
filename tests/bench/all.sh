#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/all.sh
# Runs every benchmark; see common.sh for what the environment says.
set -eu
echo "== bytes of complete files"
tests/bench/size.sh
echo "== bytes of meshes with attributes"
tests/bench/attribute-size.sh
echo "== bytes against distance"
tests/bench/rate.sh
echo "== distance at equal face counts: strict quadric order"
tests/bench/lod.sh
echo "== distance at equal face counts: other programs"
tests/bench/quality.sh
echo "== attributes of simplified meshes"
tests/bench/attributes.sh
echo "== cost of exact positions"
tests/bench/lossless.sh
echo "== skinned levels in motion"
tests/bench/skin.sh
echo "== time to decode"
tests/bench/decode.sh
echo "== time of moving between levels"
tests/bench/refine.sh
echo "== speed and memory against other programs"
tests/bench/speed.sh
echo "== time and memory"
tests/bench/time.sh
