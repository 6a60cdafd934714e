/* SPDX-License-Identifier: MIT */
/*
 * enc_part.c - the replay of a joined mesh: which fans a split cuts, and where.
 *
 * Which face lies across which is not told by the names of vertices here. It is
 * found in the import's twins: a face that is not there (yet) had two sides,
 * its third being contracted, and these are glued together.
 */
#include <string.h>

#include "encoder/enc_replay.h"
#include "format/alloc.h"

static uint32_t next_corner(uint32_t c)
{
    return c % 3 == 2 ? c - 2 : c + 1;
}

static uint32_t previous_corner(uint32_t c)
{
    return c % 3 == 0 ? c + 2 : c - 1;
}

bool enc_part_allocate(enc_replay *r)
{
    const pmesh_allocator *a = &r->allocator;
    const size_t faces = r->mesh->face_count;
    r->removed_first =
        pmesh_alloc(a, (size_t)r->schedule->contraction_count + 1, 4);
    r->removed_list = pmesh_alloc(a, faces, 4);
    r->face_of = pmesh_alloc(a, faces, 4);
    return r->removed_first && r->removed_list && r->face_of;
}

void enc_part_release(enc_replay *r)
{
    const pmesh_allocator *a = &r->allocator;
    const size_t faces = r->mesh->face_count;
    pmesh_release(a, r->removed_first,
                  (size_t)r->schedule->contraction_count + 1, 4);
    pmesh_release(a, r->removed_list, faces, 4);
    pmesh_release(a, r->face_of, faces, 4);
}

/* A counting sort of the faces by the contraction that removes them. */
void enc_part_fill(enc_replay *r)
{
    const enc_schedule *s = r->schedule;
    const uint32_t faces = r->mesh->face_count, n = s->contraction_count;
    uint32_t *first = r->removed_first, sum = 0;
    memset(first, 0, ((size_t)n + 1) * sizeof *first);
    memset(r->face_of, 0xff, faces * sizeof *r->face_of);
    for (uint32_t f = 0; f < faces; f++)
        if (s->face_end[f] != ENC_NONE)
            first[s->face_end[f]]++;
    for (uint32_t t = 0; t <= n; t++) {
        sum += first[t];
        first[t] = sum;
    }
    for (uint32_t f = faces; f-- > 0;)
        if (s->face_end[f] != ENC_NONE)
            r->removed_list[--first[s->face_end[f]]] = f;
}

void enc_part_number(enc_replay *r, uint32_t face, uint32_t count)
{
    for (uint32_t f = face; f < face + count; f++)
        r->face_of[r->corner_of[3 * f] / 3] = f;
}

uint32_t enc_part_twin(const enc_replay *r, uint32_t h)
{
    const uint32_t *twin = r->mesh->twin;
    uint32_t t = twin[h];
    while (t != ENC_NONE && t / 3 != h / 3 &&
           r->face_of[t / 3] == ENC_NONE) {
        const uint32_t side = 3 * (t / 3) + r->schedule->face_side[t / 3];
        t = twin[t == next_corner(side) ? previous_corner(side)
                                        : next_corner(side)];
    }
    return t;
}

/* Where a face of the import lies around v: its fan, and its place there. */
static bool find_face(const enc_replay *r, const pmesh_fans *fans, uint32_t h,
                      uint32_t *fan, uint32_t *place)
{
    if (h == ENC_NONE)
        return false;
    const uint32_t face = r->face_of[h / 3];
    for (uint32_t i = 0; i < fans->count; i++)
        for (uint32_t k = 0; k < fans->ring[i].face_count; k++)
            if (fans->ring[i].edge[k] / 3 == face) {
                *fan = i;
                *place = k;
                return true;
            }
    return false;
}

/* A face that the split makes, with v at corner c of the import: in a fan, at
 * one of its wings; or alone. */
typedef struct piece {
    uint32_t corner;
    bool child_first; /* v -> u -> wing: at wing b */
    bool alone;
    bool paired;        /* and with another such on all sides */
    uint32_t fan, wing; /* ring position */
} piece;

