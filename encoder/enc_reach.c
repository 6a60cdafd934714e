/* SPDX-License-Identifier: MIT */
#include "encoder/enc_reach.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "encoder/enc_bits.h"
#include "encoder/enc_distance.h"
#include "format/alloc.h"

/* One of so many vertices goes first, so that the others soon have enough. */
enum { PIONEERS = 61 };

/* Beside a half-edge that was inherited: nobody looked at its face yet. Numbers
 * of half-edges stay below 2^30 (ENC_MAX_CORNERS). */
#define HEIR UINT32_C(0x40000000)

/* ---- the surface that is searched ---- */

/* A copy of what a search looks at: the surface goes on meanwhile. */
static bool create_copy(const enc_mesh *mesh, enc_surface *copy)
{
    const pmesh_allocator *a = &mesh->allocator;
    const size_t n = mesh->vertex_count, corners = 3 * (size_t)mesh->face_count;

    *copy = (enc_surface){ .mesh = mesh };
    copy->vertex = pmesh_alloc(a, corners, sizeof *copy->vertex);
    copy->twin = pmesh_alloc(a, corners, sizeof *copy->twin);
    copy->first = pmesh_alloc(a, n, sizeof *copy->first);
    copy->position = pmesh_alloc(a, n, sizeof *copy->position);
    copy->changed = pmesh_alloc(a, enc_bit_words(mesh->face_count),
                                sizeof *copy->changed);
    if (mesh->joined)
        copy->fan = pmesh_alloc(a, corners, sizeof *copy->fan);
    return copy->vertex && copy->twin && copy->first && copy->position &&
           copy->changed && (copy->fan || !mesh->joined);
}

static void copy_block(void *user, uint32_t part, unsigned worker)
{
    const enc_reach *r = user;
    const enc_surface *from = r->from, *to = &r->copy;
    const size_t corner = 3 * (size_t)part * ENC_BLOCK;
    const size_t corners = 3 * (size_t)r->mesh->face_count;
    const size_t v = (size_t)part * ENC_BLOCK;

    (void)worker;
    if (corner < corners) {
        const size_t left = corners - corner, block = 3 * (size_t)ENC_BLOCK;
        const size_t size = (left < block ? left : block) * sizeof *to->vertex;
        memcpy(to->vertex + corner, from->vertex + corner, size);
        memcpy(to->twin + corner, from->twin + corner, size);
        if (to->fan)
            memcpy(to->fan + corner, from->fan + corner, size);
    }
    if (v < r->mesh->vertex_count) {
        const size_t count = enc_block_end(r->mesh, part) - v;
        memcpy(to->first + v, from->first + v, count * sizeof *to->first);
        memcpy(to->position + v, from->position + v,
               count * sizeof *to->position);
    }
}

static uint32_t copy_parts(const enc_mesh *mesh)
{
    const uint32_t faces = (mesh->face_count + ENC_BLOCK - 1) / ENC_BLOCK;
    return faces > enc_blocks(mesh) ? faces : enc_blocks(mesh);
}

