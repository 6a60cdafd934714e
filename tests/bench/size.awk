# SPDX-License-Identifier: MIT
# Prints size.csv: ratios to Draco of each model, and bits per vertex of the
# parts. From size.sh: grids, kinds.
NR == 1 { split($0, title); next }
{
    if (!($1 in faces)) order[++n] = $1
    faces[$1] = $2
    bytes[$1, $4, $5] = $6
    vertices[$4, $5] += $3
    for (i = 6; i <= 10; i++)
        sum[$4, $5, i] += $i
}

function ratios(bits,  m, k, r, worst, where, mean) {
    printf "%-14s %8s %9s", bits " bits", "faces", "draco"
    for (k = 1; k <= kind_count; k++)
        printf " %9s %-7s", kind[k], ""
    print ""
    for (m = 1; m <= n; m++) {
        printf "%-14s %8d %9d", order[m], faces[order[m]],
            bytes[order[m], bits, "draco"]
        for (k = 1; k <= kind_count; k++) {
            r = bytes[order[m], bits, kind[k]] / bytes[order[m], bits, "draco"]
            printf " %9d %-7.3f", bytes[order[m], bits, kind[k]], r
            mean[k] += log(r) / n
            if (r > worst[k]) { worst[k] = r; where[k] = order[m] }
        }
        print ""
    }
    printf "%-14s %8s %9d", "sum", "", sum[bits, "draco", 6]
    for (k = 1; k <= kind_count; k++)
        printf " %9d %-7.3f", sum[bits, kind[k], 6],
            sum[bits, kind[k], 6] / sum[bits, "draco", 6]
    printf "\n%-14s %8s %9s", "geometric mean", "", ""
    for (k = 1; k <= kind_count; k++)
        printf " %9s %-7.3f", "", exp(mean[k])
    printf "\n%-14s %8s %9s", "worst", "", ""
    for (k = 1; k <= kind_count; k++)
        printf " %9s %-7.3f", where[k], worst[k]
    print "\n"
}

function parts(bits,  k, i, c) {
    printf "%-14s", "bits/vertex"
    for (i = 6; i <= 10; i++)
        printf " %12s", title[i] == "bytes" ? "all" : title[i]
    print ""
    for (k = 1; k <= kind_count + 1; k++) {
        c = k <= kind_count ? kind[k] : "draco"
        printf "%-14s", c
        for (i = 6; i <= (c == "draco" ? 6 : 10); i++)
            printf " %12.3f", 8 * sum[bits, c, i] / vertices[bits, c]
        print ""
    }
    print ""
}

END {
    if (!n) { print "no models"; exit 1 }
    kind_count = split(kinds, kind, " ")
    grid_count = split(grids, grid, " ")
    for (g = 1; g <= grid_count; g++) {
        ratios(grid[g])
        parts(grid[g])
    }
}
