/* SPDX-License-Identifier: MIT */
#include "format/site.h"

/* ---- rings --------------------------------------------------------------- */

/* A closed ring, to the left and to the right of its first half-edge. */
typedef struct walker {
    uint32_t left, right, half;
    pmesh_ring *ring;
} walker;

static void prefetch_face(const pmesh_mesh *m, uint32_t h)
{
    pmesh_prefetch(&m->twin[h]);
    pmesh_prefetch(&m->vertex[h]);
}

/* False if nothing is left to do. */
static bool start(const pmesh_codec *c, uint32_t x, pmesh_ring *ring, walker *w)
{
    const pmesh_mesh *m = &c->mesh;
    const uint32_t first = m->first[x], n = c->near[x].degree;
    if (m->fan || m->twin[first] == PMESH_NONE || n > PMESH_MAX_RING) {
        if (!pmesh_codec_ring(c, x, ring))
            ring->count = 0;
        return false;
    }
    ring->open = false;
    ring->count = ring->face_count = n;
    ring->edge[0] = first;
    *w = (walker){ first, first, n / 2, ring };
    return true;
}

/* The k-th step. */
static void step(const pmesh_mesh *m, walker *w, uint32_t k)
{
    w->right = pmesh_next(m->twin[w->right]);
    w->left = m->twin[pmesh_prev(w->left)];
    w->ring->edge[w->ring->count - k] = w->right;
    w->ring->edge[k] = w->left;
    prefetch_face(m, w->left);
    prefetch_face(m, w->right);
}

static void find_members(const pmesh_codec *c, pmesh_ring *r)
{
    for (uint32_t i = 0; i < r->face_count; i++) {
        const uint32_t x = c->mesh.vertex[pmesh_next(r->edge[i])];
        r->vertex[i] = x;
        pmesh_prefetch(&c->mesh.position[x]);
        pmesh_prefetch(&c->near[x]);
    }
}

void pmesh_sites_rings(const pmesh_codec *c, const uint32_t *x, uint32_t count,
                       pmesh_site *s)
{
    walker walk[PMESH_ABREAST];
    uint32_t walking = 0, most = 0;
    for (uint32_t i = 0; i < count; i++)
        prefetch_face(&c->mesh, c->mesh.first[x[i]]);
    for (uint32_t i = 0; i < count; i++)
        walking += start(c, x[i], &s[i].ring, &walk[walking]);
    for (uint32_t i = 0; i < walking; i++)
        most = most > walk[i].half ? most : walk[i].half;
    for (uint32_t k = 1; k <= most; k++)
        for (uint32_t i = 0; i < walking; i++)
            if (k <= walk[i].half)
                step(&c->mesh, &walk[i], k);
    for (uint32_t i = 0; i < walking; i++)
        find_members(c, walk[i].ring);
}

/* ---- what lies beyond ---------------------------------------------------- */

/* A view over a member: half-edge `now`, the one `before`, turns to go. */
typedef struct view {
    uint32_t now, before, turns, odd;
    uint32_t *beyond;
} view;

static uint32_t index_of(const pmesh_ring *ring, uint32_t vertex)
{
    uint32_t i = 0;
    while (i + 1 < ring->count && ring->vertex[i] != vertex)
        i++;
    return i;
}

/* Over member i of a site; false if nothing is to be seen. */
static bool look(const pmesh_codec *c, const pmesh_ring *ring, uint32_t i,
                 uint32_t beyond[2], view *v)
{
    beyond[0] = beyond[1] = PMESH_NONE;
    if (i >= ring->face_count)
        return false;
    const uint32_t n = c->near[ring->vertex[i]].degree;
    const uint32_t now = c->mesh.twin[ring->edge[i]];
    *v = (view){ now, now, (n + 1) / 2, n % 2, beyond };
    return n <= PMESH_MAX_RING && now != PMESH_NONE;
}

/* One turn; false at the end. */
static bool turn(const pmesh_mesh *m, view *v)
{
    if (v->turns-- == 0) {
        v->beyond[1] = m->vertex[pmesh_next(v->now)];
        v->beyond[0] =
            v->odd ? m->vertex[pmesh_next(v->before)] : v->beyond[1];
        return false;
    }
    v->before = v->now;
    v->now = pmesh_turn_left(m, v->now);
    return v->now != PMESH_NONE;
}

void pmesh_sites_find(const pmesh_codec *c, const uint32_t *x,
                      const uint32_t *partner, uint32_t count, pmesh_site *s)
{
    view all[2 * PMESH_ABREAST];
    uint32_t left = 0;
    pmesh_sites_rings(c, x, count, s);
    for (uint32_t i = 0; i < count; i++) {
        const pmesh_ring *ring = &s[i].ring;
        const uint32_t n = ring->count, near = index_of(ring, partner[i]);
        const uint32_t far = near + n / 2;
        s[i].partner = near;
        if (n == 0)
            continue;
        left += look(c, ring, near, s[i].beyond[0], &all[left]);
        left += look(c, ring, far < n ? far : far - n, s[i].beyond[1],
                     &all[left]);
    }
    while (left > 0)
        for (uint32_t i = 0; i < left;)
            if (turn(&c->mesh, &all[i]))
                i++;
            else
                all[i] = all[--left];
}
