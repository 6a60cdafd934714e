/* SPDX-License-Identifier: MIT */
#include "encoder/enc_reach.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "encoder/enc_bits.h"
#include "encoder/enc_distance.h"
#include "encoder/enc_join.h"
#include "format/alloc.h"

/* One of so many vertices goes first, so that the others soon have enough. */
enum { PIONEERS = 61 };

/* Beside a half-edge that was inherited: nobody looked at its face yet. Numbers
 * of half-edges stay below 2^30 (ENC_MAX_CORNERS). */
#define HEIR UINT32_C(0x40000000)

/* ---- set-up ---- */

/* Of what contractions and searches need. */
static bool create_copy(const enc_surface *from, enc_surface *to)
{
    const enc_mesh *mesh = from->mesh;
    const pmesh_allocator *a = &mesh->allocator;
    const size_t n = mesh->vertex_count, corners = 3 * (size_t)mesh->face_count;

    *to = (enc_surface){ .mesh = mesh };
    to->vertex = pmesh_alloc(a, corners, sizeof *to->vertex);
    to->twin = pmesh_alloc(a, corners, sizeof *to->twin);
    to->first = pmesh_alloc(a, n, sizeof *to->first);
    to->degree = pmesh_alloc(a, n, sizeof *to->degree);
    to->position = pmesh_alloc(a, n, sizeof *to->position);
    to->changed = pmesh_alloc_zero(a, enc_bit_words(mesh->face_count),
                                   sizeof *to->changed);
    if (mesh->joined)
        to->fan = pmesh_alloc(a, corners, sizeof *to->fan);
    if (!to->vertex || !to->twin || !to->first || !to->degree ||
        !to->position || !to->changed || (mesh->joined && !to->fan))
        return false;
    memcpy(to->vertex, from->vertex, corners * sizeof *to->vertex);
    memcpy(to->twin, from->twin, corners * sizeof *to->twin);
    memcpy(to->first, from->first, n * sizeof *to->first);
    memcpy(to->degree, from->degree, n * sizeof *to->degree);
    memcpy(to->position, from->position, n * sizeof *to->position);
    if (mesh->joined)
        memcpy(to->fan, from->fan, corners * sizeof *to->fan);
    return true;
}

static void find_later(void *user, uint32_t batch, unsigned worker);

static bool prepare_later(enc_reach *r, const enc_surface *s,
                          const enc_schedule *made)
{
    const pmesh_allocator *a = &r->mesh->allocator;
    const size_t n = r->mesh->vertex_count;

    r->made = *made;
    r->redo = pmesh_alloc(a, n, sizeof *r->redo);
    r->into = pmesh_alloc(a, n, sizeof *r->into);
    if (!create_copy(s, &r->copy) || !r->redo || !r->into)
        return false;
    memset(r->into, 0xff, n * sizeof *r->into);
    r->from = &r->copy;
    enc_pool_aside(r->mesh->pool, find_later, r);
    return true;
}

