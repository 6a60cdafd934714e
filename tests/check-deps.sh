#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tests/check-deps.sh
#
# Checks every #include against the architecture:
#
#              format            a few headers of the C library
#             /      \
#       decoder      encoder     never see each other
#             \      /
#              tools             public headers only: pmesh*.h
#                |
#              tests             anything
#
# Includes in quotes are relative to the root and name a file that exists; a
# source includes its own header first; headers form no cycle.
set -u
folders="format decoder encoder tools tests"
pairs=$(mktemp) || exit 1
trap 'rm -f "$pairs"' EXIT

# shellcheck disable=SC2086 # words on purpose
find $folders -name '*.[ch]' -o -name '*.cpp' -o -name '*.hpp' | sort |
    xargs awk -v pairs="$pairs" '
function complain(rule) {
    printf "%s:%d: %s: %s\n", FILENAME, FNR, target, rule
    bad++
}
function exists(path,  line, found) {
    found = (getline line < path) >= 0
    close(path)
    return found
}
BEGIN {
    floor["format"] = floor["decoder"] = "^(assert|float|limits|stdbool|" \
        "stddef|stdint|stdlib|string)[.]h$"
    floor["encoder"] = "^(assert|float|limits|math|pthread|stdatomic|" \
        "stdbool|stddef|stdint|stdlib|string|threads)[.]h$"
    sees["format"] = "^format/"
    sees["decoder"] = "^(format|decoder)/"
    sees["encoder"] = "^(format|encoder)/"
    sees["tools"] = "^(tools/|(format|decoder|encoder)/pmesh[a-z_]*[.]h$)"
    sees["tests"] = "^(format|decoder|encoder|tools|tests)/"
}
FNR == 1 {
    folder = FILENAME
    sub(/\/.*/, "", folder)
    first = 1
}
/^[ \t]*#[ \t]*include/ {
    total++
    target = $0
    sub(/^[ \t]*#[ \t]*include[ \t]*/, "", target)
    quoted = target ~ /^"/
    if (!quoted && target !~ /^</)
        complain("a macro hides what is included")
    target = substr(target, 2)
    sub(/[">].*$/, "", target)

    if (!quoted && FILENAME == "format/lanes_sse2.h" && target == "emmintrin.h")
        next
    if (!quoted && (folder in floor) && target !~ floor[folder])
        complain("not for " folder "/: see the list in this script")
    if (quoted && target !~ sees[folder])
        complain(folder "/ must not see this")
    else if (quoted && !exists(target))
        complain("no such file below the root")

    own = FILENAME
    if (first && sub(/[.]c(pp)?$/, ".h", own) && exists(own) && target != own)
        complain("the file'\''s own header comes first")
    first = 0
    if (quoted && FILENAME ~ /[.]h(pp)?$/)
        print FILENAME, target >pairs
}
END {
    printf "check-deps: %d includes, %d violations\n", total, bad
    exit bad > 0
}'
status=$?
tsort "$pairs" >/dev/null || status=1
exit $status
