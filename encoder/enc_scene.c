/* SPDX-License-Identifier: MIT */
/*
 * enc_scene.c - pmesh_scene_encode(): the header, then all chunks.
 */
#include <float.h>
#include <string.h>

#include "encoder/enc_mux.h"
#include "format/alloc.h"
#include "format/crc32c.h"

enum {
    MAX_START = 16, /* type, size and number of a part */
    HEAD_ROOM = 64 + 32 * PMESH_MAX_LEVELS, /* of what is not a list */
    ENTRY_ROOM = 14 /* of a list's entry */
};

typedef struct scene_file {
    enc_mux mux;
    pmesh_scene_head head;
    pmesh_scene_stream *stream;
    uint64_t *resource;
    uint8_t *payload; /* of the header chunk */
    size_t payload_room;
} scene_file;

/* Type, size and part number of a chunk. */
static size_t start_of(const enc_piece *p, uint8_t out[MAX_START])
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

/* Checksums, which go on from piece to piece, the hash of all, and where rows
 * end. */
static void measure(scene_file *f)
{
    uint64_t bytes = 0;
    uint32_t crc = 0;

    f->head.content_hash = PMESH_HASH_START;
    for (size_t i = 0; i < f->mux.piece_count; i++) {
        enc_piece *p = &f->mux.piece[i];
        uint8_t start[MAX_START];
        const size_t n = start_of(p, start);
        crc = pmesh_crc32c(pmesh_crc32c(crc, start, n), p->data, p->size);
        p->crc = crc;
        f->head.content_hash = pmesh_hash_crc(f->head.content_hash, crc);
        bytes += n + p->size + PMESH_CRC_SIZE;
        p->row.bytes = bytes;
        if (p->size + MAX_START > f->head.chunk_size)
            f->head.chunk_size = p->size + MAX_START;
    }
}

/* All rows, or 64 of them at equal distances, the last one included. */
static void choose_rows(scene_file *f)
{
    size_t count = 0, seen = 0;

    for (size_t i = 0; i < f->mux.piece_count; i++)
        count += f->mux.piece[i].is_row;
    const size_t kept = count < PMESH_MAX_LEVELS ? count : PMESH_MAX_LEVELS;
    for (size_t i = 0; i < f->mux.piece_count; i++) {
        if (!f->mux.piece[i].is_row)
            continue;
        const size_t next = f->head.level_count;
        if (kept == 1 || seen == next * (count - 1) / (kept - 1))
            f->head.levels[f->head.level_count++] = f->mux.piece[i].row;
        seen++;
    }
}

