/* SPDX-License-Identifier: MIT */
#include "tools/farthest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_DEPTH 20
#define GOOD_ENOUGH (1.005 * 1.005)

/* A point of `from` and the face of `to` closest to it. */
typedef struct spot {
    double p[3];
    uint32_t face;
} spot;

/* A part of a face of `from`. */
typedef struct patch {
    spot corners[3];
    int depth;
} patch;

typedef struct search {
    const surface *from, *to;
    double max2;
    double tiny2;
    size_t budget;
} search;

static void project(search *s, spot *at)
{
    const double d2 = surface_closest(s->to, at->p, &at->face);
    s->max2 = fmax(s->max2, d2);
}

/*
 * The distance from one face is a convex function, hence largest at a corner
 * of the patch; the distance from the surface is nowhere larger. The closest
 * faces of the three corners give three such bounds.
 */
static double bound2(const search *s, const patch *part)
{
    double least = HUGE_VAL;
    for (size_t k = 0; k < 3; k++) {
        double most = 0;
        for (size_t j = 0; j < 3; j++)
            most = fmax(most, surface_face_distance2(s->to,
                                                     part->corners[k].face,
                                                     part->corners[j].p));
        least = fmin(least, most);
    }
    return least;
}

static bool may_be_farther(const search *s, const patch *part)
{
    return bound2(s, part) > s->max2 * GOOD_ENOUGH + s->tiny2;
}

/*        2
 *       / \          Cuts a patch at the middles of its sides; m[k] lies
 *     m1---m0        opposite of corner k.
 *     / \ / \
 *    0---m2--1                                                             */
static void quarter(search *s, const patch *part, patch out[4])
{
    const spot *c = part->corners;
    spot m[3];

    for (size_t k = 0; k < 3; k++) {
        const spot *a = &c[(k + 1) % 3];
        const spot *b = &c[(k + 2) % 3];
        for (size_t i = 0; i < 3; i++)
            m[k].p[i] = (a->p[i] + b->p[i]) / 2;
        m[k].face = a->face;
        project(s, &m[k]);
    }
    out[0] = (patch){ { c[0], m[2], m[1] }, part->depth + 1 };
    out[1] = (patch){ { m[2], c[1], m[0] }, part->depth + 1 };
    out[2] = (patch){ { m[1], m[0], c[2] }, part->depth + 1 };
    out[3] = (patch){ { m[0], m[1], m[2] }, part->depth + 1 };
}

static void search_face(search *s, const patch *whole)
{
    patch stack[3 * MAX_DEPTH + 4];
    size_t count = 0;

    stack[count++] = *whole;
    while (count > 0) {
        const patch part = stack[--count];
        if (part.depth == MAX_DEPTH || s->budget < 3 ||
            !may_be_farther(s, &part))
            continue;
        s->budget -= 3;
        quarter(s, &part, stack + count);
        count += 4;
    }
}

static void project_vertices(search *s, uint32_t *closest)
{
    /* In the order of the faces: neighbours give each other good hints. */
    uint32_t hint = 0;
    for (size_t c = 0; c < 3 * s->from->face_count; c++) {
        const size_t v = s->from->corners[c];
        if (closest[v] != UINT32_MAX)
            continue;
        spot at = { .face = hint };
        memcpy(at.p, s->from->points + 3 * v, sizeof at.p);
        project(s, &at);
        closest[v] = hint = at.face;
    }
}

bool farthest_from(const surface *from, const surface *to, size_t budget,
                   double *max2)
{
    search s = { .from = from, .to = to, .max2 = *max2, .budget = budget };
    const double tiny = 1e-9 * to->diagonal;
    s.tiny2 = tiny * tiny;

    const size_t size = from->point_count * sizeof(uint32_t);
    uint32_t *closest = malloc(size + 1);
    if (!closest)
        return false;
    memset(closest, 0xff, size);
    project_vertices(&s, closest);
    for (size_t f = 0; f < from->face_count; f++) {
        patch whole = { .depth = 0 };
        for (size_t k = 0; k < 3; k++) {
            const size_t v = from->corners[3 * f + k];
            memcpy(whole.corners[k].p, from->points + 3 * v,
                   sizeof whole.corners[k].p);
            whole.corners[k].face = closest[v];
        }
        search_face(&s, &whole);
    }
    free(closest);
    *max2 = s.max2;
    return true;
}