pmesh_status enc_reach_create(const enc_surface *s, bool later,
                              const enc_schedule *made, enc_reach *out)
{
    const enc_mesh *mesh = s->mesh;
    const pmesh_allocator *a = &mesh->allocator;
    const bool helped = mesh->pool && mesh->vertex_count >= ENC_SHARED_VERTICES;
    bool good = true;

    *out = (enc_reach){ .mesh = mesh, .later = later && helped };
    out->beside = pmesh_alloc(a, mesh->vertex_count, sizeof *out->beside);
    if (out->later)
        good = prepare_later(out, s, made);
    else if (helped)
        good = (out->guess = pmesh_alloc(a, mesh->vertex_count,
                                         sizeof *out->guess)) != NULL;
    if (!good || !out->beside) {
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
        pmesh_release(a, r->redo, n, sizeof *r->redo);
        pmesh_release(a, r->into, n, sizeof *r->into);
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

static uint32_t survivor(const descent *d, uint32_t v)
{
    const uint32_t *into = d->reach->into, *end = d->made->vertex_end;

    if (into)
        while (into[v] != ENC_NONE)
            v = into[v];
    else
        while (end[v] != ENC_NONE)
            v = d->made->contraction[end[v]].parent;
    return v;
}

/* From what was beside a vertex to what this has become; a half-edge that is
 * alive leaves that already. */
static void descend_block(void *user, uint32_t part, unsigned worker)
{
    const descent *d = user;
    const enc_surface *s = d->reach->from;
    uint32_t *beside = d->reach->beside;
    const uint32_t end = enc_block_end(d->reach->mesh, part);

    (void)worker;
    for (uint32_t v = part * ENC_BLOCK; v < end; v++) {
        uint32_t h = beside[v];
        while (!(h & ENC_AT_VERTEX) && s->vertex[h] == ENC_NONE)
            h = s->twin[h];
        if (h & ENC_AT_VERTEX)
            h = ENC_AT_VERTEX | survivor(d, h & ~ENC_AT_VERTEX);
        else if (h != beside[v])
            h |= HEIR;
        beside[v] = h;
    }
}

static enc_pool *pool_of(const enc_reach *r)
{
    return r->guess ? r->mesh->pool : NULL;
}

static void look_ahead(enc_reach *r)
{
    for (uint32_t v = 0; v < r->mesh->vertex_count; v += PIONEERS)
        reach_from(r, v);
}

static void settle_block(enc_reach *r, uint32_t part)
{
    const uint32_t end = enc_block_end(r->mesh, part);

    for (uint32_t v = part * ENC_BLOCK; v < end; v++) {
        if (r->guess && r->most < (double)r->guess[v].below)
            r->beside[v] = r->guess[v].beside;
        else
            reach_from(r, v);
    }
}

static void forget_changes(const enc_surface *s)
{
    memset(s->changed, 0,
           enc_bit_words(s->mesh->face_count) * sizeof *s->changed);
}

double enc_reach_bound(enc_reach *r, const enc_surface *s,
                       const enc_schedule *made)
{
    descent d = { r, made };
    const uint32_t blocks = enc_blocks(r->mesh);

    r->from = s;
    enc_pool_run(pool_of(r), blocks, descend_block, &d);
    look_ahead(r);
    if (r->guess)
        enc_pool_run(pool_of(r), blocks, guess_block, r);
    for (uint32_t i = 0; i < blocks; i++)
        settle_block(r, i);
    forget_changes(s);
    return sqrt(r->most);
}

/* ---- later ---- */

void enc_reach_note(enc_reach *r, uint32_t index, const enc_pair *pair,
                    bool general, const int32_t place[3])
{
    r->redo[index] = (enc_redo){ general ? ENC_NONE : pair->left,
                                 general ? ENC_NONE : pair->right,
                                 { place[0], place[1], place[2] } };
}

static void do_again(enc_reach *r, uint32_t index)
{
    const enc_contraction *c = &r->made.contraction[index];
    const enc_redo *redo = &r->redo[index];
    const enc_pair pair = { c->child, c->parent, redo->left, redo->right };
    enc_link link;

    if (pair.left != ENC_NONE || pair.right != ENC_NONE)
        enc_surface_contract(&r->copy, &pair, redo->place, NULL);
    else if (enc_join_link(&r->copy, c->child, c->parent, &link))
        enc_join_contract(&r->copy, c->child, c->parent, &link, redo->place,
                          NULL);
    r->into[c->child] = c->parent;
}

/* Between blocks others may need help. */
static void find_later(void *user, uint32_t batch, unsigned worker)
{
    enc_reach *r = user;
    const enc_schedule *made = &r->made;
    descent d = { r, made };
    const uint32_t blocks = enc_blocks(r->mesh);

    const uint32_t end = made->batch_first[batch + 1];

    for (uint32_t t = made->batch_first[batch]; t < end; t++) {
        do_again(r, t);
        if (t % (ENC_BLOCK / 4) == 0)
            enc_pool_give_way(r->mesh->pool, worker);
    }
    for (uint32_t i = 0; i < blocks; i++)
        descend_block(&d, i, worker);
    look_ahead(r);
    for (uint32_t i = 0; i < blocks; i++) {
        settle_block(r, i);
        enc_pool_give_way(r->mesh->pool, worker);
    }
    forget_changes(&r->copy);
    made->batch_error[batch] = sqrt(r->most);
}

void enc_reach_later(enc_reach *r)
{
    enc_pool_aside_more(r->mesh->pool);
}

void enc_reach_settle(enc_reach *r)
{
    if (r->later)
        enc_pool_aside_end(r->mesh->pool);
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
