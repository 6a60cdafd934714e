/* SPDX-License-Identifier: MIT */
#include "encoder/enc_mux.h"

#include <string.h>

#include "format/alloc.h"

enum {
    PIECE = 32768, /* bytes of one chunk, if what it holds can be cut */
    WHOLE = (1 << 28) - 64, /* if it must not be, beyond what a chunk takes */
    JOINED = 2048  /* short runs of one mesh share a chunk */
};

static enc_piece *add_piece(enc_mux *m, uint32_t part, const uint8_t *data,
                        size_t size)
{
    if (m->piece_count == m->piece_room) {
        const size_t room = m->piece_room ? 2 * m->piece_room : 64;
        enc_piece *items = pmesh_alloc(&m->allocator, room, sizeof *items);
        if (!items) {
            m->failed = true;
            return NULL;
        }
        if (m->piece_count > 0)
            memcpy(items, m->piece, m->piece_count * sizeof *items);
        pmesh_release(&m->allocator, m->piece, m->piece_room, sizeof *items);
        m->piece = items;
        m->piece_room = room;
    }
    enc_piece *p = &m->piece[m->piece_count++];
    *p = (enc_piece){ .part = part, .data = data, .size = (uint32_t)size };
    return p;
}

static void add_blob(enc_mux *m, uint32_t part, const pmesh_scene_blob *blob,
                     size_t most)
{
    const uint8_t *data = blob->data;
    for (size_t at = 0; at < blob->size && !m->failed; at += most) {
        const size_t left = blob->size - at;
        add_piece(m, part, data + at, left < most ? left : most);
    }
}

static void add_resources(enc_mux *m, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++)
        add_blob(m, (uint32_t)(1 + m->in->mesh_count + i),
                 &m->in->resources[i],
                 m->in->resource_offsets ? WHOLE : PIECE);
}

/* Behind the piece before, if it is a short one of the same mesh. */
static void add_run(enc_mux *m, uint32_t part, const uint8_t *data, size_t size)
{
    enc_piece *last = m->piece_count ? &m->piece[m->piece_count - 1] : NULL;
    if (last && last->part == part && last->size + size <= JOINED)
        last->size += (uint32_t)size; /* one stream: the bytes are adjacent */
    else
        add_piece(m, part, data, size);
}

/* ---- the order of the meshes -------------------------------------------- */

/* Of what is there of a mesh, in world units; negative: all of it is. */
static double error_of(const enc_mux *m, uint32_t mesh)
{
    const enc_split *s = &m->mesh[mesh];
    return s->at == s->size
               ? -1
               : (double)m->in->meshes[mesh].scale *
                     (double)s->header.levels[s->level - 1].error;
}

static bool comes_first(const enc_mux *m, uint32_t a, uint32_t b)
{
    const double x = error_of(m, a), y = error_of(m, b);
    return x > y || (x >= y && a < b);
}

static void sift(enc_mux *m, uint32_t at)
{
    const uint32_t mesh = m->heap[at];
    for (;;) {
        uint32_t next = 2 * at + 1;
        if (next >= m->heap_count)
            break;
        if (next + 1 < m->heap_count &&
            comes_first(m, m->heap[next + 1], m->heap[next]))
            next++;
        if (!comes_first(m, m->heap[next], mesh))
            break;
        m->heap[at] = m->heap[next];
        at = next;
    }
    m->heap[at] = mesh;
}

/* The chunks of a mesh's next level; false if there are none. */
static bool add_level(enc_mux *m, uint32_t mesh)
{
    enc_split *s = &m->mesh[mesh];
    const uint32_t before = s->level;
    const uint8_t *data;
    size_t size;
    bool any = false;

    while (!m->failed && s->level == before &&
           enc_split_next(s, PIECE, &data, &size)) {
        add_run(m, mesh + 1, data, size);
        any = true;
    }
    for (uint32_t i = before; i < s->level; i++) {
        const pmesh_level_entry *e = &s->header.levels[i];
        m->now.faces += e->faces - (i > 0 ? e[-1].faces : 0);
        m->now.vertices += e->wedges - (i > 0 ? e[-1].wedges : 0);
    }
    return any;
}

static void end_row(enc_mux *m)
{
    const double error = error_of(m, m->heap[0]);
    enc_piece *last = &m->piece[m->piece_count - 1];
    m->now.error = error > 0 ? (float)error : 0;
    last->is_row = true;
    last->row = m->now;
}

static void order_meshes(enc_mux *m)
{
    const uint32_t count = (uint32_t)m->in->mesh_count;

    for (uint32_t i = 0; i < count && !m->failed; i++) {
        add_level(m, i);
        m->heap[i] = i;
    }
    if (m->failed)
        return;
    m->heap_count = count;
    for (uint32_t i = count / 2; i-- > 0;)
        sift(m, i);
    end_row(m);
    while (!m->failed && add_level(m, m->heap[0])) {
        if (m->failed)
            return;
        sift(m, 0);
        end_row(m);
    }
}

pmesh_status enc_mux_build(enc_mux *m, const pmesh_scene_input *in,
                           const pmesh_allocator *allocator, size_t *bad)
{
    *m = (enc_mux){ .in = in, .allocator = *allocator };
    m->mesh = pmesh_alloc_zero(allocator, in->mesh_count, sizeof *m->mesh);
    m->heap = pmesh_alloc_zero(allocator, in->mesh_count, sizeof *m->heap);
    if (!m->mesh || !m->heap)
        return PMESH_E_MEMORY;
    for (size_t i = 0; i < in->mesh_count; i++) {
        const pmesh_status status = enc_split_open(
            &m->mesh[i], in->meshes[i].stream, in->meshes[i].size);
        *bad = i;
        if (status != PMESH_OK)
            return status;
    }
    add_blob(m, 0, &in->document, PIECE);
    add_resources(m, 0, in->early_count);
    order_meshes(m);
    add_resources(m, in->early_count, in->resource_count);
    return m->failed ? PMESH_E_MEMORY : PMESH_OK;
}

void enc_mux_destroy(enc_mux *m)
{
    const pmesh_allocator *a = &m->allocator;
    const size_t meshes = m->in->mesh_count;

    pmesh_release(a, m->mesh, meshes, sizeof *m->mesh);
    pmesh_release(a, m->heap, meshes, sizeof *m->heap);
    pmesh_release(a, m->piece, m->piece_room, sizeof *m->piece);
}
