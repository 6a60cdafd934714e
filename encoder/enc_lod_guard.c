/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_guard.h"

/* A face may turn by up to about 78 degrees: cos^2 of it. */
#define MIN_COSINE_SQUARED 0.04

static bool has(const enc_lod *lod, uint32_t corner, uint32_t v)
{
    return enc_lod_corner_of(lod, corner, v) != ENC_NONE;
}

/* Marks the wings: of u's neighbours, which are surveyed, those that have a
 * face with both. */
static void mark_wings(enc_lod *lod, uint32_t u, uint32_t v)
{
    uint32_t c = lod->first_corner[u];

    do {
        const uint32_t after = enc_lod_after(c), before = enc_lod_before(c);
        if (lod->corner_vertex[after] == v)
            lod->mark[lod->corner_vertex[before]].wing = true;
        else if (lod->corner_vertex[before] == v)
            lod->mark[lod->corner_vertex[after]].wing = true;
    } while ((c = lod->corner_next[c]) != lod->first_corner[u]);
}

bool enc_lod_share_face(const enc_lod *lod, uint32_t u, uint32_t v)
{
    uint32_t c = lod->first_corner[u];

    do
        if (has(lod, c, v))
            return true;
    while ((c = lod->corner_next[c]) != lod->first_corner[u]);
    return false;
}

/* True if a common neighbour of both is no wing. */
static bool has_stranger(const enc_lod *lod, uint32_t v)
{
    uint32_t end = lod->first_end[v];

    do {
        const uint32_t w = lod->end_vertex[end ^ 1];
        const enc_lod_mark *m = enc_lod_marked(lod, w);
        if (m && !m->wing && enc_lod_share_face(lod, v, w))
            return true;
    } while ((end = lod->end_next[end]) != lod->first_end[v]);
    return false;
}

static bool has_face(const enc_lod *lod, uint32_t u, uint32_t a, uint32_t b)
{
    uint32_t c = lod->first_corner[u];

    do
        if (has(lod, c, a) && has(lod, c, b))
            return true;
    while ((c = lod->corner_next[c]) != lod->first_corner[u]);
    return false;
}

/* Faces of v with w; and, of these, those with u. */
static uint32_t faces_with(const enc_lod *lod, uint32_t v, uint32_t w,
                           uint32_t u, uint32_t *shared)
{
    uint32_t c = lod->first_corner[v], count = 0;

    *shared = 0;
    do {
        const bool there = has(lod, c, w);
        count += there;
        *shared += there && has(lod, c, u);
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    return count;
}

/*
 *       a           If u and v both have a face with a and b, the two would
 *      /|\          become one. And if wing w has no face with either but
 *     u-+-v    u-v  those with both, the edge to it would have none left.
 *      \|/      \|
 *       b        w                                                          */
static bool wings_survive(const enc_lod *lod, uint32_t u, uint32_t v)
{
    uint32_t c = lod->first_corner[v];

    do {
        const uint32_t a = lod->corner_vertex[enc_lod_after(c)];
        const uint32_t b = lod->corner_vertex[enc_lod_before(c)];
        const enc_lod_mark *m = enc_lod_marked(lod, a);
        const enc_lod_mark *n = enc_lod_marked(lod, b);

        if (a == u || b == u) {
            const uint32_t w = a == u ? b : a;
            uint32_t shared;
            if (faces_with(lod, v, w, u, &shared) == shared &&
                lod->mark[w].faces == shared)
                return false;
        } else if (m && n && m->wing && n->wing && has_face(lod, u, a, b)) {
            return false;
        }
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    return true;
}

/* True if u and v, which have no edge, have faces that would become one; u is
 * surveyed. */
static bool faces_meet(const enc_lod *lod, uint32_t u, uint32_t v)
{
    uint32_t c = lod->first_corner[v];

    do {
        const uint32_t a = lod->corner_vertex[enc_lod_after(c)];
        const uint32_t b = lod->corner_vertex[enc_lod_before(c)];
        if (enc_lod_marked(lod, a) && enc_lod_marked(lod, b) &&
            has_face(lod, u, a, b))
            return true;
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    return false;
}

/* True if there are faces around neither: some will be left, then. */
static bool has_others(const enc_lod *lod, uint32_t u, uint32_t v)
{
    uint32_t c = lod->first_corner[u], count = 0;

    do
        count += !has(lod, c, v);
    while ((c = lod->corner_next[c]) != lod->first_corner[u]);
    c = lod->first_corner[v];
    do
        count++;
    while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    return lod->faces > count;
}

bool enc_lod_can_join(enc_lod *lod, uint32_t u, uint32_t v,
                      enc_lod_strictness strictness)
{
    const uint8_t lines =
        strictness == ENC_LOD_SEAMS ? ENC_LOD_RIM | ENC_LOD_SEAM : ENC_LOD_RIM;

    if (strictness == ENC_LOD_LOOSE)
        return has_others(lod, u, v);
    enc_lod_survey(lod, u);
    const enc_lod_mark *edge = enc_lod_marked(lod, v);
    if (!edge)
        return !faces_meet(lod, u, v);
    const bool along =
        edge->faces != 2 || (strictness == ENC_LOD_SEAMS && edge->breaks);
    if ((lod->lines[u] & lines) && (lod->lines[v] & lines) && !along)
        return false;
    mark_wings(lod, u, v);
    return !has_stranger(lod, v) && wings_survive(lod, u, v);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool star_flips(const enc_lod *lod, uint32_t v, uint32_t other,
                       const double place[3])
{
    uint32_t c = lod->first_corner[v];

    do {
        double before[3], after[3];
        if (has(lod, c, other))
            continue;
        enc_lod_normal(lod, c, lod->position[v], before);
        enc_lod_normal(lod, c, place, after);
        const double old = dot(before, before), now = dot(after, after);
        const double turn = dot(before, after);
        if (old > 0 &&
            (turn <= 0 || turn * turn < MIN_COSINE_SQUARED * old * now))
            return true;
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    return false;
}

bool enc_lod_flips(const enc_lod *lod, uint32_t u, uint32_t v,
                   const double place[3])
{
    return star_flips(lod, u, v, place) || star_flips(lod, v, u, place);
}
