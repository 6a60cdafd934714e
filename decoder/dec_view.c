/* SPDX-License-Identifier: MIT */
/*
 * dec_view.c - the visible mesh: moves an index buffer up and down among the
 * splits that are decoded.
 */
#include <string.h>

#include "decoder/dec_internal.h"

/* Half-edges of this mesh have more than 24 bits. */
static bool is_large(const pmesh_header_chunk *h)
{
    return h->sizes.faces > (1u << 24) / 3;
}

uint64_t dec_view_bind(dec_view *view, const pmesh_header_chunk *h, void *block)
{
    const uint64_t vertices = h->sizes.vertices, moved = h->moved_corners;
    const uint64_t sizes[] = { vertices,
                               moved * sizeof *view->moved_low,
                               moved,
                               is_large(h) ? moved : 0,
                               h->attribute_count
                                   ? moved * sizeof *view->moved_wedge
                                   : 0,
                               h->sizes.moves ? 12 * vertices : 0,
                               h->sizes.moves ? 12 * vertices : 0 };
    enum { PARTS = sizeof sizes / sizeof *sizes };
    uint64_t at[PARTS + 1] = { 0 };
    for (int i = 0; i < PARTS; i++)
        at[i + 1] = at[i] + (sizes[i] + 15) / 16 * 16;
    if (!block)
        return at[PARTS];

    uint8_t *base = (uint8_t *)block;
    *view = (dec_view){ .moved_count = base + at[0],
                        .moved_low = (void *)(base + at[1]),
                        .moved_high = base + at[2] };
    if (is_large(h))
        view->moved_highest = base + at[3];
    if (h->attribute_count)
        view->moved_wedge = (void *)(base + at[4]);
    if (h->sizes.moves) {
        view->position = (void *)(base + at[5]);
        view->other = (void *)(base + at[6]);
    }
    return at[PARTS];
}

static inline uint32_t moved_edge(const dec_view *view, uint32_t i)
{
    uint32_t h = view->moved_low[i] | (uint32_t)view->moved_high[i] << 16;
    if (view->moved_highest)
        h |= (uint32_t)view->moved_highest[i] << 24;
    return h;
}

static void set_moved_edge(dec_view *view, uint32_t i, uint32_t h)
{
    view->moved_low[i] = (uint16_t)h;
    view->moved_high[i] = (uint8_t)(h >> 16);
    if (view->moved_highest)
        view->moved_highest[i] = (uint8_t)(h >> 24);
}

void dec_view_start(pmesh_decoder *dec)
{
    const pmesh_codec *c = &dec->codec;
    const pmesh_mesh *m = &c->mesh;
    dec_view *view = &dec->view;

    view->index = m->wedge ? m->wedge : m->vertex;
    if (view->position)
        memcpy(view->position, m->position,
               m->vertex_count * sizeof *view->position);
    view->vertices = view->decoded = view->stands = m->vertex_count;
}

/* A vertex that splits has at most PMESH_MAX_RING corners to give away, and
 * within the block each edge of its part brings at most one more, each fan that
 * lone faces bring, at most two: no split moves as many as MOST_MOVED. */
bool dec_view_append(pmesh_decoder *dec)
{
    enum { MOST_MOVED = UINT8_MAX };
    const pmesh_codec *c = &dec->codec;
    const pmesh_mesh *m = &c->mesh;
    const pmesh_block *b = &c->block;
    dec_view *view = &dec->view;
    uint32_t count = view->moved;

    for (uint32_t u = b->vertex; u < b->vertex + b->vertex_count; u++) {
        const uint32_t new_edge = 3 * c->child_face[u - b->vertex];
        const uint32_t first = count;
        uint32_t start = m->first[u];
        for (uint32_t h = start; h != PMESH_NONE;
             h = pmesh_corner_next(m, &start, h)) {
            if (h >= new_edge)
                continue;
            if (count == dec->header.moved_corners ||
                count - first == MOST_MOVED)
                return false;
            set_moved_edge(view, count, h);
            if (m->wedge)
                view->moved_wedge[count] = m->wedge[h];
            count++;
        }
        view->moved_count[u] = (uint8_t)(count - first);
    }
    for (uint32_t u = b->vertex; view->position && u < m->vertex_count; u++) {
        int32_t *at = view->position[m->parent[u]];
        memcpy(view->position[u], m->position[u], sizeof *view->position);
        memcpy(view->other[u], at, sizeof *view->other);
        memcpy(at, m->position[m->parent[u]], sizeof *view->position);
    }
    view->decoded = view->stands = m->vertex_count;
    view->moved = count;
    return true;
}