pmesh_status enc_reach_create(const enc_mesh *mesh, bool later, enc_reach *out)
{
    const pmesh_allocator *a = &mesh->allocator;
    const bool helped = mesh->pool && mesh->vertex_count >= ENC_SHARED_VERTICES;
    bool good = true;

    *out = (enc_reach){ .mesh = mesh, .later = later && helped };
    out->beside = pmesh_alloc(a, mesh->vertex_count, sizeof *out->beside);
    if (helped)
        out->guess = pmesh_alloc(a, mesh->vertex_count, sizeof *out->guess);
    if (out->later)
        good = create_copy(mesh, &out->copy);
    if (!good || !out->beside || (helped && !out->guess)) {
        enc_reach_destroy(out);
        return PMESH_E_MEMORY;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        out->beside[v] = ENC_AT_VERTEX | v;
    return PMESH_OK;
}

void enc_reach_destroy(enc_reach *r)
{
    if (r->mesh) {
        const pmesh_allocator *a = &r->mesh->allocator;
        const uint32_t n = r->mesh->vertex_count;
        pmesh_release(a, r->beside, n, sizeof *r->beside);
        pmesh_release(a, r->guess, n, sizeof *r->guess);
        enc_surface_destroy(&r->copy);
    }
    *r = (enc_reach){ 0 };
}

/* ---- searches ---- */

/* A search. It goes on while `least` is above `enough`, and would have ended as
 * it has if that had been anything below `before`. */
typedef struct search {
    const enc_surface *surface;
    double x[3], enough;
    double least, before; /* squares: the least so far, and the one before */
    uint32_t edge;        /* of the face that is so close */
} search;

static void to_doubles(const int32_t p[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = p[i];
}

static double from_face(const enc_surface *s, uint32_t face, const double x[3])
{
    double corner[3][3];

    for (int k = 0; k < 3; k++)
        to_doubles(s->position[s->vertex[3 * face + (uint32_t)k]], corner[k]);
    return enc_distance_square(x, corner[0], corner[1], corner[2]);
}

/* Looks for a face around v that is closer, until one is close enough; true if
 * there is one, whose half-edge that leaves v is `edge` then. */
static bool look_around(search *look, uint32_t v)
{
    const enc_surface *s = look->surface;
    uint32_t start = s->first[v];
    bool found = false;

    for (uint32_t h = start; h != ENC_NONE && look->least > look->enough;
         h = enc_around(s, &start, h)) {
        const double square = from_face(s, h / 3, look->x);
        if (square < look->least) {
            look->before = look->least;
            look->least = square;
            look->edge = h;
            found = true;
        }
    }
    return found;
}

/* From the faces around v to closer ones around their corners, and so on. */
static void look_for(search *look, uint32_t v)
{
    bool closer = look_around(look, v);

    while (closer && look->least > look->enough) {
        const uint32_t last = look->edge, first = last - last % 3;
        const uint32_t from = look->surface->vertex[last];
        closer = false;
        for (uint32_t h = first; h < first + 3 && look->edge == last; h++) {
            const uint32_t corner = look->surface->vertex[h];
            closer = corner != from && look_around(look, corner);
        }
    }
}

/* From what is beside it; what is so then is returned. As long as a face around
 * a vertex is close enough, it does not matter which. */
static uint32_t look_from(const enc_reach *r, uint32_t vertex, search *look)
{
    const enc_surface *s = r->from;
    uint32_t h = r->beside[vertex];

    *look = (search){ .surface = s, .enough = r->most, .before = INFINITY };
    if (h & ENC_AT_VERTEX)
        h = s->first[h & ~ENC_AT_VERTEX];
    else if (h & HEIR)
        h -= HEIR;
    else if (!enc_bit_get(s->changed, h / 3))
        return h;
    if (h == ENC_NONE)
        return r->beside[vertex];
    to_doubles(r->mesh->position[vertex], look->x);
    look->least = from_face(s, h / 3, look->x);
    if (look->least <= look->enough)
        return h;
    look->least = INFINITY;
    look_for(look, s->vertex[h]);
    return look->edge;
}

static void reach_from(enc_reach *r, uint32_t vertex)
{
    search look;

    r->beside[vertex] = look_from(r, vertex, &look);
    if (look.least > r->most)
        r->most = look.least;
}

/* With the bound as it is now. */
static void guess_block(void *user, uint32_t part, unsigned worker)
{
    const enc_reach *r = user;
    const uint32_t end = enc_block_end(r->mesh, part);
    search look;

    (void)worker;
    for (uint32_t v = part * ENC_BLOCK; v < end; v++) {
        enc_guess *guess = &r->guess[v];
        guess->beside = look_from(r, v, &look);
        /* Rounded down; what is too far is looked at again in any case. */
        guess->below = look.least > r->most
                           ? 0
                           : (float)(look.before * (1 - FLT_EPSILON));
    }
}

/* ---- bounds ---- */

typedef struct descent {
    const enc_reach *reach;
    const enc_schedule *made;
} descent;

static uint32_t survivor(const enc_schedule *made, uint32_t v)
{
    while (made->vertex_end[v] != ENC_NONE)
        v = made->contraction[made->vertex_end[v]].parent;
    return v;
}

/* From what was beside a vertex to what this has become; a half-edge that is
 * alive leaves that already. */
static void descend_block(void *user, uint32_t part, unsigned worker)
{
    const descent *d = user;
    const enc_schedule *made = d->made;
    const enc_surface *s = d->reach->from;
    uint32_t *beside = d->reach->beside;
    const uint32_t end = enc_block_end(d->reach->mesh, part);

    (void)worker;
    for (uint32_t v = part * ENC_BLOCK; v < end; v++) {
        uint32_t h = beside[v];
        while (!(h & ENC_AT_VERTEX) && s->vertex[h] == ENC_NONE)
            h = s->twin[h];
        if (h & ENC_AT_VERTEX)
            h = ENC_AT_VERTEX | survivor(made, h & ~ENC_AT_VERTEX);
        else if (h != beside[v])
            h |= HEIR;
        beside[v] = h;
    }
}

static enc_pool *pool_of(const enc_reach *r)
{
    return r->guess ? r->mesh->pool : NULL;
}

static void start(enc_reach *r, const enc_surface *s, const enc_schedule *made)
{
    descent d = { r, made };

    r->from = s;
    enc_pool_run(pool_of(r), enc_blocks(r->mesh), descend_block, &d);
    for (uint32_t v = 0; v < r->mesh->vertex_count; v += PIONEERS)
        reach_from(r, v);
}

static size_t changed_size(const enc_reach *r)
{
    return enc_bit_words(r->mesh->face_count) * sizeof *r->from->changed;
}

static double settle(enc_reach *r)
{
    for (uint32_t v = 0; v < r->mesh->vertex_count; v++) {
        if (r->guess && r->most < (double)r->guess[v].below)
            r->beside[v] = r->guess[v].beside;
        else
            reach_from(r, v);
    }
    return sqrt(r->most);
}

double enc_reach_bound(enc_reach *r, const enc_surface *s,
                       const enc_schedule *made)
{
    start(r, s, made);
    if (r->guess)
        enc_pool_run(pool_of(r), enc_blocks(r->mesh), guess_block, r);
    const double bound = settle(r);
    memset(s->changed, 0, changed_size(r));
    return bound;
}

void enc_reach_begin(enc_reach *r, const enc_surface *s,
                     const enc_schedule *made)
{
    start(r, s, made);
    enc_pool_run(pool_of(r), copy_parts(r->mesh), copy_block, r);
    memcpy(r->copy.changed, s->changed, changed_size(r));
    memset(s->changed, 0, changed_size(r));
    r->from = &r->copy;
    enc_pool_begin(pool_of(r), enc_blocks(r->mesh), guess_block, r);
}

double enc_reach_end(enc_reach *r)
{
    enc_pool_end(pool_of(r));
    return settle(r);
}

/* From the faces around v that stay, if the ends are both at `place`; but not
 * further than from there. */
static double from_star(const enc_surface *s, const enc_pair *pair, uint32_t v,
                        const double place[3], const double x[3], double least)
{
    uint32_t start = s->first[v];

    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h)) {
        const uint32_t other = v == pair->child ? pair->parent : pair->child;
        const uint32_t a = s->vertex[enc_next(h)], b = s->vertex[enc_prev(h)];
        double p[3], q[3];
        if (a == other || b == other)
            continue;
        to_doubles(s->position[a], p);
        to_doubles(s->position[b], q);
        const double square = enc_distance_square(x, place, p, q);
        least = square < least ? square : least;
    }
    return least;
}

double enc_reach_of_pair(const enc_surface *s, const enc_pair *pair,
                         const int32_t place[3])
{
    const uint32_t end[2] = { pair->child, pair->parent };
    double to[3], most = 0;

    to_doubles(place, to);
    for (int k = 0; k < 2; k++) {
        double x[3];
        to_doubles(s->position[end[k]], x);
        double square = enc_distance_square(x, to, to, to);
        square = from_star(s, pair, pair->child, to, x, square);
        square = from_star(s, pair, pair->parent, to, x, square);
        most = square > most ? square : most;
    }
    return sqrt(most);
}
