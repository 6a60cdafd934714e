/* SPDX-License-Identifier: MIT */
/*
 * enc_base.c - hands the base mesh, what contraction left, to the codec; or to
 * a hook, whose numbers for it the codec then takes over.
 */
#include <string.h>

#include "encoder/enc_match.h"
#include "encoder/enc_replay.h"
#include "format/alloc.h"

enum { SIZE_ROOM = 5 }; /* of a varint below 2^35 */

/* The base mesh with numbers of its own, and where they come from. */
typedef struct base_mesh {
    pmesh_mesh mesh; /* joined: of which each vertex is one fan */
    uint32_t edge_count;
    size_t room;      /* for its vertices */
    uint32_t *point;  /* joined, per fan: its vertex, as below */
    uint32_t *point_vertex; /* and of each of these the codec's number */
    uint32_t *corner; /* per half-edge: of the import */
    uint32_t *vertex; /* per vertex of the import: of the base, or ENC_NONE */
    uint32_t *source; /* per base vertex: of the import */
    uint32_t *edge_of_codec;
    uint32_t *codec_vertex;
    uint32_t *table; /* directed pairs -> half-edges */
    uint64_t table_size;
} base_mesh;

static void base_free(base_mesh *b, const enc_replay *r)
{
    const pmesh_allocator *a = &r->allocator;
    const size_t n = r->base_vertices, edges = b->edge_count;
    pmesh_release(a, b->mesh.vertex, edges, 4);
    pmesh_release(a, b->mesh.twin, edges, 4);
    pmesh_release(a, b->mesh.position, b->room, sizeof *b->mesh.position);
    pmesh_release(a, b->point, b->room, 4);
    pmesh_release(a, b->point_vertex, n, 4);
    pmesh_release(a, b->corner, edges, 4);
    pmesh_release(a, b->vertex, r->mesh->vertex_count, 4);
    pmesh_release(a, b->source, n, 4);
    pmesh_release(a, b->edge_of_codec, edges, 4);
    pmesh_release(a, b->codec_vertex, b->room, 4);
    pmesh_release(a, b->table, (size_t)b->table_size, 4);
}

static bool base_allocate(base_mesh *b, const enc_replay *r)
{
    const pmesh_allocator *a = &r->allocator;
    const size_t n = r->base_vertices, edges = b->edge_count;
    b->mesh.vertex = pmesh_alloc(a, edges, 4);
    b->mesh.twin = pmesh_alloc(a, edges, 4);
    b->mesh.position = pmesh_alloc(a, b->room, sizeof *b->mesh.position);
    if (r->mesh->joined) {
        b->point = pmesh_alloc(a, b->room, 4);
        b->point_vertex = pmesh_alloc(a, n, 4);
        if (!b->point || !b->point_vertex)
            return false;
    }
    b->corner = pmesh_alloc(a, edges, 4);
    b->vertex = pmesh_alloc(a, r->mesh->vertex_count, 4);
    b->source = pmesh_alloc(a, n, 4);
    b->edge_of_codec = pmesh_alloc(a, edges, 4);
    b->codec_vertex = pmesh_alloc(a, b->room, 4);
    b->table = pmesh_alloc(a, (size_t)b->table_size, 4);
    return b->mesh.vertex && b->mesh.twin && b->mesh.position && b->corner &&
           b->vertex && b->source && b->edge_of_codec && b->codec_vertex &&
           b->table;
}

static void base_fill(base_mesh *b, const enc_replay *r)
{
    const enc_mesh *m = r->mesh;
    uint32_t n = 0, h = 0;
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        b->vertex[v] = ENC_NONE;
        if (r->schedule->vertex_end[v] != ENC_NONE)
            continue;
        memcpy(b->mesh.position[n], r->position[v], sizeof *r->position);
        b->codec_vertex[n] = PMESH_NONE;
        b->source[n] = v;
        b->vertex[v] = n++;
    }
    for (uint32_t f = 0; f < m->face_count; f++)
        for (uint32_t k = 0;
             k < 3 && r->schedule->face_end[f] == ENC_NONE; k++, h++) {
            b->corner[h] = 3 * f + k;
            b->mesh.vertex[h] = b->vertex[r->label[m->vertex[3 * f + k]]];
        }
    b->mesh.vertex_count = n;
    b->mesh.face_count = r->base_faces;
}

