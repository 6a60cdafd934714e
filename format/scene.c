/* SPDX-License-Identifier: MIT */
#include "format/scene.h"

#include "format/layout.h"

static void write_levels(pmesh_writer *out, const pmesh_scene_head *h)
{
    pmesh_scene_row last = { 0 };

    pmesh_put(out, h->level_count, 1);
    for (uint32_t i = 0; i < h->level_count; i++) {
        const pmesh_scene_row *row = &h->levels[i];
        pmesh_put_varint(out, row->bytes - last.bytes);
        pmesh_put_varint(out, row->faces - last.faces);
        pmesh_put_varint(out, row->vertices - last.vertices);
        pmesh_put_f32(out, row->error);
        last = *row;
    }
}

void pmesh_scene_head_write(pmesh_writer *out, const pmesh_scene_head *h,
                            const pmesh_scene_stream *meshes,
                            const uint64_t *resources)
{
    pmesh_put(out, PMESH_SCENE_VERSION, 1);
    pmesh_put(out, h->content_hash, 8);
    pmesh_put_varint(out, h->chunk_size);
    pmesh_put(out, h->document_form, 1);
    pmesh_put_varint(out, h->document_size);
    pmesh_put_varint(out, h->mesh_count);
    pmesh_put_varint(out, h->resource_count);
    write_levels(out, h);
    for (uint32_t i = 0; i < h->mesh_count; i++) {
        pmesh_put_varint(out, meshes[i].size);
        pmesh_put_f32(out, meshes[i].scale);
    }
    for (uint32_t i = 0; i < h->resource_count; i++)
        pmesh_put_varint(out, resources[i]);
}

/* Not NaN, not infinite, not negative. */
static bool is_amount(float x)
{
    return x - x == 0 && x >= 0;
}

/* `last` plus a difference, which must stay below `limit`. */
static uint64_t sum_within(pmesh_cursor *in, uint64_t last, uint64_t limit)
{
    const uint64_t more = pmesh_get_varint(in);
    if (more <= limit - last)
        return last + more;
    in->overrun = true;
    return last;
}

static const char *read_levels(pmesh_cursor *in, pmesh_scene_head *h)
{
    pmesh_scene_row last = { 0 };

    h->level_count = pmesh_get_u8(in);
    if (h->level_count < 1 || h->level_count > PMESH_MAX_LEVELS)
        return "SPEC 11.2: 1 to 64 levels";
    for (uint32_t i = 0; i < h->level_count; i++) {
        pmesh_scene_row *row = &h->levels[i];
        row->bytes = sum_within(in, last.bytes, PMESH_MAX_FILE);
        row->faces = sum_within(in, last.faces, PMESH_MAX_FILE);
        row->vertices = sum_within(in, last.vertices, PMESH_MAX_FILE);
        row->error = pmesh_get_f32(in);
        if (!is_amount(row->error) || (i > 0 && row->error > last.error))
            return "SPEC 11.2: a level's error is not a distance that falls";
        last = *row;
    }
    return NULL;
}

pmesh_status pmesh_scene_head_read(pmesh_cursor *in, pmesh_scene_head *h,
                                   const char **rule)
{
    if (pmesh_get_u8(in) != PMESH_SCENE_VERSION && !in->overrun) {
        *rule = "SPEC 11.2: an unknown version of scenes";
        return PMESH_E_VERSION;
    }
    h->content_hash = pmesh_get(in, 8);
    h->chunk_size = pmesh_get_count(in, PMESH_MAX_CHUNK_SIZE);
    h->document_form = pmesh_get_u8(in);
    if (h->document_form > PMESH_DOCUMENT_ZLIB && !in->overrun) {
        *rule = "SPEC 11.2: an unknown form of the document";
        return PMESH_E_CORRUPT;
    }
    h->document_size = pmesh_get_count(in, PMESH_MAX_CHUNK_SIZE);
    h->mesh_count = pmesh_get_count(in, PMESH_MAX_SCENE_PARTS);
    h->resource_count = pmesh_get_count(in, PMESH_MAX_SCENE_PARTS);
    *rule = read_levels(in, h);
    if (!*rule && (in->overrun || h->mesh_count == 0))
        *rule = "SPEC 11.2: a count is out of range";
    if (in->overrun && in->next == in->end) /* it reads as 0 from there on */
        *rule = "SPEC 11.2: the header's size does not fit its fields";
    return *rule ? PMESH_E_CORRUPT : PMESH_OK;
}

pmesh_status pmesh_scene_lists_read(pmesh_cursor *in,
                                    const pmesh_scene_head *h,
                                    pmesh_scene_stream *meshes,
                                    uint64_t *resources, const char **rule)
{
    uint64_t total = 0; /* keeps the sum of all sizes in bounds, too */

    *rule = NULL;
    for (uint32_t i = 0; i < h->mesh_count && !*rule; i++) {
        const uint64_t before = total;
        total = sum_within(in, total, PMESH_MAX_FILE);
        meshes[i].size = total - before;
        meshes[i].scale = pmesh_get_f32(in);
        if (!is_amount(meshes[i].scale))
            *rule = "SPEC 11.2: a mesh's scale is not a factor";
    }
    for (uint32_t i = 0; i < h->resource_count && !*rule; i++) {
        const uint64_t before = total;
        total = sum_within(in, total, PMESH_MAX_FILE);
        resources[i] = total - before;
    }
    if (!*rule && (in->overrun || in->next != in->end))
        *rule = "SPEC 11.2: the header's size does not fit its fields";
    return *rule ? PMESH_E_CORRUPT : PMESH_OK;
}