/* Across the two sides at the wing lie its faces before and behind. */
static piece place_piece(const enc_replay *r, const enc_contraction *t,
                         uint32_t face, const pmesh_fans *fans)
{
    piece p = { .corner = 3 * face };
    uint32_t place = 0;
    while (enc_replay_label_at(r, p.corner) != t->parent)
        p.corner = next_corner(p.corner);
    const uint32_t middle = next_corner(p.corner);
    const uint32_t last = next_corner(middle);
    p.child_first = enc_replay_label_at(r, middle) == t->child;
    const uint32_t before = p.child_first ? middle : p.corner;
    const uint32_t behind = p.child_first ? last : middle;
    const uint32_t across = enc_part_twin(r, behind);
    if (find_face(r, fans, across, &p.fan, &p.wing))
        return p;
    p.paired = across != ENC_NONE && across / 3 == face;
    p.alone = !find_face(r, fans, enc_part_twin(r, before), &p.fan, &place);
    if (!p.alone) {
        const pmesh_ring *ring = &fans->ring[p.fan];
        p.wing = place + 1 == ring->count ? 0 : place + 1;
    }
    return p;
}

/* The vertex of the codec that an import's vertex is, or still is part of. */
static uint32_t vertex_now(const enc_replay *r, uint32_t v)
{
    const enc_schedule *s = r->schedule;
    while (r->born[v] == ENC_NONE)
        v = s->contraction[s->vertex_end[v]].parent;
    return r->born[v];
}

/* (v, u, third), or (u, v, third) from u on, or one after the other. */
static void add_lone(enc_replay *r, const piece *p, pmesh_parting *out)
{
    const uint32_t middle = next_corner(p->corner);
    const uint32_t third = p->child_first ? next_corner(middle) : middle;
    r->part_corner[r->part_count++] =
        p->child_first ? p->corner : previous_corner(p->corner);
    if (p->paired && !p->child_first)
        return;
    const uint32_t i = out->lone_count++;
    out->third[i] = vertex_now(r, enc_replay_label_at(r, third));
    out->lone[i] = p->paired        ? PMESH_LONE_PAIR
                   : p->child_first ? PMESH_LONE_FACE
                                    : PMESH_LONE_TURNED;
}

/* Of a pair, of which there is at most one, (v, u, third) comes first. */
static void add_all_lone(enc_replay *r, const piece *pieces, uint32_t count,
                         pmesh_parting *out)
{
    for (uint32_t i = 0; i < count; i++)
        if (pieces[i].alone && !pieces[i].paired)
            add_lone(r, &pieces[i], out);
    for (int turned = 0; turned < 2; turned++)
        for (uint32_t i = 0; i < count; i++)
            if (pieces[i].paired && pieces[i].child_first == !turned)
                add_lone(r, &pieces[i], out);
}

/* The pieces of fan i, wing a before wing b. */
static bool cut_fan(enc_replay *r, const piece *pieces, uint32_t count,
                    uint32_t i, pmesh_cut *cut)
{
    bool any = false;
    *cut = (pmesh_cut){ PMESH_NONE, PMESH_NONE };
    for (int b = 0; b < 2; b++)
        for (uint32_t k = 0; k < count; k++) {
            if (pieces[k].alone || pieces[k].fan != i ||
                pieces[k].child_first != (b != 0))
                continue;
            *(b ? &cut->end : &cut->first) = pieces[k].wing;
            r->part_corner[r->part_count++] = pieces[k].corner;
            any = true;
        }
    return any;
}

void enc_part_answer(enc_replay *r, const enc_contraction *t, uint32_t v,
                     const pmesh_fans *fans, pmesh_parting *out)
{
    enum { MOST = sizeof r->part_corner / sizeof *r->part_corner };
    const uint32_t index = (uint32_t)(t - r->schedule->contraction);
    const uint32_t *face = r->removed_list + r->removed_first[index];
    const uint32_t count =
        r->removed_first[index + 1] - r->removed_first[index];
    piece pieces[MOST];
    (void)v;
    r->part_count = 0;
    for (uint32_t i = 0; i < count && i < MOST; i++)
        pieces[i] = place_piece(r, t, face[i], fans);
    for (uint32_t i = 0; i < fans->count; i++) {
        const pmesh_ring *ring = &fans->ring[i];
        uint32_t childs = 0;
        for (uint32_t k = 0; k < ring->face_count; k++)
            childs += enc_replay_label_at(r, r->corner_of[ring->edge[k]]) ==
                      t->child;
        if (cut_fan(r, pieces, count, i, &out->cut[i])) {
            out->way[i] = PMESH_FAN_CUT;
            r->lost |= !pmesh_cut_legal(ring, out->cut[i]);
        } else {
            out->way[i] = childs ? PMESH_FAN_MOVES : PMESH_FAN_STAYS;
            r->lost |= childs != 0 && childs != ring->face_count;
        }
    }
    add_all_lone(r, pieces, count, out);
    r->lost |= r->part_count != count;
}
