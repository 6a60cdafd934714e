/* SPDX-License-Identifier: MIT */
/*
 * dec_scene.c - creation, queries, and how a budget is shared.
 */
#include "decoder/dec_scene.h"

#include <string.h>

#include "decoder/dec_internal.h"
#include "format/alloc.h"

pmesh_status pmesh_scene_create(pmesh_scene **out,
                                const pmesh_scene_config *config)
{
    static const pmesh_scene_config plain = { .skip_resources = 0 };
    if (!out)
        return PMESH_E_ARGUMENT;
    *out = NULL;
    pmesh_scene_config c = config ? *config : plain;
    if (!c.decoder.allocator.alloc != !c.decoder.allocator.release)
        return PMESH_E_ARGUMENT;
    c.decoder.allocator = pmesh_allocator_resolve(c.decoder.allocator);
    if (c.decoder.max_memory == 0)
        c.decoder.max_memory = pmesh_decoder_config_default().max_memory;

    pmesh_scene *s = pmesh_alloc_zero(&c.decoder.allocator, 1, sizeof *s);
    if (!s)
        return PMESH_E_MEMORY;
    s->allocator = c.decoder.allocator;
    s->config = c;
    s->memory_left = c.decoder.max_memory;
    dec_frame_start(&s->frame);
    *out = s;
    return PMESH_OK;
}

void pmesh_scene_destroy(pmesh_scene *s)
{
    if (!s)
        return;
    const pmesh_allocator a = s->allocator;
    for (uint32_t i = 0; s->block && i < s->head.mesh_count; i++)
        pmesh_decoder_destroy(s->mesh[i].decoder);
    pmesh_release(&a, s->header, s->frame.size, 1);
    pmesh_release(&a, s->block, (size_t)s->block_size, 1);
    pmesh_release(&a, s, 1, sizeof *s);
}

pmesh_status pmesh_scene_probe(const void *data, size_t size)
{
    const uint8_t *bytes = (const uint8_t *)data;
    const size_t n = size < PMESH_SIGNATURE_SIZE ? size : PMESH_SIGNATURE_SIZE;

    if (n > 0 && memcmp(bytes, PMESH_SIGNATURE, n) != 0)
        return PMESH_E_MAGIC;
    if (size <= PMESH_SIGNATURE_SIZE)
        return PMESH_NEED_DATA;
    return bytes[PMESH_SIGNATURE_SIZE] == PMESH_CHUNK_SCENE
               ? PMESH_OK
               : PMESH_E_UNSUPPORTED;
}

pmesh_status pmesh_scene_feed(pmesh_scene *s, const void *data, size_t size)
{
    if (!s || (!data && size > 0))
        return PMESH_E_ARGUMENT;
    const dec_frame_owner owner = { s, dec_scene_begin, dec_scene_finish };
    return dec_frame_feed(&s->frame, &owner, data, size);
}

pmesh_decode_error pmesh_scene_error(const pmesh_scene *s)
{
    return s->frame.error;
}

pmesh_status pmesh_scene_get_header(const pmesh_scene *s,
                                    pmesh_scene_header *out)
{
    if (!s->has_header)
        return s->frame.error.status < 0 ? s->frame.error.status
                                         : PMESH_NEED_DATA;
    *out = (pmesh_scene_header){ .content_hash = s->head.content_hash,
                                 .document_form =
                                     (pmesh_document_form)s->head.document_form,
                                 .document_bytes = s->head.document_size,
                                 .mesh_count = s->head.mesh_count,
                                 .resource_count = s->head.resource_count,
                                 .level_count = s->head.level_count };
    for (uint32_t i = 0; i < s->head.level_count; i++) {
        const pmesh_scene_row *row = &s->head.levels[i];
        out->levels[i] =
            (pmesh_scene_level){ s->header_end + row->bytes, row->faces,
                                 row->vertices, row->error };
    }
    return PMESH_OK;
}

static bool has_base(const dec_scene_mesh *mesh)
{
    return mesh->decoder && mesh->levels > 0;
}

pmesh_scene_progress pmesh_scene_get_progress(const pmesh_scene *s)
{
    pmesh_scene_progress p = {
        .bytes = s->frame.whole,
        .document = s->has_header && s->document.received == s->document.size,
        .complete = s->frame.stage == DEC_END && s->frame.error.status >= 0
    };
    for (uint32_t i = 0; s->has_header && i < s->head.mesh_count; i++) {
        if (!has_base(&s->mesh[i]))
            continue;
        p.bases++;
        p.faces += pmesh_decoder_progress(s->mesh[i].decoder).faces;
    }
    return p;
}

pmesh_decoder *pmesh_scene_mesh(pmesh_scene *s, uint32_t mesh)
{
    return s->has_header && mesh < s->head.mesh_count ? s->mesh[mesh].decoder
                                                      : NULL;
}

float pmesh_scene_scale(const pmesh_scene *s, uint32_t mesh)
{
    return s->has_header && mesh < s->head.mesh_count ? s->stream[mesh].scale
                                                      : 0;
}

static pmesh_scene_bytes bytes_of(const dec_scene_part *part)
{
    return (pmesh_scene_bytes){ part->data, part->size, part->received };
}

pmesh_scene_bytes pmesh_scene_document(const pmesh_scene *s)
{
    return s->has_header ? bytes_of(&s->document) : (pmesh_scene_bytes){ 0 };
}

pmesh_scene_bytes pmesh_scene_resource(const pmesh_scene *s, uint32_t resource)
{
    return s->has_header && resource < s->head.resource_count
               ? bytes_of(&s->resource[resource])
               : (pmesh_scene_bytes){ 0 };
}

