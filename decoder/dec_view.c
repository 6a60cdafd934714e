/* SPDX-License-Identifier: MIT */
/*
 * dec_view.c - the visible mesh: moves an index buffer up and down among the
 * splits that are decoded.
 */
#include <string.h>

#include "decoder/dec_internal.h"

enum { BUCKETS = 4096 };

/* What was touched, in buckets of equal size; turned into ranges at the end. */
typedef struct touched {
    uint32_t shift;
    uint8_t bits[BUCKETS / 8];
} touched;

static void touched_init(touched *t, uint32_t count)
{
    memset(t, 0, sizeof *t);
    while (count >> t->shift >= BUCKETS)
        t->shift++;
}

static void touch(touched *t, uint32_t item)
{
    const uint32_t b = item >> t->shift;
    t->bits[b >> 3] |= (uint8_t)(1u << (b & 7));
}

static void touch_range(touched *t, uint32_t first, uint32_t end)
{
    const uint32_t step = (uint32_t)1 << t->shift;
    for (uint32_t i = first; i < end; i += step)
        touch(t, i);
    if (end > first)
        touch(t, end - 1);
}

/* Runs of touched buckets below `end`; of too many, the narrowest gaps are
 * closed. */
static uint32_t touched_ranges(const touched *t, uint32_t end,
                               pmesh_range *ranges)
{
    uint32_t count = 0;
    for (uint32_t b = 0; b < BUCKETS; b++) {
        const uint64_t first = (uint64_t)b << t->shift;
        if (first >= end)
            break;
        if (!(t->bits[b >> 3] >> (b & 7) & 1))
            continue;
        uint64_t last = (uint64_t)(b + 1) << t->shift;
        if (last > end)
            last = end;
        if (count > 0 && ranges[count - 1].first + ranges[count - 1].count ==
                             first) {
            ranges[count - 1].count += (uint32_t)(last - first);
            continue;
        }
        if (count == PMESH_MAX_RANGES) {
            uint32_t best = 1;
            uint64_t least = UINT64_MAX;
            for (uint32_t i = 1; i < count; i++) {
                const uint64_t gap = ranges[i].first - ranges[i - 1].first -
                                     ranges[i - 1].count;
                if (gap < least) {
                    least = gap;
                    best = i;
                }
            }
            ranges[best - 1].count =
                ranges[best].first + ranges[best].count - ranges[best - 1].first;
            memmove(ranges + best, ranges + best + 1,
                    (count - best - 1) * sizeof *ranges);
            count--;
        }
        ranges[count++] = (pmesh_range){ (uint32_t)first,
                                         (uint32_t)(last - first) };
    }
    return count;
}

uint64_t dec_view_bind(dec_view *view, const pmesh_header_chunk *h, void *block)
{
    const uint64_t sizes[] = {
        3 * (uint64_t)h->sizes.faces * sizeof(uint32_t),
        ((uint64_t)h->sizes.vertices + 1) * sizeof(uint32_t),
        (uint64_t)h->moved_corners * sizeof(uint32_t),
        h->attribute_count ? (uint64_t)h->moved_corners * sizeof(uint32_t) : 0,
        h->sizes.moves ? 12 * (uint64_t)h->sizes.vertices : 0,
        h->sizes.moves ? 12 * (uint64_t)h->sizes.vertices : 0
    };
    uint64_t at[7] = { 0 };
    for (int i = 0; i < 6; i++)
        at[i + 1] = at[i] + (sizes[i] + 15) / 16 * 16;
    if (!block)
        return at[6];

    uint8_t *base = block;
    *view = (dec_view){ .index = (void *)(base + at[0]),
                        .moved_first = (void *)(base + at[1]),
                        .moved = (void *)(base + at[2]) };
    if (h->attribute_count)
        view->moved_wedge = (void *)(base + at[3]);
    if (h->sizes.moves) {
        view->position = (void *)(base + at[4]);
        view->other = (void *)(base + at[5]);
    }
    return at[6];
}

void dec_view_start(pmesh_decoder *dec)
{
    const pmesh_codec *c = &dec->codec;
    const pmesh_mesh *m = &c->mesh;
    dec_view *view = &dec->view;

    memcpy(view->index, m->wedge ? m->wedge : m->vertex,
           3 * (size_t)m->face_count * sizeof *view->index);
    if (view->position)
        memcpy(view->position, m->position,
               m->vertex_count * sizeof *view->position);
    view->moved_first[m->vertex_count] = 0;
    view->vertices = view->decoded = m->vertex_count;
}

