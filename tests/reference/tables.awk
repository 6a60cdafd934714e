# SPDX-License-Identifier: MIT
# Usage: awk -f tests/reference/tables.awk SPEC.md
#
# The arrays of appendix C as C: flat, in SPEC.md's order.

function finish() {
    if (name != "" && count != wanted) {
        printf "tables.awk: %s has %d numbers, not %d\n", name, count,
            wanted >"/dev/stderr"
        failed = 1
    }
    if (name != "")
        print "};"
    name = ""
}

BEGIN { print "/* Made from SPEC.md. */\n#include \"tests/reference/ref.h\"" }
/^## / { part = $2 " " $3 }
part != "Appendix C:" { next }
/^[A-Z]+(\[[0-9]+\])+:$/ {
    name = dims = $0
    sub(/\[.*/, "", name)
    gsub(/[^0-9]+/, " ", dims)
    wanted = 1
    for (i = split(dims, d, " "); i > 0; i--)
        wanted *= d[i]
    count = 0
    printf "\nconst int ref_%s[%d] = {\n", name, wanted
}
/^```/ { if (inside) finish(); inside = !inside; next }
inside && name != "" {
    count += NF
    gsub(/ /, ", ")
    print "    " $0 ","
}
END { exit failed }
