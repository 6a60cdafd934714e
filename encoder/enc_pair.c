/* SPDX-License-Identifier: MIT */
#include "encoder/enc_import.h"

#include "format/alloc.h"

/* Edges with more half-edges than this in one direction stay open: the search
 * for the best pairs looks at all of them. */
#define MAX_FAN 16

/*
 * Half-edges are sorted into buckets by the lower of their two vertices, and
 * each bucket by the higher one: the half-edges of one edge become neighbours.
 * A sort key is, from the top: higher vertex (32 bits), runs downwards (1),
 * half-edge (31).
 */
typedef struct pairer {
    enc_mesh *mesh;
    enc_pairing *result;
    uint32_t corner_count;
    uint32_t *first;     /* per vertex and one more: start of its bucket */
    uint32_t *half_edge; /* bucket by bucket */
    size_t largest;      /* bucket */
    uint64_t *key;       /* of one bucket */
    uint64_t *other_key; /* of some of its half-edges */
} pairer;

/* Of several threads each takes so many vertices at a time; where a bucket is
 * larger than that, one thread takes all. */
enum { BLOCK = 2048, LARGEST_SHARED = 4096 };

static uint32_t tail_of(const pairer *pair, uint32_t h)
{
    return pair->mesh->vertex[h];
}

static uint32_t head_of(const pairer *pair, uint32_t h)
{
    return pair->mesh->vertex[enc_next_corner(h)];
}

static uint32_t apex_of(const pairer *pair, uint32_t h)
{
    return pair->mesh->vertex[enc_previous_corner(h)];
}

static uint32_t material_of(const pairer *pair, uint32_t h)
{
    return pair->mesh->material ? pair->mesh->material[h / 3] : 0;
}

static uint32_t key_vertex(uint64_t key)
{
    return (uint32_t)(key >> 32);
}

static bool key_runs_down(uint64_t key)
{
    return key >> 31 & 1;
}

static uint32_t key_half_edge(uint64_t key)
{
    return (uint32_t)key & UINT32_C(0x7fffffff);
}

static void sift_down(uint64_t *key, size_t i, size_t count)
{
    const uint64_t moved = key[i];

    for (size_t child = 2 * i + 1; child < count; child = 2 * i + 1) {
        if (child + 1 < count && key[child + 1] > key[child])
            child++;
        if (key[child] <= moved)
            break;
        key[i] = key[child];
        i = child;
    }
    key[i] = moved;
}

/* By insertion for the ordinary handful, as a heap for thousands. */
static void sort_keys(uint64_t *key, size_t count)
{
    if (count <= 32) {
        for (size_t i = 1; i < count; i++) {
            const uint64_t moved = key[i];
            size_t j = i;
            for (; j > 0 && key[j - 1] > moved; j--)
                key[j] = key[j - 1];
            key[j] = moved;
        }
        return;
    }
    for (size_t i = count / 2; i-- > 0;)
        sift_down(key, i, count);
    for (size_t last = count - 1; last > 0; last--) {
        const uint64_t largest = key[0];
        key[0] = key[last];
        key[last] = largest;
        sift_down(key, 0, last);
    }
}

static uint32_t lower_vertex(const pairer *pair, uint32_t h)
{
    const uint32_t tail = tail_of(pair, h), head = head_of(pair, h);

    return tail < head ? tail : head;
}

/* A counting sort. */
static void fill_buckets(pairer *pair)
{
    const uint32_t vertex_count = pair->mesh->vertex_count;
    uint32_t *first = pair->first;

    memset(first, 0, ((size_t)vertex_count + 1) * sizeof *first);
    for (uint32_t h = 0; h < pair->corner_count; h++)
        first[lower_vertex(pair, h)]++;
    uint32_t sum = 0;
    for (uint32_t v = 0; v < vertex_count; v++) {
        if (first[v] > pair->largest)
            pair->largest = first[v];
        sum += first[v];
        first[v] = sum;
    }
    first[vertex_count] = sum;
    for (uint32_t h = pair->corner_count; h-- > 0;)
        pair->half_edge[--first[lower_vertex(pair, h)]] = h;
}

