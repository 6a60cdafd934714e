/* SPDX-License-Identifier: MIT */
/*
 * dec_refine.c - moves the visible mesh to a target and tells what changed.
 */
#include "decoder/dec_internal.h"

/* The most vertices with at most `faces` faces; at least the base. */
static uint32_t vertices_for_faces(const pmesh_decoder *dec, uint32_t faces)
{
    uint32_t low = dec->header.base_vertices, high = dec->view.decoded;
    while (low < high) {
        const uint32_t middle = low + (high - low + 1) / 2;
        if (dec_faces_at(dec, middle) <= faces)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* The coarsest level with at most this error; all if none is decoded. */
static uint32_t vertices_for_error(const pmesh_decoder *dec, double error)
{
    const pmesh_level_entry *levels = dec->header.levels;
    for (uint32_t i = 0; i < dec->levels; i++)
        if ((double)levels[i].error <= error)
            return levels[i].vertices;
    return dec->view.decoded;
}

static uint32_t vertices_for_bytes(const pmesh_decoder *dec, uint64_t bytes)
{
    const pmesh_level_entry *levels = dec->header.levels;
    uint32_t n = dec->header.base_vertices;
    for (uint32_t i = 0; i < dec->levels; i++)
        if (dec->header_end + levels[i].bytes <= bytes)
            n = levels[i].vertices;
    return n;
}

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

uint32_t dec_target_vertices(const pmesh_decoder *dec,
                             const pmesh_target *target)
{
    uint32_t n = dec->view.decoded;
    if (target && target->faces > 0)
        n = least(n, vertices_for_faces(dec, target->faces));
    if (target && target->error > 0)
        n = least(n, vertices_for_error(dec, target->error));
    if (target && target->bytes > 0)
        n = least(n, vertices_for_bytes(dec, target->bytes));
    return n;
}

static bool can_move(const pmesh_header_chunk *h)
{
    return h->sizes.moves || h->exact_size > 0;
}

uint64_t dec_changed_bind(dec_changed *changed, const pmesh_header_chunk *h,
                          void *block)
{
    const uint64_t faces = dec_touched_size(h->sizes.faces);
    const uint64_t vertices = dec_touched_size(h->sizes.wedges);
    const uint64_t moved = can_move(h) ? dec_touched_size(h->sizes.vertices) : 0;
    uint8_t *at = (uint8_t *)block;
    if (at) {
        dec_touched_bind(&changed->faces, h->sizes.faces, at);
        dec_touched_bind(&changed->vertices, h->sizes.wedges, at + faces);
        dec_touched_bind(&changed->moved, h->sizes.vertices,
                         moved ? at + faces + vertices : NULL);
    }
    return faces + vertices + moved;
}

/* Marks the output vertices of mesh vertices that were marked. */
static void spread_moved(pmesh_decoder *dec)
{
    dec_changed *c = &dec->changed;
    const uint32_t wedges = dec_wedges_at(dec, dec->view.vertices);
    if (c->moved.count == 0)
        return;
    if (dec->exact.count > c->exact)
        dec_touch_range(&c->moved, c->exact, dec->exact.count);
    c->exact = dec->exact.count;
    if (dec_touched_next(&c->moved, 0, dec->view.vertices) ==
        dec->view.vertices)
        return;
    for (uint32_t w = 0; w < wedges; w++)
        if (dec_is_touched(&c->moved, dec_mesh_vertex(dec, w)))
            dec_touch(&c->vertices, w);
}

static void move_noting(pmesh_decoder *dec, uint32_t stop,
                        pmesh_changes *changes)
{
    dec_changed *c = &dec->changed;
    const uint32_t from = dec->view.vertices;
    const uint32_t faces = dec_faces_at(dec, stop);
    const uint32_t wedges = dec_wedges_at(dec, stop);

    dec_view_move(dec, stop, true);
    dec_touch_range(&c->faces, c->base ? 0 : dec_faces_at(dec, from), faces);
    dec_touch_range(&c->vertices, c->base ? 0 : dec_wedges_at(dec, from),
                    wedges);
    spread_moved(dec);
    if (dec->bound)
        dec_write_bound(dec);
    if (changes) {
        changes->face_range_count =
            dec_touched_ranges(&c->faces, faces, changes->faces);
        changes->vertex_range_count =
            dec_touched_ranges(&c->vertices, wedges, changes->vertices);
    }
    dec_touched_clear(&c->faces);
    dec_touched_clear(&c->vertices);
    dec_touched_clear(&c->moved);
}

pmesh_status pmesh_decoder_refine(pmesh_decoder *dec,
                                  const pmesh_target *target,
                                  pmesh_changes *changes)
{
    if (!dec->has_base)
        return PMESH_NEED_DATA;
    const uint32_t from = dec->view.vertices;
    const uint32_t goal = dec_target_vertices(dec, target);
    const uint32_t most = target && target->max_ops ? target->max_ops
                                                    : UINT32_MAX;
    uint32_t stop = goal;
    if (goal > from && goal - from > most)
        stop = from + most;
    else if (from > goal && from - goal > most)
        stop = from - most;

    if (changes || dec->bound)
        move_noting(dec, stop, changes);
    else
        dec_view_move(dec, stop, false);
    dec->changed.base = false;
    dec->changed.exact = dec->exact.count;
    return stop == goal ? PMESH_OK : PMESH_MORE;
}