/* ---- one budget for many meshes ----------------------------------------- */

static const pmesh_level_entry *level_of(const dec_scene_mesh *mesh)
{
    return &mesh->decoder->header.levels[mesh->level];
}

/* In world units, of the level where the mesh stands. */
static double world_error(const pmesh_scene *s, uint32_t mesh)
{
    return (double)s->stream[mesh].scale *
           (double)level_of(&s->mesh[mesh])->error;
}

/* Whether mesh a is to be refined before b. */
static bool comes_first(const pmesh_scene *s, uint32_t a, uint32_t b)
{
    const double x = world_error(s, a), y = world_error(s, b);
    return x > y || (x >= y && a < b);
}

/* Moves heap[at] down to its place among the first `count`. */
static void sift(pmesh_scene *s, uint32_t at, uint32_t count)
{
    const uint32_t mesh = s->heap[at];
    for (;;) {
        uint32_t next = 2 * at + 1;
        if (next >= count)
            break;
        if (next + 1 < count &&
            comes_first(s, s->heap[next + 1], s->heap[next]))
            next++;
        if (!comes_first(s, s->heap[next], mesh))
            break;
        s->heap[at] = s->heap[next];
        at = next;
    }
    s->heap[at] = mesh;
}

/* All base meshes; returns how many there are, in the heap. */
static uint32_t take_bases(pmesh_scene *s, uint64_t *faces)
{
    uint32_t count = 0;

    *faces = 0;
    for (uint32_t i = 0; i < s->head.mesh_count; i++) {
        dec_scene_mesh *mesh = &s->mesh[i];
        if (!has_base(mesh))
            continue;
        mesh->level = 0;
        mesh->faces = level_of(mesh)->faces;
        *faces += mesh->faces;
        s->heap[count++] = i;
    }
    for (uint32_t i = count / 2; i-- > 0;)
        sift(s, i, count);
    return count;
}

/* How fine the mesh may become in its next step: a level, which may add no
 * face, or what there is of one. False if that is where it stands. */
static bool next_step(const dec_scene_mesh *mesh,
                      const pmesh_scene_target *target, uint32_t *faces)
{
    const uint32_t next = mesh->level + 1;
    *faces = mesh->faces;
    if (next < mesh->levels) {
        if (target->bytes > 0 && mesh->level_end[next] > target->bytes)
            return false;
        *faces = mesh->decoder->header.levels[next].faces;
        return true;
    }
    if (target->bytes == 0)
        *faces = pmesh_decoder_progress(mesh->decoder).faces;
    return *faces > mesh->faces;
}

static void share(pmesh_scene *s, const pmesh_scene_target *target)
{
    uint64_t faces;
    uint32_t count = take_bases(s, &faces);

    while (count > 0) {
        const uint32_t worst = s->heap[0];
        dec_scene_mesh *mesh = &s->mesh[worst];
        if (target->error > 0 && world_error(s, worst) <= target->error)
            break;
        uint32_t goal;
        const bool finer = next_step(mesh, target, &goal);
        const uint32_t more = goal - mesh->faces;
        const uint64_t left = target->faces == 0        ? UINT64_MAX
                              : target->faces > faces ? target->faces - faces
                                                      : 0;
        const uint32_t step = more < left ? more : (uint32_t)left;
        mesh->faces += step;
        faces += step;
        if (step < more)
            break;
        if (finer && mesh->level + 1 < mesh->levels)
            mesh->level++;
        else /* it cannot become finer */
            s->heap[0] = s->heap[--count];
        sift(s, 0, count);
    }
}

static void show(pmesh_scene *s, pmesh_scene_shown *shown)
{
    *shown = (pmesh_scene_shown){ 0 };
    for (uint32_t i = 0; i < s->head.mesh_count; i++) {
        const dec_scene_mesh *mesh = &s->mesh[i];
        const pmesh_target target = { .faces = mesh->faces };
        pmesh_view view;
        if (!has_base(mesh))
            continue;
        pmesh_decoder_refine(mesh->decoder, &target, NULL);
        if (pmesh_decoder_mesh(mesh->decoder, &view) != PMESH_OK)
            continue;
        const double error =
            (double)s->stream[i].scale * (double)view.error;
        shown->meshes++;
        shown->faces += view.face_count;
        shown->error = error > shown->error ? error : shown->error;
    }
}

static const pmesh_scene_target everything = { .faces = 0 };

pmesh_status pmesh_scene_share(pmesh_scene *s, const pmesh_scene_target *target,
                               uint32_t *faces)
{
    pmesh_status status = PMESH_NEED_DATA;

    if (!s->has_header)
        return status;
    share(s, target ? target : &everything);
    for (uint32_t i = 0; i < s->head.mesh_count; i++) {
        faces[i] = has_base(&s->mesh[i]) ? s->mesh[i].faces : 0;
        if (faces[i] > 0)
            status = PMESH_OK;
    }
    return status;
}

pmesh_status pmesh_scene_refine(pmesh_scene *s,
                                const pmesh_scene_target *target,
                                pmesh_scene_shown *shown)
{
    pmesh_scene_shown unwanted;

    if (!s->has_header)
        return PMESH_NEED_DATA;
    share(s, target ? target : &everything);
    show(s, shown ? shown : &unwanted);
    return (shown ? shown : &unwanted)->meshes > 0 ? PMESH_OK
                                                   : PMESH_NEED_DATA;
}