bool dec_view_append(pmesh_decoder *dec)
{
    const pmesh_codec *c = &dec->codec;
    const pmesh_mesh *m = &c->mesh;
    const pmesh_block *b = &c->block;
    dec_view *view = &dec->view;
    uint32_t count = view->moved_first[b->vertex];

    for (uint32_t u = b->vertex; u < b->vertex + b->vertex_count; u++) {
        const uint32_t new_edge = 3 * c->child_face[u - b->vertex];
        for (uint32_t h = new_edge; h < 3 * c->face_end[u]; h++)
            view->index[h] = pmesh_birth_wedge(m, h, u);
        uint32_t start = m->first[u];
        for (uint32_t h = start; h != PMESH_NONE;
             h = pmesh_corner_next(m, &start, h)) {
            if (h >= new_edge)
                continue;
            if (count == dec->header.moved_corners)
                return false;
            view->moved[count] = h;
            if (m->wedge)
                view->moved_wedge[count] = m->wedge[h];
            count++;
        }
        view->moved_first[u + 1] = count;
        if (view->position) {
            memcpy(view->position[u], m->position[u], sizeof *view->position);
            memcpy(view->other[u], m->position[m->parent[u]],
                   sizeof *view->other);
        }
    }
    view->decoded = m->vertex_count;
    return true;
}

uint32_t dec_faces_at(const pmesh_decoder *dec, uint32_t vertices)
{
    return vertices > dec->header.base_vertices
               ? dec->codec.face_end[vertices - 1]
               : dec->header.sizes.base_faces;
}

uint32_t dec_wedges_at(const pmesh_decoder *dec, uint32_t vertices)
{
    if (!dec->codec.wedge_end)
        return vertices;
    return vertices > dec->header.base_vertices
               ? dec->codec.wedge_end[vertices - 1]
               : dec->header.base_wedges;
}

static void swap_parent(dec_view *view, uint32_t u, uint32_t v)
{
    int32_t keep[3];
    memcpy(keep, view->position[v], sizeof keep);
    memcpy(view->position[v], view->other[u], sizeof keep);
    memcpy(view->other[u], keep, sizeof keep);
}

static void show(pmesh_decoder *dec, uint32_t u)
{
    dec_view *view = &dec->view;
    for (uint32_t i = view->moved_first[u]; i < view->moved_first[u + 1]; i++)
        view->index[view->moved[i]] =
            view->moved_wedge ? view->moved_wedge[i] : u;
    if (view->position)
        swap_parent(view, u, dec->codec.mesh.parent[u]);
}

static void hide(pmesh_decoder *dec, uint32_t u)
{
    const pmesh_mesh *m = &dec->codec.mesh;
    dec_view *view = &dec->view;
    for (uint32_t i = view->moved_first[u]; i < view->moved_first[u + 1]; i++)
        view->index[view->moved[i]] =
            view->moved_wedge ? m->wedge_parent[view->moved_wedge[i]]
                              : m->parent[u];
    if (view->position)
        swap_parent(view, u, m->parent[u]);
}

static void note_split(pmesh_decoder *dec, uint32_t u, touched *faces,
                       touched *vertices)
{
    const dec_view *view = &dec->view;
    for (uint32_t i = view->moved_first[u]; i < view->moved_first[u + 1]; i++)
        touch(faces, view->moved[i] / 3);
    if (view->position) /* without attributes: output and mesh vertex agree */
        touch(vertices, dec->codec.mesh.parent[u]);
}

/* With attributes a moved mesh vertex may have several output vertices. */
static void note_moved_wedges(pmesh_decoder *dec, const touched *moved,
                              uint32_t wedges, touched *vertices)
{
    const uint32_t *vertex = dec->codec.mesh.wedge_vertex;
    for (uint32_t w = 0; w < wedges; w++) {
        const uint32_t b = vertex[w] >> moved->shift;
        if (moved->bits[b >> 3] >> (b & 7) & 1)
            touch(vertices, w);
    }
}

void dec_view_move(pmesh_decoder *dec, uint32_t target, pmesh_changes *changes)
{
    dec_view *view = &dec->view;
    const uint32_t from = view->vertices;
    const uint32_t faces = dec_faces_at(dec, target);
    const uint32_t wedges = dec_wedges_at(dec, target);
    touched f, v, moved;
    if (changes) {
        touched_init(&f, dec->header.sizes.faces);
        touched_init(&v, dec->header.sizes.wedges);
        touched_init(&moved, dec->header.sizes.vertices);
        touch_range(&f, dec_faces_at(dec, from), faces);
        touch_range(&v, dec_wedges_at(dec, from), wedges);
    }
    for (; view->vertices < target; view->vertices++) {
        show(dec, view->vertices);
        if (changes)
            note_split(dec, view->vertices, &f, &moved);
    }
    for (; view->vertices > target; view->vertices--) {
        hide(dec, view->vertices - 1);
        if (changes)
            note_split(dec, view->vertices - 1, &f, &moved);
    }
    if (!changes)
        return;
    if (view->position && dec->codec.mesh.wedge)
        note_moved_wedges(dec, &moved, wedges, &v);
    else if (view->position)
        for (uint32_t i = 0; i < BUCKETS / 8; i++)
            v.bits[i] |= moved.bits[i];
    changes->face_range_count = touched_ranges(&f, faces, changes->faces);
    changes->vertex_range_count =
        touched_ranges(&v, wedges, changes->vertices);
}