static size_t load_bucket(pairer *pair, uint32_t v)
{
    const size_t count = pair->first[v + 1] - pair->first[v];
    const uint32_t *bucket = pair->half_edge + pair->first[v];

    for (size_t i = 0; i < count; i++) {
        const uint32_t h = bucket[i], tail = tail_of(pair, h);
        const uint64_t down = tail != v;
        const uint32_t high = down ? tail : head_of(pair, h);
        pair->key[i] = (uint64_t)high << 32 | down << 31 | h;
    }
    sort_keys(pair->key, count);
    return count;
}

/* Faces over the same three vertices, all turned the same way: keeps the first
 * of each material. `key` holds their half-edges (low half), any order. */
static void drop_repeated(pairer *pair, uint64_t *key, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const uint32_t h = key_half_edge(key[i]);
        key[i] = (uint64_t)material_of(pair, h) << 32 | h;
    }
    sort_keys(key, count);
    for (size_t i = 1; i < count; i++) {
        if (key_vertex(key[i]) != key_vertex(key[i - 1]))
            continue;
        if (pair->result->repeated)
            enc_bit_put(pair->result->repeated, key_half_edge(key[i]) / 3);
        pair->result->repeated_count++;
    }
}

/* A face is looked at from its least vertex v only: from the half-edge that
 * leaves it. `key` are half-edges from v to one other vertex. */
static void find_repeated(pairer *pair, const uint64_t *key, size_t count,
                          uint32_t v)
{
    uint64_t *apex = pair->other_key;
    size_t n = 0;

    for (size_t i = 0; i < count; i++) {
        const uint32_t h = key_half_edge(key[i]);
        if (apex_of(pair, h) > v)
            apex[n++] = (uint64_t)apex_of(pair, h) << 32 | h;
    }
    sort_keys(apex, n);
    for (size_t i = 0, end; i < n; i = end) {
        end = i + 1;
        while (end < n && key_vertex(apex[end]) == key_vertex(apex[i]))
            end++;
        if (end - i > 1)
            drop_repeated(pair, apex + i, end - i);
    }
}

/* One edge with its living half-edges; all "up" ones run from lower to higher
 * vertex. Normals are integers below 2^52: exact. */
typedef struct edge_fan {
    uint32_t up_count, down_count;
    uint32_t up[MAX_FAN], down[MAX_FAN];
    double up_normal[MAX_FAN][3], down_normal[MAX_FAN][3];
    double down_apex[MAX_FAN][3]; /* relative to the lower vertex */
} edge_fan;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(const int32_t p[3], const int32_t q[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (double)p[k] - (double)q[k];
}

/* edge x apex, times `sign`: -1 for a face that runs down the edge. */
static void face_normal(const double edge[3], const double apex[3],
                        double sign, double out[3])
{
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = sign * (edge[i] * apex[j] - edge[j] * apex[i]);
    }
}

static void measure_fan(const pairer *pair, edge_fan *fan)
{
    int32_t (*const position)[3] = pair->mesh->position;
    const int32_t *low = position[tail_of(pair, fan->up[0])];
    double edge[3], apex[3];

    subtract(position[head_of(pair, fan->up[0])], low, edge);
    for (uint32_t i = 0; i < fan->up_count; i++) {
        subtract(position[apex_of(pair, fan->up[i])], low, apex);
        face_normal(edge, apex, 1.0, fan->up_normal[i]);
    }
    for (uint32_t i = 0; i < fan->down_count; i++) {
        subtract(position[apex_of(pair, fan->down[i])], low,
                 fan->down_apex[i]);
        face_normal(edge, fan->down_apex[i], -1.0, fan->down_normal[i]);
    }
}

/* How well two faces continue each other. Compared in this order: the cosine
 * of the turn (here: its square with its sign), one material, a convex edge
 * (solids that touch in an edge fall apart, not together). */
typedef struct fit {
    double cosine;
    bool same_material, convex;
} fit;