uint32_t dec_faces_at(const pmesh_decoder *dec, uint32_t vertices)
{
    return vertices > dec->header.base_vertices
               ? pmesh_faces_at(&dec->codec, vertices)
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
    const uint32_t end = view->moved + view->moved_count[u];
    for (uint32_t i = view->moved; i < end; i++)
        view->index[moved_edge(view, i)] =
            view->moved_wedge ? view->moved_wedge[i] : u;
    view->moved = end;
    if (view->position)
        swap_parent(view, u, dec->codec.mesh.parent[u]);
}

static void hide(pmesh_decoder *dec, uint32_t u)
{
    const pmesh_mesh *m = &dec->codec.mesh;
    dec_view *view = &dec->view;
    const uint32_t end = view->moved;
    view->moved -= view->moved_count[u];
    for (uint32_t i = view->moved; i < end; i++)
        view->index[moved_edge(view, i)] =
            view->moved_wedge ? m->wedge_parent[view->moved_wedge[i]]
                              : m->parent[u];
    if (view->position)
        swap_parent(view, u, m->parent[u]);
}

static void stand(pmesh_decoder *dec, uint32_t target)
{
    dec_view *view = &dec->view;
    for (; view->stands < target; view->stands++)
        show(dec, view->stands);
    for (; view->stands > target; view->stands--)
        hide(dec, view->stands - 1);
}

/* Of splits first .. end - 1, what they change of the faces and vertices that
 * stay. */
static void note(pmesh_decoder *dec, uint32_t first, uint32_t end)
{
    const dec_view *view = &dec->view;
    uint32_t i = view->moved;
    for (uint32_t u = view->stands; u < first; u++)
        i += view->moved_count[u];
    for (uint32_t u = view->stands; u > first; u--)
        i -= view->moved_count[u - 1];
    for (uint32_t u = first; u < end; u++) {
        for (const uint32_t stop = i + view->moved_count[u]; i < stop; i++)
            dec_touch(&dec->changed.faces, moved_edge(view, i) / 3);
        if (view->position)
            dec_touch(&dec->changed.moved, dec->codec.mesh.parent[u]);
    }
}

void dec_view_raise(pmesh_decoder *dec)
{
    stand(dec, dec->view.decoded);
}

/* No vertex splits twice in a block: one step leads out of it. */
void dec_view_restore(pmesh_decoder *dec)
{
    const pmesh_mesh *m = &dec->codec.mesh;
    const uint32_t *parent = m->wedge ? m->wedge_parent : m->parent;
    const uint32_t edges = 3 * dec_faces_at(dec, dec->view.decoded);
    const uint32_t wedges = dec_wedges_at(dec, dec->view.decoded);
    uint32_t *index = dec->view.index;
    for (uint32_t h = 0; h < edges; h++)
        if (index[h] >= wedges)
            index[h] = parent[index[h]];
}

void dec_view_settle(const pmesh_decoder *dec)
{
    if (dec->view.stands != dec->view.vertices)
        stand(dec->self, dec->view.vertices);
}

void dec_view_move(pmesh_decoder *dec, uint32_t target, bool noting)
{
    dec_view *view = &dec->view;
    const uint32_t from = view->vertices;
    if (noting && target < from)
        note(dec, target, from);
    else if (noting)
        note(dec, from, target);
    view->vertices = target;
    stand(dec, target);
}
