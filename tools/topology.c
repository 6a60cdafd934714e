/* SPDX-License-Identifier: MIT */
#include "tools/topology.h"

#include <stdlib.h>
#include <string.h>

/* An edge of a face: its ends in order, and whether the face runs high -> low.
 */
typedef struct side {
    uint32_t low, high, face;
    bool reversed;
} side;

/* ---- joining equal positions ------------------------------------------- */

/* Bits rather than values: a NaN must find itself again. */
typedef struct position_key {
    uint64_t bits[3];
} position_key;

static position_key key_of(const asset *mesh, size_t vertex)
{
    position_key key;
    for (size_t k = 0; k < 3; k++) {
        /* -0 and 0 are equal. */
        const double x = mesh->positions[3 * vertex + k] + 0.0;
        memcpy(&key.bits[k], &x, sizeof x);
    }
    return key;
}

static uint64_t key_hash(const position_key *key)
{
    uint64_t h = 0;
    for (size_t k = 0; k < 3; k++) {
        h = (h ^ key->bits[k]) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29;
    }
    return h * 0xbf58476d1ce4e5b9u >> 7;
}

uint32_t *topology_join(const asset *mesh)
{
    size_t slots = 16;
    while (slots < 2 * mesh->vertex_count)
        slots *= 2;
    uint32_t *first = malloc((mesh->vertex_count + 1) * sizeof *first);
    uint32_t *table = calloc(slots, sizeof *table); /* vertex + 1; 0: free */
    for (size_t v = 0; first && table && v < mesh->vertex_count; v++) {
        const position_key key = key_of(mesh, v);
        size_t at = (size_t)key_hash(&key) & (slots - 1);
        while (table[at]) {
            const position_key other = key_of(mesh, table[at] - 1);
            if (memcmp(&key, &other, sizeof key) == 0)
                break;
            at = (at + 1) & (slots - 1);
        }
        if (!table[at])
            table[at] = (uint32_t)v + 1;
        first[v] = table[at] - 1;
    }
    if (!table) {
        free(first);
        first = NULL;
    }
    free(table);
    return first;
}

/* ---- edges ------------------------------------------------------------- */

/* Stable counting sort of `sides` by one of their ends, into `out`. */
static void sort_by_end(const side *sides, size_t count, bool by_low,
                        size_t *starts, size_t vertex_count, side *out)
{
    memset(starts, 0, (vertex_count + 1) * sizeof *starts);
    for (size_t i = 0; i < count; i++)
        starts[(by_low ? sides[i].low : sides[i].high) + 1]++;
    for (size_t v = 0; v < vertex_count; v++)
        starts[v + 1] += starts[v];
    for (size_t i = 0; i < count; i++)
        out[starts[by_low ? sides[i].low : sides[i].high]++] = sides[i];
}

static size_t collect_sides(const asset *mesh, const uint32_t *first,
                            side *sides, topology_report *out)
{
    size_t count = 0;
    for (size_t f = 0; f < mesh->face_count; f++) {
        uint32_t v[3];
        for (size_t k = 0; k < 3; k++)
            v[k] = first[mesh->indices[3 * f + k]];
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
            out->degenerate_faces++;
            continue;
        }
        for (size_t k = 0; k < 3; k++) {
            const uint32_t a = v[k];
            const uint32_t b = v[(k + 1) % 3];
            sides[count++] = (side){ .low = a < b ? a : b,
                                     .high = a < b ? b : a,
                                     .face = (uint32_t)f,
                                     .reversed = a > b };
        }
    }
    return count;
}

static void normal_of(const asset *mesh, uint32_t face, double n[3])
{
    const uint32_t *t = &mesh->indices[3 * (size_t)face];
    const double *p = &mesh->positions[3 * (size_t)t[0]];
    double a[3], b[3];

    for (size_t k = 0; k < 3; k++) {
        a[k] = mesh->positions[3 * (size_t)t[1] + k] - p[k];
        b[k] = mesh->positions[3 * (size_t)t[2] + k] - p[k];
    }
    n[0] = a[1] * b[2] - a[2] * b[1];
    n[1] = a[2] * b[0] - a[0] * b[2];
    n[2] = a[0] * b[1] - a[1] * b[0];
}

/* cos 150 degrees is -sqrt(3 / 4); without square roots. */
static bool is_fold(const asset *mesh, const side *a, const side *b)
{
    double n[3], m[3], square_n = 0, square_m = 0, product = 0;

    normal_of(mesh, a->face, n);
    normal_of(mesh, b->face, m);
    for (size_t k = 0; k < 3; k++) {
        square_n += n[k] * n[k];
        square_m += m[k] * m[k];
        product += n[k] * m[k];
    }
    return product < 0 && product * product > 0.75 * square_n * square_m;
}

/* `sides` has the sides of an edge next to each other. */
static size_t count_edges(const asset *mesh, const side *sides, size_t count,
                          topology_report *out)
{
    size_t edges = 0;
    for (size_t i = 0, n; i < count; i += n) {
        n = 1;
        while (i + n < count && sides[i + n].low == sides[i].low &&
               sides[i + n].high == sides[i].high)
            n++;
        edges++;
        out->boundary_edges += n == 1;
        out->nonmanifold_edges += n > 2;
        out->misoriented_edges +=
            n == 2 && sides[i].reversed == sides[i + 1].reversed;
        out->folds += n == 2 && sides[i].reversed != sides[i + 1].reversed &&
                      is_fold(mesh, &sides[i], &sides[i + 1]);
    }
    return edges;
}

/* ---- pieces ------------------------------------------------------------ */

static uint32_t find_root(uint32_t *parent, uint32_t v)
{
    while (parent[v] != v) {
        parent[v] = parent[parent[v]];
        v = parent[v];
    }
    return v;
}

static void count_pieces(const side *sides, size_t count, uint32_t *parent,
                         size_t vertex_count, topology_report *out)
{
    /* UINT32_MAX marks vertices that no face uses. */
    memset(parent, 0xff, vertex_count * sizeof *parent);
    for (size_t i = 0; i < count; i++) {
        parent[sides[i].low] = sides[i].low;
        parent[sides[i].high] = sides[i].high;
    }
    for (size_t i = 0; i < count; i++) {
        const uint32_t a = find_root(parent, sides[i].low);
        const uint32_t b = find_root(parent, sides[i].high);
        if (a < b)
            parent[b] = a;
        else
            parent[a] = b;
    }
    for (size_t v = 0; v < vertex_count; v++) {
        out->vertices += parent[v] != UINT32_MAX;
        out->components += parent[v] == v;
    }
}

bool topology_measure(const asset *mesh, topology_report *out)
{
    *out = (topology_report){ .faces = mesh->face_count };
    const size_t nv = mesh->vertex_count;
    const size_t limit = 3 * mesh->face_count + 1;
    uint32_t *first = topology_join(mesh);
    side *sides = calloc(limit, sizeof *sides);
    side *sorted = calloc(limit, sizeof *sorted);
    size_t *starts = malloc((nv + 1) * sizeof *starts);
    const bool ok = first && sides && sorted && starts;
    if (ok) {
        const size_t count = collect_sides(mesh, first, sides, out);
        sort_by_end(sides, count, false, starts, nv, sorted);
        sort_by_end(sorted, count, true, starts, nv, sides);
        const size_t edges = count_edges(mesh, sides, count, out);
        count_pieces(sides, count, first, nv, out);
        out->euler = (long long)out->vertices - (long long)edges +
                     (long long)(mesh->face_count - out->degenerate_faces);
    }
    free(first);
    free(sides);
    free(sorted);
    free(starts);
    return ok;
}