static pmesh_status fill_head(scene_file *f)
{
    const pmesh_scene_input *in = f->mux.in;
    f->head.document_form = in->document_form;
    f->head.document_size = in->document.size;
    f->head.mesh_count = (uint32_t)in->mesh_count;
    f->head.resource_count = (uint32_t)in->resource_count;
    for (size_t i = 0; i < in->mesh_count; i++)
        f->stream[i] = (pmesh_scene_stream){ f->mux.mesh[i].size,
                                             in->meshes[i].scale };
    for (size_t i = 0; i < in->resource_count; i++)
        f->resource[i] = in->resources[i].size;
    measure(f);
    choose_rows(f);
    return f->mux.piece[f->mux.piece_count - 1].row.bytes <= PMESH_MAX_FILE
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

/* A chunk that is no part; its checksum goes on from `before`. */
static bool put_whole(pmesh_write write, void *user,
                      pmesh_scene_report *report, uint32_t before,
                      uint8_t type, const uint8_t *data, size_t size)
{
    uint8_t start[MAX_START];
    pmesh_writer out = { start, 0, sizeof start, false };
    pmesh_put(&out, type, 1);
    pmesh_put_varint(&out, size);
    const uint32_t crc =
        pmesh_crc32c(pmesh_crc32c(before, start, out.size), data, size);
    return put_chunk(write, user, report, start, out.size, data, size, crc);
}

static bool put_piece(const scene_file *f, pmesh_write write, void *user,
                      pmesh_scene_report *report, const enc_piece *p)
{
    uint8_t start[MAX_START];
    const size_t n = start_of(p, start);
    const uint64_t size = n + p->size + PMESH_CRC_SIZE;
    uint64_t *const part = p->part == 0 ? &report->bytes_document
                           : p->part <= f->mux.in->mesh_count
                               ? &report->bytes_meshes
                               : &report->bytes_resources;
    uint64_t *const told = f->mux.in->resource_offsets;
    *part += size;
    if (told && p->part > f->mux.in->mesh_count)
        told[p->part - f->mux.in->mesh_count - 1] = report->bytes + n;
    return put_chunk(write, user, report, start, n, p->data, p->size, p->crc);
}

static pmesh_status write_file(scene_file *f, pmesh_write write, void *user,
                               pmesh_scene_report *report)
{
    pmesh_writer out = { f->payload, 0, f->payload_room, false };
    pmesh_scene_head_write(&out, &f->head, f->stream, f->resource);
    if (out.overflow || out.size > PMESH_MAX_SCENE_HEADER)
        return PMESH_E_LIMIT;

    bool good =
        put(write, user, report, PMESH_SIGNATURE, PMESH_SIGNATURE_SIZE) &&
        put_whole(write, user, report, 0, PMESH_CHUNK_SCENE, f->payload,
                  out.size);
    report->level_count = f->head.level_count;
    for (uint32_t i = 0; i < f->head.level_count; i++) {
        const pmesh_scene_row *row = &f->head.levels[i];
        report->levels[i] = (pmesh_scene_level){ report->bytes + row->bytes,
                                                 row->faces, row->vertices,
                                                 row->error };
    }
    for (size_t i = 0; good && i < f->mux.piece_count; i++)
        good = put_piece(f, write, user, report, &f->mux.piece[i]);
    good = good &&
           put_whole(write, user, report,
                     f->mux.piece[f->mux.piece_count - 1].crc, PMESH_CHUNK_END,
                     f->payload, 0);
    report->faces = f->mux.now.faces;
    report->vertices = f->mux.now.vertices;
    report->bytes_header = report->bytes - report->bytes_document -
                           report->bytes_meshes - report->bytes_resources;
    return good ? PMESH_OK : PMESH_E_WRITE;
}

/* ---- the call ----------------------------------------------------------- */

static bool input_is_sound(const pmesh_scene_input *in)
{
    if (!in->meshes || in->mesh_count < 1 ||
        in->mesh_count > PMESH_MAX_SCENE_PARTS ||
        in->resource_count > PMESH_MAX_SCENE_PARTS ||
        in->early_count > in->resource_count ||
        in->document.size > PMESH_MAX_CHUNK_SIZE ||
        in->document_form > PMESH_DOCUMENT_ZLIB ||
        (in->document.size > 0 && !in->document.data) ||
        (in->resource_count > 0 && !in->resources))
        return false;
    for (size_t i = 0; i < in->resource_count; i++)
        if ((in->resources[i].size > 0 && !in->resources[i].data) ||
            (in->resource_offsets &&
             in->resources[i].size > PMESH_MAX_CHUNK_SIZE - 64))
            return false;
    for (size_t i = 0; i < in->mesh_count; i++) {
        const pmesh_scene_mesh_input *mesh = &in->meshes[i];
        if (!mesh->stream || !(mesh->scale >= 0 && mesh->scale <= FLT_MAX))
            return false;
    }
    return true;
}

static bool make_room(scene_file *f)
{
    const pmesh_allocator *a = &f->mux.allocator;
    const size_t meshes = f->mux.in->mesh_count;
    const size_t more = f->mux.in->resource_count;

    f->payload_room = HEAD_ROOM + ENTRY_ROOM * (meshes + more);
    f->stream = pmesh_alloc_zero(a, meshes, sizeof *f->stream);
    f->resource = pmesh_alloc_zero(a, more, sizeof *f->resource);
    f->payload = pmesh_alloc(a, f->payload_room, 1);
    return f->stream && f->resource && f->payload;
}

static void release(scene_file *f)
{
    const pmesh_allocator a = f->mux.allocator;
    const size_t meshes = f->mux.in->mesh_count;
    const size_t more = f->mux.in->resource_count;

    enc_mux_destroy(&f->mux);
    pmesh_release(&a, f->stream, meshes, sizeof *f->stream);
    pmesh_release(&a, f->resource, more, sizeof *f->resource);
    pmesh_release(&a, f->payload, f->payload_room, 1);
}

pmesh_status pmesh_scene_encode(const pmesh_scene_input *scene,
                                const pmesh_allocator *allocator,
                                pmesh_write write, void *user,
                                pmesh_scene_report *report)
{
    static const pmesh_allocator none = { NULL, NULL, NULL };
    pmesh_scene_report unwanted;
    scene_file f = { .stream = NULL };

    if (!scene || !write || !input_is_sound(scene) ||
        (allocator && !allocator->alloc != !allocator->release))
        return PMESH_E_ARGUMENT;
    const pmesh_allocator a =
        pmesh_allocator_resolve(allocator ? *allocator : none);
    if (!report)
        report = &unwanted;
    *report = (pmesh_scene_report){ 0 };
    pmesh_status status =
        enc_mux_build(&f.mux, scene, &a, &report->error_mesh);
    if (status == PMESH_OK && !make_room(&f))
        status = PMESH_E_MEMORY;
    if (status == PMESH_OK)
        status = fill_head(&f);
    if (status == PMESH_OK)
        status = write_file(&f, write, user, report);
    release(&f);
    return status;
}