static uint64_t slot_of(const base_mesh *b, uint32_t from, uint32_t to)
{
    const uint64_t mask = b->table_size - 1;
    uint64_t slot = pmesh_edge_hash(from, to) & mask;
    for (;; slot = (slot + 1) & mask) {
        const uint32_t h = b->table[slot];
        if (h == ENC_NONE || (b->mesh.vertex[h] == from &&
                              b->mesh.vertex[pmesh_next(h)] == to))
            return slot;
    }
}

/* A contracted manifold has each directed pair once: twins are found by name.
 */
static void base_pair(base_mesh *b)
{
    for (uint64_t i = 0; i < b->table_size; i++)
        b->table[i] = ENC_NONE;
    for (uint32_t h = 0; h < b->edge_count; h++)
        b->table[slot_of(b, b->mesh.vertex[h],
                         b->mesh.vertex[pmesh_next(h)])] = h;
    for (uint32_t h = 0; h < b->edge_count; h++)
        b->mesh.twin[h] = b->table[slot_of(b, b->mesh.vertex[pmesh_next(h)],
                                           b->mesh.vertex[h])];
}

/* Twins are what the import's have become. */
static void joined_pair(base_mesh *b, enc_replay *r)
{
    for (uint32_t f = 0; f < r->base_faces; f++)
        r->face_of[b->corner[3 * f] / 3] = f;
    for (uint32_t h = 0; h < b->edge_count; h++) {
        const uint32_t t = enc_part_twin(r, b->corner[h]);
        b->mesh.twin[h] =
            t == ENC_NONE ? ENC_NONE : 3 * r->face_of[t / 3] + t % 3;
    }
}

/* Each fan becomes a vertex of the base; `point` tells which it was. */
static void split_fans(base_mesh *b, const enc_replay *r)
{
    pmesh_mesh *m = &b->mesh;
    uint32_t count = 0;
    memset(b->edge_of_codec, 0xff, b->edge_count * sizeof *b->edge_of_codec);
    for (uint32_t c = 0; c < b->edge_count; c++) {
        uint32_t h = c;
        if (b->edge_of_codec[c] != ENC_NONE) /* scratch: corners done */
            continue;
        while (m->twin[h] != ENC_NONE) {
            h = pmesh_next(m->twin[h]);
            if (h == c)
                break;
        }
        const uint32_t start = h;
        b->point[count] = m->vertex[c];
        do {
            b->edge_of_codec[h] = m->vertex[h] = count;
            h = pmesh_turn_left(m, h);
        } while (h != ENC_NONE && h != start);
        b->codec_vertex[count++] = PMESH_NONE;
    }
    memset(b->point_vertex, 0xff, r->base_vertices * sizeof *b->point_vertex);
    for (uint32_t fan = count; fan-- > 0;) /* positions were by point */
        memcpy(m->position[fan], r->position[b->source[b->point[fan]]],
               sizeof *m->position);
    m->vertex_count = count;
}

/* The shape is known: attributes, and all that follows, need the maps. */
static void fill_maps(enc_replay *r, const base_mesh *b)
{
    for (uint32_t h = 0; h < b->edge_count; h++)
        r->corner_of[h] = b->corner[b->edge_of_codec[h]];
    const uint32_t *number = b->point ? b->point_vertex : b->codec_vertex;
    for (uint32_t i = 0; i < r->base_vertices; i++) {
        r->vertex_of[number[i]] = b->source[i];
        r->born[b->source[i]] = number[i];
    }
    if (b->point)
        enc_part_number(r, 0, r->base_faces);
}

