#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/bench/all.sh BUILD_DIR
# Runs every benchmark; see common.sh for what the environment says.
set -eu
PMESH=$1/pmesh
export PMESH

echo "== bytes, positions at 12 bits"
tests/bench/size.sh
echo "== distance to the original at equal face counts"
tests/bench/quality.sh
echo "== cost of exact positions"
tests/bench/lossless.sh
echo "== time and memory"
tests/bench/time.sh
