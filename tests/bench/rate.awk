# SPDX-License-Identifier: MIT
# Prints for every model and kind of rate.csv, from 1 % of the file on (or from
# the first mesh), the largest ratio of our distance to that of the best Draco
# file with at most as many bytes, and where: once against simplified levels
# only, once with the full mesh at 8 to 14 bits among them. From rate.sh: kinds.
NR == 1 { next }
!($1 in seen) { seen[$1]; order[++n] = $1 }
$2 == "draco" {
    i = ++drc[$1]
    drc_bytes[$1, i] = $3
    drc_rms[$1, i] = $6
    drc_faces[$1, i] = $4
    if ($4 > full[$1]) full[$1] = $4
    next
}
{
    i = ++own[$1, $2]
    own_bytes[$1, $2, i] = $3
    own_rms[$1, $2, i] = $6
}

# The best Draco distance of at most `size` bytes; 0: there is none.
function best(model, size, with_full,  i, r) {
    r = 0
    for (i = 1; i <= drc[model]; i++) {
        if (drc_bytes[model, i] > size) continue
        if (!with_full && drc_faces[model, i] == full[model]) continue
        if (r == 0 || drc_rms[model, i] < r) r = drc_rms[model, i]
    }
    return r
}

# Sets worst, where.
function look(model, kind, with_full,  i, r, ratio) {
    worst = where = 0
    for (i = 1; i <= own[model, kind]; i++) {
        r = best(model, own_bytes[model, kind, i], with_full)
        ratio = r > 0 ? own_rms[model, kind, i] / r : 0
        if (ratio > worst) { worst = ratio; where = own_bytes[model, kind, i] }
    }
}

# What Draco offers below our first mesh; 0: nothing.
function early(model, from,  i, least) {
    least = 0
    for (i = 1; i <= drc[model]; i++)
        if (drc_bytes[model, i] < from &&
            (least == 0 || drc_bytes[model, i] < least))
            least = drc_bytes[model, i]
    return least
}

END {
    if (!n) { print "no models"; exit 1 }
    kind_count = split(kinds, kind, " ")
    print "worst (our rms) / (rms of the best Draco file of at most as many " \
        "bytes)"
    row = "%-11s %-9s %8s %7s %8s %8s %16s %8s %16s\n"
    printf row, "model", "pmesh", "bytes", "first", "draco", "levels", "at",
        "+ full", "at"
    for (k = 1; k <= kind_count; k++)
        for (m = 1; m <= n; m++)
            report(order[m], kind[k])
    for (k = 1; k <= kind_count; k++)
        printf "%-9s %d of %d models below Draco's levels from the first " \
            "mesh on, worst ratios' geometric mean %.3f; with full meshes " \
            "%d, %.3f\n", kind[k], below[kind[k], 0], n,
            exp(mean[kind[k], 0] / n), below[kind[k], 1],
            exp(mean[kind[k], 1] / n)
}

function at(size, all) {
    return sprintf("%d (%.1f %%)", size, 100 * size / all)
}

function report(model, name,  all, first, levels, levels_at) {
    all = own_bytes[model, name, own[model, name]]
    first = own_bytes[model, name, 1]
    look(model, name, 0)
    note(name, 0)
    levels = worst
    levels_at = at(where, all)
    look(model, name, 1)
    note(name, 1)
    printf row, model, name, all, sprintf("%.1f %%", 100 * first / all),
        early(model, first) ? early(model, first) : "-",
        sprintf("%.3f", levels), levels_at,
        sprintf("%.3f", worst), at(where, all)
}

function note(name, full) {
    below[name, full] += worst < 1
    mean[name, full] += log(worst > 0 ? worst : 1)
}
