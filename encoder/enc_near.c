/* SPDX-License-Identifier: MIT */
#include "encoder/enc_near.h"

#include <string.h>

#include "format/alloc.h"

enum {
    MOST_PAIRS = 4,      /* of a vertex, by distance alone */
    MOST_FACES = 8,      /* of a sheet that is small */
    MOST_NEIGHBOURS = 3, /* of a vertex that wants a pair, like a leaf's */
    MOST_FANS = 64,      /* of a vertex of a pair: they are compared */
    MOST_LOOKS = 1 << 14 /* vertices looked at for one */
};

/* Vertices in cubic cells: hash chains. */
typedef struct cells {
    const int32_t (*position)[3];
    uint32_t count; /* vertices */
    int64_t size;
    uint32_t *head, *next;
    uint64_t mask;
} cells;

pmesh_status enc_near_create(const pmesh_allocator *a, uint32_t capacity,
                             enc_near *out)
{
    *out = (enc_near){ .allocator = *a, .capacity = capacity };
    out->pair = pmesh_alloc(a, capacity, sizeof *out->pair);
    return out->pair ? PMESH_OK : PMESH_E_MEMORY;
}

void enc_near_destroy(enc_near *near)
{
    if (near->pair)
        pmesh_release(&near->allocator, near->pair, near->capacity,
                      sizeof *near->pair);
    *near = (enc_near){ 0 };
}

static uint64_t slot_of(const cells *c, int64_t x, int64_t y, int64_t z)
{
    const uint64_t key = (uint64_t)x * 0x9e3779b97f4a7c15u ^
                         (uint64_t)y * 0xc2b2ae3d27d4eb4fu ^
                         (uint64_t)z * 0x165667b19e3779f9u;
    return (key ^ key >> 29) * 0x9e3779b97f4a7c15u >> 32 & c->mask;
}

static bool cells_create(const pmesh_allocator *a, cells *c,
                         const int32_t (*position)[3], uint32_t count)
{
    *c = (cells){ .position = position, .count = count, .mask = 63 };
    while (c->mask < count)
        c->mask = 2 * c->mask + 1;
    c->head = pmesh_alloc(a, (size_t)c->mask + 1, sizeof *c->head);
    c->next = pmesh_alloc(a, count, sizeof *c->next);
    return c->head && c->next;
}

static void cells_destroy(const pmesh_allocator *a, cells *c)
{
    pmesh_release(a, c->head, (size_t)c->mask + 1, sizeof *c->head);
    pmesh_release(a, c->next, c->count, sizeof *c->next);
}

/* Chains run from low to high vertices. `alive`: first[] of a surface, or NULL
 * for all. */
static void cells_fill(cells *c, int64_t size, const uint32_t *alive)
{
    c->size = size < 1 ? 1 : size;
    memset(c->head, 0xff, ((size_t)c->mask + 1) * sizeof *c->head);
    for (uint32_t v = c->count; v-- > 0;) {
        const int32_t *p = c->position[v];
        if (alive && alive[v] == ENC_NONE)
            continue;
        uint32_t *head = &c->head[slot_of(c, p[0] / c->size, p[1] / c->size,
                                          p[2] / c->size)];
        c->next[v] = *head;
        *head = v;
    }
}

static int64_t distance_square(const cells *c, uint32_t v, uint32_t w)
{
    int64_t sum = 0;
    for (int k = 0; k < 3; k++) {
        const int64_t d = (int64_t)c->position[v][k] - c->position[w][k];
        sum += d * d;
    }
    return sum;
}

/* The closest vertices to v that are fit, at most `most` and no farther than a
 * cell's size; ties go to the lower. Returns their number. */
typedef bool fitness(const void *user, uint32_t v, uint32_t w);
static uint32_t closest(const cells *c, uint32_t v, uint32_t most, fitness fit,
                        const void *user,
                        uint32_t out[MOST_PAIRS])
{
    const int32_t *p = c->position[v];
    int64_t far[MOST_PAIRS];
    uint32_t count = 0, looks = 0;
    for (int i = 0; i < 27; i++) {
        const int64_t x = p[0] / c->size + i % 3 - 1,
                      y = p[1] / c->size + i / 3 % 3 - 1,
                      z = p[2] / c->size + i / 9 - 1;
        for (uint32_t w = c->head[slot_of(c, x, y, z)];
             w != ENC_NONE && looks < MOST_LOOKS; w = c->next[w], looks++) {
            const int64_t d = distance_square(c, v, w);
            if (w == v || d > c->size * c->size ||
                (count == most && d >= far[count - 1]) || !fit(user, v, w))
                continue;
            uint32_t at = count < most ? count++ : count - 1;
            for (; at > 0 && far[at - 1] > d; at--) {
                far[at] = far[at - 1];
                out[at] = out[at - 1];
            }
            far[at] = d;
            out[at] = w;
        }
    }
    /* Cells may share a chain: then a vertex was met more than once. */
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool known = false;
        for (uint32_t k = 0; k < kept; k++)
            known |= out[k] == out[i];
        if (!known)
            out[kept++] = out[i];
    }
    return kept;
}

static void append(enc_near *near, uint32_t v, uint32_t w)
{
    if (near->count == near->capacity)
        return;
    near->pair[near->count][0] = v;
    near->pair[near->count++][1] = w;
}

/* ---- by distance --------------------------------------------------------- */

static bool is_higher(const void *user, uint32_t v, uint32_t w)
{
    (void)user;
    return w > v;
}

