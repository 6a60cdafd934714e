/* SPDX-License-Identifier: MIT */
/* SPEC 3: half-edges, turns, rings; and what makes a mesh grow. */
#include "tests/reference/ref.h"

uint32_t ref_next(uint32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}

uint32_t ref_prev(uint32_t h)
{
    return h % 3 == 0 ? h + 2 : h - 1;
}

uint32_t ref_left(const ref *r, uint32_t h)
{
    return r->edge[ref_prev(h)].twin;
}

uint32_t ref_start_of(const ref *r, uint32_t h)
{
    return r->edge[h].vertex;
}

uint32_t ref_end_of(const ref *r, uint32_t h)
{
    return r->edge[ref_next(h)].vertex;
}

/* ---- fans --------------------------------------------------------------- */

uint32_t ref_fan(const ref *r, uint32_t v, int i)
{
    const ref_vertex *x = &r->vertex[v];
    if (i == 0)
        return x->first;
    return i <= x->more ? x->later[i - 1] : REF_NONE;
}

bool ref_add_fan(ref *r, uint32_t v, uint32_t start)
{
    ref_vertex *x = &r->vertex[v];
    if (x->first == REF_NONE) {
        x->first = start;
        return true;
    }
    if (x->more == REF_FANS - 1)
        return false;
    x->later[x->more++] = start;
    return true;
}

void ref_restart(ref *r, uint32_t v, uint32_t old, uint32_t now)
{
    ref_vertex *x = &r->vertex[v];
    if (x->first == old)
        x->first = now;
    for (int i = 0; i < x->more; i++)
        if (x->later[i] == old)
            x->later[i] = now;
}

ref_walk ref_walk_at(const ref *r, uint32_t v)
{
    const uint32_t first = r->vertex[v].first;
    return (ref_walk){ v, first, first, 0 };
}

void ref_walk_on(const ref *r, ref_walk *w)
{
    w->h = ref_left(r, w->h);
    if (w->h == REF_NONE || w->h == w->start)
        w->h = w->start = ref_fan(r, w->v, ++w->fan);
}

/* ---- rings -------------------------------------------------------------- */

ref_ring ref_ring_of(const ref *r, uint32_t v)
{
    return ref_ring_from(r, r->vertex[v].first);
}

/* Stops behind the first member too many. */
ref_ring ref_ring_from(const ref *r, uint32_t first)
{
    ref_ring ring = { 0 };
    uint32_t h = first;
    do {
        ring.edge[ring.faces++] = h;
        ring.vertex[ring.count++] = ref_end_of(r, h);
        const uint32_t left = ref_left(r, h);
        if (left == REF_NONE) {
            ring.open = true;
            ring.vertex[ring.count++] = ref_start_of(r, ref_prev(h));
            break;
        }
        h = left;
    } while (h != first && ring.count <= REF_MEMBERS);
    ring.large = ring.count + ring.open > REF_MEMBERS;
    return ring;
}

uint32_t ref_degree(const ref *r, uint32_t v)
{
    uint32_t n = 0;
    for (ref_walk w = ref_walk_at(r, v); w.h != REF_NONE; ref_walk_on(r, &w))
        n += ref_left(r, w.h) == REF_NONE ? 2 : 1;
    return n;
}

uint32_t ref_new_vertex(ref *r)
{
    const size_t count = r->vertex_count + (size_t)1;
    r->vertex =
        ref_grow(r, r->vertex, &r->vertex_room, count, sizeof *r->vertex);
    r->vertex[r->vertex_count] =
        (ref_vertex){ .first = REF_NONE, .parent = REF_NONE };
    return r->vertex_count++;
}

uint32_t ref_new_face(ref *r, uint32_t a, uint32_t b, uint32_t c)
{
    const size_t count = r->face_count + (size_t)1;
    size_t room = r->face_room;
    r->material = ref_grow(r, r->material, &room, count, sizeof *r->material);
    r->edge = ref_grow(r, r->edge, &r->face_room, count, 3 * sizeof *r->edge);
    ref_edge *e = &r->edge[3 * (size_t)r->face_count];
    e[0] = (ref_edge){ a, REF_NONE, REF_NONE };
    e[1] = (ref_edge){ b, REF_NONE, REF_NONE };
    e[2] = (ref_edge){ c, REF_NONE, REF_NONE };
    r->material[r->face_count] = 0;
    return r->face_count++;
}

uint32_t ref_new_wedge(ref *r, uint32_t corner)
{
    const size_t count = r->wedge_count + (size_t)1;
    r->wedge = ref_grow(r, r->wedge, &r->wedge_room, count, sizeof *r->wedge);
    r->wedge[r->wedge_count] = (ref_wedge){
        .from = REF_NONE, .corner = corner, .vertex = r->edge[corner].vertex
    };
    r->edge[corner].wedge = r->wedge_count;
    return r->wedge_count++;
}

void ref_join(ref *r, uint32_t g, uint32_t h)
{
    if (g != REF_NONE)
        r->edge[g].twin = h;
    if (h != REF_NONE)
        r->edge[h].twin = g;
}
