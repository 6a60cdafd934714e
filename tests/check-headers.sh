#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/check-headers.sh      (CC and CXX from the environment)
#
# Compiles every header alone: as C11, public ones (pmesh*.h, tools/asset.h) as
# C++11 too, those that only C++ sources include as C++17. Warnings are errors.
set -u
total=0
bad=0

# compile HEADER COMPILER...
compile() {
    header=$1
    shift
    total=$((total + 1))
    echo "#include \"$header\"" |
        "$@" -I. -Wall -Wextra -Wpedantic -Werror -fsyntax-only - ||
        bad=$((bad + 1))
}

# included_by PATTERN HEADER
included_by() {
    grep -rq --include="$1" "#include \"$2\"" tools tests
}

for header in $(find format decoder encoder tools tests -name '*.h' | sort); do
    case $header in
    format/pmesh*.h | decoder/pmesh*.h | encoder/pmesh*.h | tools/asset.h)
        compile "$header" "${CXX:-c++}" -std=c++11 -x c++
        ;;
    esac
    case $header in
    tools/* | tests/*)
        if included_by '*.cpp' "$header" && ! included_by '*.c' "$header"; then
            compile "$header" "${CXX:-c++}" -std=c++17 -x c++
        else
            compile "$header" "${CC:-cc}" -std=c11 \
                -D_POSIX_C_SOURCE=200809L -x c
        fi
        ;;
    *) compile "$header" "${CC:-cc}" -std=c11 -x c ;;
    esac
done
echo "check-headers: $total compilations, $bad failures"
[ "$bad" = 0 ]
