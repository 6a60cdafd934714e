/* SPDX-License-Identifier: MIT */
/*
 * dec_view.c - the visible mesh: moves an index buffer up and down among the
 * splits that are decoded.
 */
#include <string.h>

#include "decoder/dec_internal.h"

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

    uint8_t *base = (uint8_t *)block;
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

/* What split u changes of the faces and vertices that stay. */
static void note(pmesh_decoder *dec, uint32_t u)
{
    const dec_view *view = &dec->view;
    for (uint32_t i = view->moved_first[u]; i < view->moved_first[u + 1]; i++)
        dec_touch(&dec->changed.faces, view->moved[i] / 3);
    if (view->position)
        dec_touch(&dec->changed.moved, dec->codec.mesh.parent[u]);
}

void dec_view_move(pmesh_decoder *dec, uint32_t target, bool noting)
{
    dec_view *view = &dec->view;
    for (; view->vertices < target; view->vertices++) {
        show(dec, view->vertices);
        if (noting)
            note(dec, view->vertices);
    }
    for (; view->vertices > target; view->vertices--) {
        hide(dec, view->vertices - 1);
        if (noting)
            note(dec, view->vertices - 1);
    }
}
