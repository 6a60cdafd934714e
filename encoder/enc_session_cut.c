/* SPDX-License-Identifier: MIT */
#include "encoder/enc_session.h"

#include <math.h>
#include <string.h>

#include "format/alloc.h"

size_t pmesh_session_faces(const pmesh_session *s)
{
    return s->alive;
}

void pmesh_session_indices(const pmesh_session *s, uint32_t *out)
{
    for (uint32_t f = 0; f < s->face_count; f++)
        if (s->end[f] == ENC_NOBODY)
            for (uint32_t k = 0; k < 3; k++)
                *out++ = s->vertex[3 * f + k];
}

uint32_t pmesh_session_vertex(const pmesh_session *s, uint32_t v)
{
    while (s->into[v] != ENC_NOBODY)
        v = s->into[v];
    return v;
}

/* About the origin instead of the vertex. */
static void move_to_origin(const enc_quadric *q, const double at[3],
                           double out[10])
{
    enc_quadric sum = { .c = 0 };

    enc_quadric_add(&sum, q, at);
    memcpy(out, sum.a, sizeof sum.a);
    memcpy(out + 6, sum.b, sizeof sum.b);
    out[9] = sum.c;
}

void pmesh_session_look(const pmesh_session *s, uint32_t v,
                        pmesh_session_node *out)
{
    const enc_node *n = &s->node[v];

    memcpy(out->position, n->position, sizeof out->position);
    out->weight = n->weight;
    move_to_origin(&n->quadric, n->position, out->quadric);
    move_to_origin(&n->pull, n->position, out->constraint);
}

/* limit: per vertex, the least threshold of what it is made of so far; below 0
 * once a part was left out. */
static void cut(const pmesh_session *s, double *limit, uint32_t *vertex_of,
                double *positions, size_t *forced)
{
    bool skipped = false;

    for (uint32_t i = 0; i < s->known; i++) {
        const enc_merge *m = &s->merge[i];
        const double least = fmin(limit[m->gone], limit[m->kept]);
        if (!(least >= 0) || !(sqrt(m->error) <= least)) {
            limit[m->kept] = -1;
            skipped = true;
            continue;
        }
        limit[m->kept] = least;
        vertex_of[m->gone] = m->kept;
        *forced += skipped;
        if (positions)
            memcpy(positions + 3 * (size_t)m->kept, m->after.position,
                   sizeof m->after.position);
    }
}

pmesh_status pmesh_session_cut(const pmesh_session *s, const double *thresholds,
                               uint32_t *vertex_of, double *positions,
                               size_t *forced)
{
    const size_t n = s->vertex_count;
    double *limit = pmesh_alloc(&s->allocator, n, sizeof *limit);

    if (!limit)
        return PMESH_E_MEMORY;
    *forced = 0;
    for (uint32_t v = 0; v < n; v++) {
        limit[v] = thresholds[v];
        vertex_of[v] = v;
    }
    if (positions)
        memcpy(positions, s->input, 3 * n * sizeof *positions);
    cut(s, limit, vertex_of, positions, forced);
    for (uint32_t v = 0; v < n; v++)
        while (vertex_of[vertex_of[v]] != vertex_of[v])
            vertex_of[v] = vertex_of[vertex_of[v]];
    pmesh_release(&s->allocator, limit, n, sizeof *limit);
    return PMESH_OK;
}
