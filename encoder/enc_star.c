/* SPDX-License-Identifier: MIT */
#include "encoder/enc_star.h"

#include <math.h>
#include <string.h>

/* Weights of the planes across a face, per squared length of the edge. */
#define BOUNDARY_WEIGHT 10.0
#define BORDER_WEIGHT   3.0

/* A vertex with more seams and borders than this is faceted, not on a line,
 * and is not held. */
#define MAX_LINES 4

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void difference(const int32_t a[3], const int32_t b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (double)(a[i] - b[i]);
}

/* True if attributes or materials break along the half-edge h. */
static bool on_border(const enc_surface *s, uint32_t h)
{
    const uint32_t t = s->twin[h];
    const uint32_t *material = s->mesh->material;

    if (material && material[h / 3] != material[t / 3])
        return true;
    return s->wedge && (s->wedge[h] != s->wedge[enc_next(t)] ||
                        s->wedge[enc_next(h)] != s->wedge[t]);
}

static bool on_lines(const enc_surface *s, uint32_t v)
{
    uint32_t start = s->first[v];
    unsigned lines = 0;

    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h))
        lines += s->twin[h] != ENC_NONE && on_border(s, h);
    return lines > 0 && lines <= MAX_LINES;
}

/* The plane through the edge of h that stands upright on its face. */
static void hold_edge(const enc_surface *s, uint32_t h, double weight,
                      enc_quadric *q)
{
    const int32_t *from = s->position[s->vertex[h]];
    double normal[3], along[3];

    enc_surface_normal(s, h, from, normal);
    difference(s->position[s->vertex[enc_next(h)]], from, along);
    const double upright[3] = { along[1] * normal[2] - along[2] * normal[1],
                                along[2] * normal[0] - along[0] * normal[2],
                                along[0] * normal[1] - along[1] * normal[0] };
    if (dot(upright, upright) > 0)
        enc_quadric_add_plane(q, upright, weight * dot(along, along));
}

static void add_plane(const double normal[3], enc_quadric *q)
{
    const double square = dot(normal, normal);
    if (square > 0)
        enc_quadric_add_plane(q, normal, 0.5 * sqrt(square));
}

static void add_volume(const enc_surface *s, uint32_t h, const double normal[3],
                       const enc_star_keep *keep)
{
    if (s->vertex[enc_next(h)] == keep->other ||
        s->vertex[enc_prev(h)] == keep->other)
        return;
    for (int i = 0; i < 3; i++)
        keep->plane->n[i] += normal[i];
    keep->plane->offset += dot(normal, keep->offset);
}

/* Seams and borders that meet at v. */
static void add_lines(const enc_surface *s, uint32_t v, enc_quadric *q)
{
    if (!(s->wedge || s->mesh->material) || !on_lines(s, v))
        return;
    uint32_t start = s->first[v];
    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h)) {
        const uint32_t t = s->twin[h];
        if (t != ENC_NONE && on_border(s, h)) {
            hold_edge(s, h, BORDER_WEIGHT, q);
            hold_edge(s, t, BORDER_WEIGHT, q);
        }
    }
}

static void add_fan(const enc_surface *s, uint32_t start, enc_quadric *q,
                    const enc_star_keep *keep)
{
    const int32_t *at = s->position[s->vertex[start]];
    uint32_t h = start, last;

    do {
        double normal[3];
        enc_surface_normal(s, h, at, normal);
        add_plane(normal, q);
        if (keep)
            add_volume(s, h, normal, keep);
        last = enc_prev(h);
        h = s->twin[last];
    } while (h != ENC_NONE && h != start);
    if (h == ENC_NONE) {
        hold_edge(s, start, BOUNDARY_WEIGHT, q);
        hold_edge(s, last, BOUNDARY_WEIGHT, q);
    }
}

void enc_star_quadric(const enc_surface *s, uint32_t v, enc_quadric *q,
                      const enc_star_keep *keep)
{
    memset(q, 0, sizeof *q);
    for (uint32_t fan = s->first[v]; fan != ENC_NONE;
         fan = enc_next_fan(s, fan))
        add_fan(s, fan, q, keep);
    add_lines(s, v, q);
}

static void add_planes(const enc_quadric *q, enc_planes *sum)
{
    for (int i = 0; i < 6; i++)
        sum->a[i] += q->a[i];
    sum->weight += q->weight;
}

/* Each face is computed once and added to its corners. */
void enc_star_all_planes(const enc_surface *s, enc_planes *planes)
{
    memset(planes, 0, s->mesh->vertex_count * sizeof *planes);
    for (uint32_t f = 0; f < s->mesh->face_count; f++) {
        const uint32_t *corner = &s->vertex[3 * f];
        enc_quadric face = { .c = 0 };
        double normal[3];

        if (corner[0] == ENC_NONE)
            continue;
        enc_surface_normal(s, 3 * f, s->position[corner[0]], normal);
        add_plane(normal, &face);
        for (unsigned k = 0; k < 3; k++) {
            add_planes(&face, &planes[corner[k]]);
            if (s->twin[3 * f + k] == ENC_NONE) {
                enc_quadric edge = { .c = 0 };
                hold_edge(s, 3 * f + k, BOUNDARY_WEIGHT, &edge);
                add_planes(&edge, &planes[corner[k]]);
                add_planes(&edge, &planes[corner[(k + 1) % 3]]);
            }
        }
    }
    if (!s->wedge && !s->mesh->material)
        return;
    for (uint32_t v = 0; v < s->mesh->vertex_count; v++) {
        enc_quadric lines = { .c = 0 };
        if (s->first[v] == ENC_NONE)
            continue;
        add_lines(s, v, &lines);
        add_planes(&lines, &planes[v]);
    }
}

/* One neighbour of v: returns the squared length of their edge. */
static double survey_edge(const enc_surface *s, uint32_t v, uint32_t neighbour,
                          double sum[3], enc_survey *out)
{
    double d[3];

    difference(s->position[neighbour], s->position[v], d);
    for (int i = 0; i < 3; i++)
        sum[i] += d[i];
    enc_sign_add(&out->sign, neighbour);
    return dot(d, d);
}

/* Returns the number of neighbours; their sum, as seen from v, goes to sum. */
static uint32_t survey_fan(const enc_surface *s, uint32_t start, uint32_t v,
                           double sum[3], enc_survey *out)
{
    uint32_t h = start, last, count = 0;

    do {
        out->length += survey_edge(s, v, s->vertex[enc_next(h)], sum, out);
        out->edges += h < s->twin[h];
        count++;
        last = enc_prev(h);
        h = s->twin[last];
    } while (h != ENC_NONE && h != start);
    if (h == ENC_NONE) {
        survey_edge(s, v, s->vertex[last], sum, out);
        count++;
    }
    return count;
}

void enc_star_survey(const enc_surface *s, uint32_t v, enc_survey *out)
{
    double sum[3] = { 0, 0, 0 };
    uint32_t count = 0;

    *out = (enc_survey){ .edges = 0 };
    for (uint32_t fan = s->first[v]; fan != ENC_NONE;
         fan = enc_next_fan(s, fan))
        count += survey_fan(s, fan, v, sum, out);
    out->unevenness = dot(sum, sum) / ((double)count * count);
}

void enc_star_volume(const enc_surface *s, uint32_t v,
                     const enc_star_keep *keep)
{
    uint32_t start = s->first[v];
    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h)) {
        double normal[3];
        enc_surface_normal(s, h, s->position[v], normal);
        add_volume(s, h, normal, keep);
    }
}
