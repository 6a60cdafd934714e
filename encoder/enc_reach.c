/* SPDX-License-Identifier: MIT */
#include "encoder/enc_reach.h"

#include <math.h>

#include "encoder/enc_distance.h"
#include "format/alloc.h"

/* One of so many vertices goes first, so that the others soon have enough. */
enum { PIONEERS = 61 };

pmesh_status enc_reach_create(const enc_mesh *mesh, enc_reach *out)
{
    *out = (enc_reach){ .mesh = mesh };
    out->beside = pmesh_alloc(&mesh->allocator, mesh->vertex_count,
                              sizeof *out->beside);
    if (!out->beside)
        return PMESH_E_MEMORY;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        out->beside[v] = v;
    return PMESH_OK;
}

void enc_reach_destroy(enc_reach *r)
{
    if (r->mesh)
        pmesh_release(&r->mesh->allocator, r->beside, r->mesh->vertex_count,
                      sizeof *r->beside);
    *r = (enc_reach){ 0 };
}

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

/* Looks for a face around v that is closer than *least, until one is close
 * enough; true if there is one, which becomes *face. */
static bool look_around(const enc_surface *s, uint32_t v, const double x[3],
                        double enough, double *least, uint32_t *face)
{
    uint32_t start = s->first[v];
    bool found = false;

    for (uint32_t h = start; h != ENC_NONE && *least > enough;
         h = enc_around(s, &start, h)) {
        const double square = from_face(s, h / 3, x);
        if (square < *least) {
            *least = square;
            *face = h / 3;
            found = true;
        }
    }
    return found;
}

/* From the faces around v to closer ones around their corners, and so on. *v
 * becomes a corner of the last one. */
static double look_for(const enc_surface *s, uint32_t *v, const double x[3],
                       double enough)
{
    double least = INFINITY;
    uint32_t face = 0;
    bool closer = look_around(s, *v, x, enough, &least, &face);

    while (closer && least > enough) {
        const uint32_t *corner = &s->vertex[3 * face];
        const uint32_t from = *v, last = face;
        closer = false;
        for (int k = 0; k < 3 && face == last; k++)
            if (corner[k] != from &&
                look_around(s, corner[k], x, enough, &least, &face)) {
                *v = corner[k];
                closer = true;
            }
    }
    return least;
}

static void look_from(enc_reach *r, const enc_surface *s,
                      const enc_schedule *made, uint32_t vertex)
{
    uint32_t *v = &r->beside[vertex];
    double x[3];

    while (made->vertex_end[*v] != ENC_NONE)
        *v = made->contraction[made->vertex_end[*v]].parent;
    if (s->first[*v] == ENC_NONE)
        return;
    to_doubles(r->mesh->position[vertex], x);
    const double square = look_for(s, v, x, r->most);
    if (square > r->most)
        r->most = square;
}

double enc_reach_bound(enc_reach *r, const enc_surface *s,
                       const enc_schedule *made)
{
    const uint32_t count = r->mesh->vertex_count;

    for (uint32_t v = 0; v < count; v += PIONEERS)
        look_from(r, s, made, v);
    for (uint32_t v = 0; v < count; v++)
        look_from(r, s, made, v);
    return sqrt(r->most);
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
