/* SPDX-License-Identifier: MIT */
/*
 * enc_scene.c - pmesh_scene_encode(): the order of the chunks, then the file.
 */
#include <float.h>
#include <string.h>

#include "encoder/enc_split.h"
#include "format/alloc.h"
#include "format/crc32c.h"
#include "format/scene.h"

enum {
    PIECE = 32768,  /* bytes of one chunk, if what it holds can be cut */
    JOINED = 2048,  /* short runs of one mesh share a chunk */
    MAX_START = 16, /* type, size and number of a part */
    HEAD_ROOM = 64 + 32 * PMESH_MAX_LEVELS, /* of what is not a list */
    ENTRY_ROOM = 14 /* of a list's entry */
};

/* A chunk of the file to be. */
typedef struct piece {
    uint32_t part, size;
    const uint8_t *data;
    uint32_t crc;
    bool is_row; /* all base meshes are there, and it ends a level: */
    pmesh_scene_row row;
} piece;

typedef struct mux {
    const pmesh_scene_input *in;
    pmesh_allocator allocator;
    enc_split *mesh;
    uint32_t *heap, heap_count;
    piece *piece;
    size_t piece_count, piece_room;
    pmesh_scene_row now; /* what is there so far */
    bool failed;         /* out of memory */
    pmesh_scene_head head;
    pmesh_scene_stream *stream;
    uint64_t *resource;
    uint8_t *payload; /* of the header chunk */
    size_t payload_room;
} mux;

/* ---- pieces ------------------------------------------------------------- */

