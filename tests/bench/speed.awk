# SPDX-License-Identifier: MIT
# awk -F , -f speed.awk speed.csv: a row for each comparison, geometric means
# over the models, and whether the bounds are met.

function met(value, bound)
{
    return bound ~ /^</ ? value <= substr(bound, 2) + 0 : \
        value >= substr(bound, 2) + 0
}

function verdict(value, must, aim)
{
    if (must != "" && !met(value, must))
        return "missed"
    if (aim != "" && met(value, aim))
        return "aim"
    return must != "" ? "met" : aim != "" ? "below aim" : ""
}

# Names have no commas in this table, but quotes around them.
NR == 1 { next }
{
    gsub(/"/, "")
    key = $3
    for (i = 4; i <= NF - 6; i++)
        key = key "," $i
    if (!(key in n)) {
        order[++rows] = key
        unit[key] = $(NF - 3)
        must[key] = $(NF - 1)
        aim[key] = $NF
    }
    n[key]++
    ours[key] += log($(NF - 5))
    peer[key] += $(NF - 4) == "" ? 0 : log($(NF - 4))
    alone[key] = $(NF - 4) == ""
    figure[key] += log($(NF - 2))
}
END {
    printf "%-64s %9s %9s %-11s %8s %6s %6s %s\n", "", "ours", "peer", "unit",
        "figure", "must", "aim", "verdict"
    for (i = 1; i <= rows; i++) {
        key = order[i]
        value = exp(figure[key] / n[key])
        printf "%-64s %9.4g %9s %-11s %8.3g %6s %6s %s\n", key,
            exp(ours[key] / n[key]),
            alone[key] ? "" : sprintf("%.4g", exp(peer[key] / n[key])),
            unit[key], value, must[key], aim[key],
            verdict(value, must[key], aim[key])
    }
}
