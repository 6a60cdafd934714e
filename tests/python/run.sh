#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/python/run.sh
# The Python module with the shared library beside the program.
set -u
if ! command -v python3 >/dev/null; then
    echo "python: skipped, there is no python3"
    exit 0
fi
if [ "$(basename "$(dirname "$PMESH")")" = sanitize ]; then
    echo "python: skipped, a sanitized library needs a sanitized python"
    exit 0
fi
PMESH_LIBRARY=$(cd "$(dirname "$PMESH")" && pwd)/libpmesh.so
export PMESH PMESH_LIBRARY
exec python3 tests/python/test_pmesh.py