static pmesh_status code_natively(enc_replay *r, const base_mesh *b,
                                  pmesh_coder *coder)
{
    pmesh_oracle oracle = r->oracle;
    oracle.base = &b->mesh;
    oracle.base_edge = b->edge_of_codec;
    oracle.base_vertex = b->codec_vertex;
    oracle.base_point = b->point;
    oracle.point_vertex = b->point_vertex;
    if (b->point)
        r->codec.sizes.base_fans = b->mesh.vertex_count;
    return pmesh_base_code(&r->codec, coder, &oracle, r->base_vertices,
                           r->base_faces);
}

/* The maps of a codec's mesh that came from the hook. */
static pmesh_status find_maps(enc_replay *r, const base_mesh *b, bool *same)
{
    const pmesh_mesh *m = &r->codec.mesh;
    const pmesh_status status =
        enc_match(&r->allocator, &b->mesh, m, b->edge_of_codec, same);
    for (uint32_t h = 0; *same && h < b->edge_count; h++)
        b->codec_vertex[b->mesh.vertex[b->edge_of_codec[h]]] = m->vertex[h];
    return status;
}

/* Writes size and bytes of a Draco buffer and takes over its numbers. *done is
 * false if Draco cannot hold this mesh: then nothing was written. */
static pmesh_status code_by_draco(enc_replay *r, const base_mesh *b,
                                  const pmesh_encoder_config *config,
                                  pmesh_writer *out, bool *done)
{
    const size_t room = out->capacity - SIZE_ROOM;
    uint8_t *data = out->data + SIZE_ROOM;
    size_t size = 0;
    *done = false;
    pmesh_status status = config->base_encoder(
        config->base_user, &b->mesh.position[0][0], r->base_vertices,
        b->mesh.vertex, r->base_faces, data, room, &size);
    if (size > room)
        status = PMESH_E_LIMIT;
    if (status == PMESH_OK) {
        const pmesh_base_source source = { config->base_decoder,
                                           config->base_user, data, size };
        status = pmesh_base_import(&r->codec, &source, r->base_vertices,
                                   r->base_faces);
    }
    if (status == PMESH_OK)
        status = find_maps(r, b, done);
    if (*done) {
        pmesh_put_varint(out, size);
        memmove(out->data + out->size, data, size);
        out->size += size;
    } else {
        r->codec.mesh.vertex_count = r->codec.mesh.face_count = 0;
    }
    return status == PMESH_E_MEMORY ? status : PMESH_OK;
}

static pmesh_status code_base(enc_replay *r, base_mesh *b,
                              const pmesh_encoder_config *config,
                              pmesh_writer *out)
{
    pmesh_coder coder;
    bool done = false;
    pmesh_status status = PMESH_OK;
    base_fill(b, r);
    if (b->point) {
        joined_pair(b, r);
        split_fans(b, r);
    } else {
        base_pair(b);
    }
    if (config->base_coder == PMESH_BASE_DRACO && !b->point)
        status = code_by_draco(r, b, config, out, &done);
    r->base_coder = done ? PMESH_BASE_DRACO : PMESH_BASE_NATIVE;
    pmesh_coder_encode(&coder, out);
    if (status == PMESH_OK && !done)
        status = code_natively(r, b, &coder);
    if (status != PMESH_OK)
        return status;
    fill_maps(r, b);
    status = pmesh_base_attributes_code(&r->codec, &coder, &r->oracle,
                                        r->codec.mesh.wedge_capacity);
    if (status != PMESH_OK)
        return status;
    return pmesh_coder_finish(&coder) ? PMESH_OK : PMESH_E_LIMIT;
}

pmesh_status enc_replay_base(enc_replay *r, const pmesh_encoder_config *config,
                             pmesh_writer *out)
{
    base_mesh b = { .edge_count = 3 * r->base_faces,
                    .room = r->mesh->joined ? 3 * (size_t)r->base_faces
                                            : r->base_vertices,
                    .table_size = pmesh_base_scratch(r->base_faces) };
    enc_replay_label(r, r->schedule->contraction_count);
    const pmesh_status status = base_allocate(&b, r)
                                    ? code_base(r, &b, config, out)
                                    : PMESH_E_MEMORY;
    base_free(&b, r);
    return status;
}
