#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: PMESH=build/release/pmesh tests/cli/run.sh [WORD]
#
# Tests the program from outside: tests/cli/case_*.sh, or those with WORD in
# their name, each in a fresh folder. See there for how a case reads.
set -u
cases=$(cd "$(dirname "$0")" && pwd)
case ${PMESH:=$cases/../../build/release/pmesh} in
/*) ;;
*) PMESH=$PWD/$PMESH ;;
esac
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
passed=0
failed=0
umask 022
LC_ALL=C
export LC_ALL

# ok NAME COMMAND...: the test passes if the command succeeds.
ok() {
    name=$1
    shift
    if "$@"; then
        passed=$((passed + 1))
        echo "ok - $name"
    else
        failed=$((failed + 1))
        echo "not ok - $name"
        echo "#   $*"
    fi
}

# check NAME CODE ARGUMENT...: pmesh ARGUMENT... exits with CODE; if that is
# not 0, it prints one clean line on stderr. Leaves its output in out and err.
check() {
    name=$1
    code=$2
    shift 2
    timeout 60 "$PMESH" "$@" >"$work/out" 2>"$work/err" </dev/null
    judge "$name" "$code" $? "pmesh $*"
}

judge() {
    verdict=ok
    [ "$3" = "$2" ] || verdict="exit code $3 instead of $2"
    if [ "$2" != 0 ] && [ "$verdict" = ok ]; then
        [ "$(wc -l <"$work/err")" -eq 1 ] || verdict='not one line of message'
        grep -q '^pmesh: ' "$work/err" || verdict='no message'
    fi
    tr -d '\n' <"$work/err" | grep -q '[[:cntrl:]]' &&
        verdict='control characters in the message'
    if [ "$verdict" = ok ]; then
        passed=$((passed + 1))
        echo "ok - $1"
    else
        failed=$((failed + 1))
        echo "not ok - $1: $verdict"
        echo "#   $4"
        sed 's/^/#   /' "$work/err"
    fi
}

err() { grep -q -e "$1" "$work/err"; }
out() { grep -q -e "$1" "$work/out"; }
silent() { [ ! -s "$work/err" ]; }
absent() { [ ! -e "$1" ]; }
size() { wc -c <"$1" | tr -d ' '; }
faces() { grep -c '^f ' "$1"; }
between() { [ "$1" -ge "$2" ] && [ "$1" -le "$3" ]; }
# Nothing but the named files is in the folder.
only() { [ "$(ls -A)" = "$(printf '%s\n' "$@" | sort)" ]; }
# json KEY: the number or text of a key, from the JSON in out.
json() {
    sed -n "s/^ *\"$1\": \"\{0,1\}\([^\",]*\).*/\1/p" "$work/out" | head -n 1
}
is_json() {
    ! command -v python3 >/dev/null ||
        python3 -c 'import json, sys; json.load(open(sys.argv[1]))' "$work/out"
}

# torus N FILE: a closed surface of 2 * N * N faces, as OBJ.
torus() {
    awk -v n="$1" 'BEGIN {
        pi = atan2(0, -1)
        for (i = 0; i < n; i++) for (j = 0; j < n; j++) {
            a = 2 * pi * i / n; b = 2 * pi * j / n
            r = 2 + cos(b) * (0.7 + 0.1 * sin(5 * a))
            printf "v %.6f %.6f %.6f\n", r * cos(a), r * sin(a), sin(b)
        }
        for (i = 0; i < n; i++) for (j = 0; j < n; j++) {
            p = i * n + j + 1; q = i * n + (j + 1) % n + 1
            r = ((i + 1) % n) * n + j + 1
            s = ((i + 1) % n) * n + (j + 1) % n + 1
            print "f", p, r, q; print "f", q, r, s
        }
    }' >"$2"
}

# flip FILE OFFSET: changes one bit.
flip() {
    byte=$(od -An -tu1 -j "$2" -N 1 "$1" | tr -d ' ')
    # shellcheck disable=SC2059 # the octal escape is the format
    printf "\\$(printf %03o $((byte ^ 16)))" |
        dd of="$1" bs=1 seek="$2" conv=notrunc 2>/dev/null
}

torus 48 "$work/torus.obj" # 4608 faces
torus=$work/torus.obj
baked=$work/torus.pmesh
"$PMESH" bake "$torus" -o "$baked" -q || echo "not ok - bake the torus"

for script in "$cases"/case_*"${1-}"*.sh; do
    mkdir "$work/d" && cd "$work/d" || exit 1
    # shellcheck source=/dev/null
    . "$script"
    cd "$work" && chmod -R u+w d && rm -rf d
done

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