static fit fit_of(const pairer *pair, const edge_fan *fan, uint32_t i,
                  uint32_t j)
{
    const double *n = fan->up_normal[i], *m = fan->down_normal[j];
    const double product = dot(n, m), scale = dot(n, n) * dot(m, m);

    return (fit){
        .cosine = scale > 0.0
            ? product * (product < 0.0 ? -product : product) / scale : 0.0,
        .same_material = material_of(pair, fan->up[i]) ==
                         material_of(pair, fan->down[j]),
        .convex = dot(n, fan->down_apex[j]) < 0.0
    };
}

static bool is_better(fit a, fit b)
{
    if (a.cosine != b.cosine)
        return a.cosine > b.cosine;
    if (a.same_material != b.same_material)
        return a.same_material;
    return a.convex && !b.convex;
}

static void make_twins(pairer *pair, uint32_t g, uint32_t h)
{
    pair->mesh->twin[g] = h;
    pair->mesh->twin[h] = g;
}

/* Takes the best pair, again and again; ties go to the earlier faces. */
static void pair_by_turn(pairer *pair, edge_fan *fan)
{
    uint32_t *twin = pair->mesh->twin;

    measure_fan(pair, fan);
    for (;;) {
        fit best = { .cosine = -2.0 };
        uint32_t g = ENC_NONE, h = ENC_NONE;
        for (uint32_t i = 0; i < fan->up_count; i++) {
            if (twin[fan->up[i]] != ENC_NONE)
                continue;
            for (uint32_t j = 0; j < fan->down_count; j++) {
                const uint32_t up = fan->up[i], down = fan->down[j];
                if (twin[down] != ENC_NONE ||
                    apex_of(pair, up) == apex_of(pair, down))
                    continue;
                const fit candidate = fit_of(pair, fan, i, j);
                if (is_better(candidate, best)) {
                    best = candidate;
                    g = up;
                    h = down;
                }
            }
        }
        if (g == ENC_NONE)
            return;
        make_twins(pair, g, h);
    }
}

/* `key`: all half-edges of one edge. */
static void pair_edge(pairer *pair, const uint64_t *key, size_t count)
{
    edge_fan fan; /* large: filled as far as needed */

    fan.up_count = fan.down_count = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t h = key_half_edge(key[i]);
        const bool down = key_runs_down(key[i]);
        if (pair->result->repeated &&
            enc_bit_get(pair->result->repeated, h / 3))
            continue;
        if ((down ? fan.down_count : fan.up_count) == MAX_FAN) {
            pair->result->regular = false;
            return;
        }
        if (down)
            fan.down[fan.down_count++] = h;
        else
            fan.up[fan.up_count++] = h;
    }
    if (fan.up_count + fan.down_count < 2)
        return;
    if (fan.up_count == 1 && fan.down_count == 1 &&
        apex_of(pair, fan.up[0]) != apex_of(pair, fan.down[0])) {
        make_twins(pair, fan.up[0], fan.down[0]);
        return;
    }
    pair->result->regular = false;
    if (fan.up_count > 0 && fan.down_count > 0)
        pair_by_turn(pair, &fan);
}

/*
 * A bucket holds all half-edges at v of the faces whose least vertex is v, so
 * these faces are weeded out first. Their third half-edges are in a later one.
 */
static void pair_bucket(pairer *pair, uint32_t v)
{
    const size_t count = load_bucket(pair, v);
    const uint64_t *key = pair->key;

    for (size_t i = 0, end; i < count; i = end) {
        end = i + 1;
        while (end < count && key[end] >> 31 == key[i] >> 31)
            end++;
        if (end - i > 1 && !key_runs_down(key[i]))
            find_repeated(pair, key + i, end - i, v);
    }
    for (size_t i = 0, end; i < count; i = end) {
        end = i + 1;
        while (end < count && key_vertex(key[end]) == key_vertex(key[i]))
            end++;
        if (end - i > 1)
            pair_edge(pair, key + i, end - i);
    }
}

/* ---- all ----------------------------------------------------------------- */

