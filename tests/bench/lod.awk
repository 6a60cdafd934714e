# SPDX-License-Identifier: MIT
# Prints ratios of lod.csv: distance of our levels / of strict order with one
# metric and the same placement. From lod.sh: percents, metric.
NR == 1 { next }
!($1 in seen) { seen[$1]; order[++n] = $1 }
$6 > 0 && $5 <= 1.02 * $4 && $5 >= 0.98 * $4 { rms[$1, $2, $3] = $6 }

function ratio(model, kind, p,  own, base) {
    own = rms[model, kind, p]
    base = rms[model, metric (kind == "optimal" ? "-optimal" : "-subset"), p]
    return own > 0 && base > 0 ? own / base : 0
}

function cell(r) {
    return sprintf(" %8s", r > 0 ? sprintf("%.3f", r) : "-")
}

function row(model, kind,  p, r, line) {
    line = sprintf("%-12s %-9s", model, kind)
    for (p = 1; p <= percent_count; p++) {
        r = ratio(model, kind, percent[p])
        line = line cell(r)
        if (r > 0) { sum[kind, p] += log(r); count[kind, p]++ }
        if (r > worst[kind, p]) worst[kind, p] = r
    }
    print line
}

function mean(kind, p) {
    return count[kind, p] ? exp(sum[kind, p] / count[kind, p]) : 0
}

function last_rows(kind,  p) {
    printf "%-12s %-9s", "geo. mean", kind
    for (p = 1; p <= percent_count; p++)
        printf "%s", cell(mean(kind, p))
    printf "\n%-12s %-9s", "worst", kind
    for (p = 1; p <= percent_count; p++)
        printf "%s", cell(worst[kind, p])
    print ""
}

END {
    if (!n) { print "no models"; exit 1 }
    percent_count = split(percents, percent, " ")
    kind_count = split("balanced quality optimal", kind, " ")
    printf "%-22s", "rms / " metric
    for (p = 1; p <= percent_count; p++)
        printf " %6s %%", percent[p]
    print ""
    for (k = 1; k <= kind_count; k++)
        for (m = 1; m <= n; m++)
            row(order[m], kind[k])
    for (k = 1; k <= kind_count; k++)
        last_rows(kind[k])
    print ""
}