static piece *add_piece(mux *m, uint32_t part, const uint8_t *data,
                        size_t size)
{
    if (m->piece_count == m->piece_room) {
        const size_t room = m->piece_room ? 2 * m->piece_room : 64;
        piece *items = pmesh_alloc(&m->allocator, room, sizeof *items);
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
    piece *p = &m->piece[m->piece_count++];
    *p = (piece){ .part = part, .data = data, .size = (uint32_t)size };
    return p;
}

static void add_blob(mux *m, uint32_t part, const pmesh_scene_blob *blob)
{
    const uint8_t *data = blob->data;
    for (size_t at = 0; at < blob->size && !m->failed; at += PIECE) {
        const size_t left = blob->size - at;
        add_piece(m, part, data + at, left < PIECE ? left : PIECE);
    }
}

static void add_resources(mux *m, size_t first, size_t end)
{
    for (size_t i = first; i < end; i++)
        add_blob(m, (uint32_t)(1 + m->in->mesh_count + i),
                 &m->in->resources[i]);
}

/* Behind the piece before, if it is a short one of the same mesh. */
static void add_run(mux *m, uint32_t part, const uint8_t *data, size_t size)
{
    piece *last = m->piece_count ? &m->piece[m->piece_count - 1] : NULL;
    if (last && last->part == part && last->size + size <= JOINED)
        last->size += (uint32_t)size; /* one stream: the bytes are adjacent */
    else
        add_piece(m, part, data, size);
}

/* ---- the order of the meshes -------------------------------------------- */

/* Of what is there of a mesh, in world units; negative: all of it is. */
static double error_of(const mux *m, uint32_t mesh)
{
    const enc_split *s = &m->mesh[mesh];
    return s->at == s->size
               ? -1
               : (double)m->in->meshes[mesh].scale *
                     (double)s->header.levels[s->level - 1].error;
}

static bool comes_first(const mux *m, uint32_t a, uint32_t b)
{
    const double x = error_of(m, a), y = error_of(m, b);
    return x > y || (x >= y && a < b);
}

static void sift(mux *m, uint32_t at)
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
static bool add_level(mux *m, uint32_t mesh)
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

static void end_row(mux *m)
{
    const double error = error_of(m, m->heap[0]);
    piece *last = &m->piece[m->piece_count - 1];
    m->now.error = error > 0 ? (float)error : 0;
    last->is_row = true;
    last->row = m->now;
}

static void order_meshes(mux *m)
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

/* ---- the file ----------------------------------------------------------- */

/* Type, size and part number of a chunk. */
static size_t start_of(const piece *p, uint8_t out[MAX_START])
{
    uint8_t number[8];
    pmesh_writer part = { number, 0, sizeof number, false };
    pmesh_writer start = { out, 0, MAX_START, false };

    pmesh_put_varint(&part, p->part);
    pmesh_put(&start, PMESH_CHUNK_PART, 1);
    pmesh_put_varint(&start, part.size + p->size);
    pmesh_put_varint(&start, p->part);
    return start.size;
}

/* Checksums, the hash of all, and where rows end. */
static void measure(mux *m)
{
    uint64_t bytes = 0;

    m->head.content_hash = PMESH_HASH_START;
    for (size_t i = 0; i < m->piece_count; i++) {
        piece *p = &m->piece[i];
        uint8_t start[MAX_START];
        const size_t n = start_of(p, start);
        p->crc = pmesh_crc32c(pmesh_crc32c(0, start, n), p->data, p->size);
        m->head.content_hash = pmesh_hash_crc(m->head.content_hash, p->crc);
        bytes += n + p->size + PMESH_CRC_SIZE;
        p->row.bytes = bytes;
        if (p->size + MAX_START > m->head.chunk_size)
            m->head.chunk_size = p->size + MAX_START;
    }
}

/* All rows, or 64 of them at equal distances, the last one included. */
static void choose_rows(mux *m)
{
    size_t count = 0, seen = 0;

    for (size_t i = 0; i < m->piece_count; i++)
        count += m->piece[i].is_row;
    const size_t kept = count < PMESH_MAX_LEVELS ? count : PMESH_MAX_LEVELS;
    for (size_t i = 0; i < m->piece_count; i++) {
        if (!m->piece[i].is_row)
            continue;
        const size_t next = m->head.level_count;
        if (kept == 1 || seen == next * (count - 1) / (kept - 1))
            m->head.levels[m->head.level_count++] = m->piece[i].row;
        seen++;
    }
}

static pmesh_status fill_head(mux *m)
{
    const pmesh_scene_input *in = m->in;
    m->head.document_size = in->document.size;
    m->head.mesh_count = (uint32_t)in->mesh_count;
    m->head.resource_count = (uint32_t)in->resource_count;
    for (size_t i = 0; i < in->mesh_count; i++)
        m->stream[i] = (pmesh_scene_stream){ m->mesh[i].size,
                                             in->meshes[i].scale };
    for (size_t i = 0; i < in->resource_count; i++)
        m->resource[i] = in->resources[i].size;
    measure(m);
    choose_rows(m);
    return m->piece[m->piece_count - 1].row.bytes <= PMESH_MAX_FILE
               ? PMESH_OK
               : PMESH_E_LIMIT;
}

static bool put(pmesh_write write, void *user, pmesh_scene_report *report,
                const void *data, size_t size)
{
    report->bytes += size;
    return size == 0 || write(user, data, size) == 0;
}

static bool put_chunk(pmesh_write write, void *user,
                      pmesh_scene_report *report, const uint8_t *start,
                      size_t start_size, const uint8_t *data, size_t size,
                      uint32_t crc)
{
    uint8_t tail[PMESH_CRC_SIZE];
    pmesh_writer end = { tail, 0, sizeof tail, false };
    pmesh_put(&end, crc, PMESH_CRC_SIZE);
    return put(write, user, report, start, start_size) &&
           put(write, user, report, data, size) &&
           put(write, user, report, tail, sizeof tail);
}

/* A chunk that is no part. */
static bool put_whole(pmesh_write write, void *user,
                      pmesh_scene_report *report, uint8_t type,
                      const uint8_t *data, size_t size)
{
    uint8_t start[MAX_START];
    pmesh_writer out = { start, 0, sizeof start, false };
    pmesh_put(&out, type, 1);
    pmesh_put_varint(&out, size);
    const uint32_t crc =
        pmesh_crc32c(pmesh_crc32c(0, start, out.size), data, size);
    return put_chunk(write, user, report, start, out.size, data, size, crc);
}

static bool put_piece(const mux *m, pmesh_write write, void *user,
                      pmesh_scene_report *report, const piece *p)
{
    uint8_t start[MAX_START];
    const size_t n = start_of(p, start);
    const uint64_t size = n + p->size + PMESH_CRC_SIZE;
    uint64_t *const part = p->part == 0 ? &report->bytes_document
                           : p->part <= m->in->mesh_count
                               ? &report->bytes_meshes
                               : &report->bytes_resources;
    *part += size;
    return put_chunk(write, user, report, start, n, p->data, p->size, p->crc);
}

static pmesh_status write_file(mux *m, pmesh_write write, void *user,
                               pmesh_scene_report *report)
{
    pmesh_writer out = { m->payload, 0, m->payload_room, false };
    pmesh_scene_head_write(&out, &m->head, m->stream, m->resource);
    if (out.overflow || out.size > PMESH_MAX_SCENE_HEADER)
        return PMESH_E_LIMIT;

    bool good =
        put(write, user, report, PMESH_SIGNATURE, PMESH_SIGNATURE_SIZE) &&
        put_whole(write, user, report, PMESH_CHUNK_SCENE, m->payload, out.size);
    report->level_count = m->head.level_count;
    for (uint32_t i = 0; i < m->head.level_count; i++) {
        const pmesh_scene_row *row = &m->head.levels[i];
        report->levels[i] = (pmesh_scene_level){ report->bytes + row->bytes,
                                                 row->faces, row->vertices,
                                                 row->error };
    }
    for (size_t i = 0; good && i < m->piece_count; i++)
        good = put_piece(m, write, user, report, &m->piece[i]);
    good = good &&
           put_whole(write, user, report, PMESH_CHUNK_END, m->payload, 0);
    report->faces = m->now.faces;
    report->vertices = m->now.vertices;
    report->bytes_header = report->bytes - report->bytes_document -
                           report->bytes_meshes - report->bytes_resources;
    return good ? PMESH_OK : PMESH_E_WRITE;
}

/* ---- the call ----------------------------------------------------------- */

static bool input_is_sound(const pmesh_scene_input *in)
{
    if (!in->meshes || in->mesh_count < 1 ||
        in->mesh_count > PMESH_MAX_PARTS ||
        in->resource_count > PMESH_MAX_PARTS ||
        in->early_count > in->resource_count ||
        in->document.size > PMESH_MAX_CHUNK_SIZE ||
        (in->document.size > 0 && !in->document.data) ||
        (in->resource_count > 0 && !in->resources))
        return false;
    for (size_t i = 0; i < in->resource_count; i++)
        if (in->resources[i].size > 0 && !in->resources[i].data)
            return false;
    for (size_t i = 0; i < in->mesh_count; i++) {
        const pmesh_scene_mesh_input *mesh = &in->meshes[i];
        if (!mesh->stream || !(mesh->scale >= 0 && mesh->scale <= FLT_MAX))
            return false;
    }
    return true;
}

static bool make_room(mux *m)
{
    const pmesh_allocator *a = &m->allocator;
    const size_t meshes = m->in->mesh_count, more = m->in->resource_count;

    m->payload_room = HEAD_ROOM + ENTRY_ROOM * (meshes + more);
    m->mesh = pmesh_alloc_zero(a, meshes, sizeof *m->mesh);
    m->heap = pmesh_alloc_zero(a, meshes, sizeof *m->heap);
    m->stream = pmesh_alloc_zero(a, meshes, sizeof *m->stream);
    m->resource = pmesh_alloc_zero(a, more, sizeof *m->resource);
    m->payload = pmesh_alloc(a, m->payload_room, 1);
    return m->mesh && m->heap && m->stream && m->resource && m->payload;
}

static void release(mux *m)
{
    const pmesh_allocator *a = &m->allocator;
    const size_t meshes = m->in->mesh_count, more = m->in->resource_count;

    pmesh_release(a, m->mesh, meshes, sizeof *m->mesh);
    pmesh_release(a, m->heap, meshes, sizeof *m->heap);
    pmesh_release(a, m->stream, meshes, sizeof *m->stream);
    pmesh_release(a, m->resource, more, sizeof *m->resource);
    pmesh_release(a, m->payload, m->payload_room, 1);
    pmesh_release(a, m->piece, m->piece_room, sizeof *m->piece);
}

static pmesh_status run(mux *m, pmesh_write write, void *user,
                        pmesh_scene_report *report)
{
    if (!make_room(m))
        return PMESH_E_MEMORY;
    for (size_t i = 0; i < m->in->mesh_count; i++) {
        const pmesh_scene_mesh_input *mesh = &m->in->meshes[i];
        const pmesh_status status =
            enc_split_open(&m->mesh[i], mesh->stream, mesh->size);
        report->error_mesh = i;
        if (status != PMESH_OK)
            return status;
    }
    add_blob(m, 0, &m->in->document);
    add_resources(m, 0, m->in->early_count);
    order_meshes(m);
    add_resources(m, m->in->early_count, m->in->resource_count);
    if (m->failed)
        return PMESH_E_MEMORY;
    const pmesh_status status = fill_head(m);
    return status == PMESH_OK ? write_file(m, write, user, report) : status;
}

pmesh_status pmesh_scene_encode(const pmesh_scene_input *scene,
                                const pmesh_allocator *allocator,
                                pmesh_write write, void *user,
                                pmesh_scene_report *report)
{
    static const pmesh_allocator none = { NULL, NULL, NULL };
    pmesh_scene_report unwanted;

    if (!scene || !write || !input_is_sound(scene) ||
        (allocator && !allocator->alloc != !allocator->release))
        return PMESH_E_ARGUMENT;
    mux m = { .in = scene,
              .allocator = pmesh_allocator_resolve(allocator ? *allocator
                                                             : none) };
    if (!report)
        report = &unwanted;
    *report = (pmesh_scene_report){ 0 };
    const pmesh_status status = run(&m, write, user, report);
    release(&m);
    return status;
}