pmesh_status enc_near_within(const enc_mesh *mesh, double distance,
                             enc_near *out)
{
    const pmesh_allocator *a = &mesh->allocator;
    const double most = (double)(UINT32_C(1) << mesh->grid.bits);
    cells c;
    const bool ready =
        cells_create(a, &c, (const int32_t(*)[3])mesh->position,
                     mesh->vertex_count);
    if (ready)
        cells_fill(&c, (int64_t)(distance < most ? distance : most), NULL);
    for (uint32_t v = 0; ready && v < mesh->vertex_count; v++) {
        uint32_t found[MOST_PAIRS];
        const uint32_t n = closest(&c, v, MOST_PAIRS, is_higher, NULL, found);
        for (uint32_t i = 0; i < n; i++)
            append(out, v, found[i]);
    }
    cells_destroy(a, &c);
    return ready ? PMESH_OK : PMESH_E_MEMORY;
}

/* ---- by sheets ----------------------------------------------------------- */

typedef struct sheets {
    const enc_surface *surface;
    uint32_t *of;    /* per face: its sheet, the lowest of its faces */
    uint32_t *faces; /* per sheet */
} sheets;

static uint32_t find(uint32_t *of, uint32_t f)
{
    while (of[f] != f) {
        of[f] = of[of[f]];
        f = of[f];
    }
    return f;
}

static void find_sheets(sheets *t)
{
    const enc_surface *s = t->surface;
    const uint32_t n = s->mesh->face_count;
    for (uint32_t f = 0; f < n; f++)
        t->of[f] = f;
    for (uint32_t h = 0; h < 3 * n; h++) {
        if (s->vertex[h] == ENC_NONE || s->twin[h] == ENC_NONE)
            continue;
        const uint32_t f = find(t->of, h / 3), g = find(t->of, s->twin[h] / 3);
        t->of[f > g ? f : g] = f > g ? g : f;
    }
    memset(t->faces, 0, n * sizeof *t->faces);
    for (uint32_t f = 0; f < n; f++) {
        t->of[f] = find(t->of, f);
        t->faces[t->of[f]] += s->vertex[3 * f] != ENC_NONE;
    }
}

/* Or so many that it may. */
static bool has_sheet(const sheets *t, uint32_t v, uint32_t sheet)
{
    const enc_surface *s = t->surface;
    uint32_t fans = 0;
    for (uint32_t h = s->first[v]; h != ENC_NONE; h = enc_next_fan(s, h))
        if (t->of[h / 3] == sheet || ++fans > MOST_FANS)
            return true;
    return false;
}

static bool is_foreign(const void *user, uint32_t v, uint32_t w)
{
    const sheets *t = user;
    const enc_surface *s = t->surface;
    uint32_t fans = 0;
    for (uint32_t h = s->first[v]; h != ENC_NONE; h = enc_next_fan(s, h))
        if (has_sheet(t, w, t->of[h / 3]) || ++fans > MOST_FANS)
            return false;
    return true;
}

/* Few neighbours, and these in small sheets: no edge of it can go. */
static bool wants_pair(const sheets *t, uint32_t v)
{
    const enc_surface *s = t->surface;
    uint32_t start = s->first[v], seen[MOST_NEIGHBOURS], count = 0;
    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h)) {
        const uint32_t end[2] = { s->vertex[enc_next(h)],
                                  s->vertex[enc_prev(h)] };
        if (t->faces[t->of[h / 3]] > MOST_FACES)
            return false;
        for (int i = 0; i < 2; i++) {
            uint32_t k = 0;
            while (k < count && seen[k] != end[i])
                k++;
            if (k == MOST_NEIGHBOURS)
                return false;
            if (k == count)
                seen[count++] = end[i];
        }
    }
    return count > 0;
}

/* The vertices that want a pair; returns their number. */
static uint32_t list_small(const sheets *t, uint32_t *list)
{
    uint32_t count = 0;
    for (uint32_t v = 0; v < t->surface->mesh->vertex_count; v++)
        if (wants_pair(t, v))
            list[count++] = v;
    return count;
}

/* Cells grow until every vertex of the list has found one. */
static void pair_sheets(const sheets *t, cells *c, uint32_t *list,
                        enc_near *out)
{
    const int64_t most = (int64_t)2 << t->surface->mesh->grid.bits;
    uint32_t left = list_small(t, list);
    for (int64_t size = 1 + most / 1024; left > 0 && size <= most; size *= 2) {
        uint32_t still = 0;
        cells_fill(c, size, t->surface->first);
        for (uint32_t i = 0; i < left; i++) {
            uint32_t w[MOST_PAIRS];
            if (closest(c, list[i], 1, is_foreign, t, w))
                append(out, list[i], w[0]);
            else
                list[still++] = list[i];
        }
        left = still;
    }
}

pmesh_status enc_near_sheets(const enc_surface *s, enc_near *out)
{
    const pmesh_allocator *a = &s->mesh->allocator;
    const size_t n = s->mesh->vertex_count, f = s->mesh->face_count;
    sheets t = { .surface = s };
    cells c;
    uint32_t *list = pmesh_alloc(a, n, sizeof *list);
    t.of = pmesh_alloc(a, f, sizeof *t.of);
    t.faces = pmesh_alloc(a, f, sizeof *t.faces);
    bool ready = cells_create(a, &c, (const int32_t(*)[3])s->position,
                              s->mesh->vertex_count);
    ready = ready && list && t.of && t.faces;
    if (ready) {
        find_sheets(&t);
        pair_sheets(&t, &c, list, out);
    }
    cells_destroy(a, &c);
    pmesh_release(a, t.faces, f, sizeof *t.faces);
    pmesh_release(a, t.of, f, sizeof *t.of);
    pmesh_release(a, list, n, sizeof *list);
    return ready ? PMESH_OK : PMESH_E_MEMORY;
}