static void pair_serially(pairer *pair)
{
    for (uint32_t v = 0; v < pair->mesh->vertex_count; v++)
        pair_bucket(pair, v);
}

/* Shared among threads: their keys lie one behind the other. */
typedef struct sharing {
    const pairer *all;
    enc_pairing *found; /* per block; repeated faces are counted only */
} sharing;

static void pair_block(void *user, uint32_t part, unsigned worker)
{
    const sharing *s = user;
    const uint32_t first = part * BLOCK, all = s->all->mesh->vertex_count;
    const uint32_t end = all - first < BLOCK ? all : first + BLOCK;
    pairer mine = *s->all;

    mine.key += 2 * worker * mine.largest;
    mine.other_key = mine.key + mine.largest;
    mine.result = &s->found[part];
    *mine.result = (enc_pairing){ .regular = true };
    for (uint32_t v = first; v < end; v++)
        pair_bucket(&mine, v);
}

static void forget_twins(const pairer *pair)
{
    memset(pair->mesh->twin, 0xff,
           pair->corner_count * sizeof *pair->mesh->twin);
}

/* An edge is in one bucket, so buckets do not depend on each other, unless by
 * faces that are repeated: then, which is rare, all goes by one thread. False,
 * with nothing done, if memory is out. */
static bool pair_shared(pairer *pair)
{
    const uint32_t blocks = (pair->mesh->vertex_count + BLOCK - 1) / BLOCK;
    const pmesh_allocator *a = &pair->mesh->allocator;
    sharing s = { .all = pair };
    uint32_t repeated = 0;

    s.found = pmesh_alloc(a, blocks, sizeof *s.found);
    if (!s.found)
        return false;
    enc_pool_run(pair->mesh->pool, blocks, pair_block, &s);
    for (uint32_t i = 0; i < blocks; i++) {
        repeated += s.found[i].repeated_count;
        pair->result->regular &= s.found[i].regular;
    }
    pmesh_release(a, s.found, blocks, sizeof *s.found);
    if (repeated == 0)
        return true;
    pair->result->regular = true;
    forget_twins(pair);
    pair_serially(pair);
    return true;
}

/* The half-edges are in their buckets. */
static bool pair_buckets(pairer *pair)
{
    const pmesh_allocator *a = &pair->mesh->allocator;
    const bool shared = pair->mesh->pool && pair->largest <= LARGEST_SHARED;
    const size_t workers = shared ? enc_pool_workers(pair->mesh->pool) : 1;
    const size_t keys = 2 * workers * pair->largest;
    bool good = true;

    pair->key = pmesh_alloc(a, keys, sizeof *pair->key);
    if (!pair->key)
        return false;
    pair->other_key = pair->key + pair->largest;
    if (shared)
        good = pair_shared(pair);
    else
        pair_serially(pair);
    pmesh_release(a, pair->key, keys, sizeof *pair->key);
    return good;
}

pmesh_status enc_pair(enc_mesh *mesh, enc_pairing *pairing)
{
    const pmesh_allocator *a = &mesh->allocator;
    const size_t starts = (size_t)mesh->vertex_count + 1;
    const size_t corners = 3 * (size_t)mesh->face_count;
    pairer pair = { .mesh = mesh, .result = pairing,
                    .corner_count = (uint32_t)corners };
    bool good;

    pairing->repeated_count = 0;
    pairing->regular = true;
    mesh->twin = pmesh_alloc(a, corners, sizeof *mesh->twin);
    if (!mesh->twin)
        return PMESH_E_MEMORY;
    forget_twins(&pair);
    pair.first = pmesh_alloc(a, starts, sizeof *pair.first);
    pair.half_edge = pmesh_alloc(a, corners, sizeof *pair.half_edge);
    good = pair.first && pair.half_edge;
    if (good) {
        fill_buckets(&pair);
        good = pair_buckets(&pair);
    }
    pmesh_release(a, pair.half_edge, corners, sizeof *pair.half_edge);
    pmesh_release(a, pair.first, starts, sizeof *pair.first);
    return good ? PMESH_OK : PMESH_E_MEMORY;
}
