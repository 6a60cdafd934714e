/* SPDX-License-Identifier: MIT */
/*
 * dec_scene_part.c - which chunks may come when, and where their bytes go
 * (SPEC 11).
 */
#include <string.h>

#include "decoder/dec_internal.h"
#include "decoder/dec_scene.h"
#include "format/alloc.h"

static pmesh_status fail(pmesh_scene *s, pmesh_status status,
                         const char *rule)
{
    return dec_frame_fail(&s->frame, status, rule);
}

static pmesh_status corrupt(pmesh_scene *s, const char *rule)
{
    return fail(s, PMESH_E_CORRUPT, rule);
}

static pmesh_status begin_header(pmesh_scene *s)
{
    if (s->has_header)
        return corrupt(s, "SPEC 11.1: a second header");
    if (s->frame.size > PMESH_MAX_SCENE_HEADER)
        return corrupt(s, "SPEC 11.2: the header is too large");
    s->header = pmesh_alloc(&s->allocator, s->frame.size, 1);
    s->frame.to = s->header;
    return s->header ? PMESH_OK
                     : fail(s, PMESH_E_MEMORY, "no memory for the header");
}

pmesh_status dec_scene_begin(void *scene)
{
    pmesh_scene *s = (pmesh_scene *)scene;
    const uint8_t type = s->frame.type;
    if (type == PMESH_CHUNK_SCENE)
        return begin_header(s);
    if (!s->has_header)
        return type == PMESH_CHUNK_HEADER
                   ? fail(s, PMESH_E_UNSUPPORTED,
                          "SPEC 11.1: a single mesh, not a scene")
                   : corrupt(s, "SPEC 5.2: the first chunk is not the header");
    if (type >= PMESH_CHUNK_SKIPPABLE)
        return PMESH_OK;
    s->frame.to = s->payload;
    if (type == PMESH_CHUNK_END)
        return s->frame.size == 0
                   ? PMESH_OK
                   : corrupt(s, "SPEC 11.1: the end is not empty");
    if (type != PMESH_CHUNK_PART)
        return fail(s, PMESH_E_VERSION,
                    "SPEC 11.1: an unknown critical chunk");
    return s->frame.size <= s->head.chunk_size
               ? PMESH_OK
               : corrupt(s, "SPEC 11.2: a chunk larger than the header "
                            "declares");
}

/* ---- the header --------------------------------------------------------- */

/* The next `size` bytes of the block, aligned; of no block, their measure. */
static void *carve(uint8_t *block, uint64_t *at, uint64_t size)
{
    void *array = block ? block + *at : NULL;
    *at += (size + 15) / 16 * 16;
    return array;
}

/* The arrays whose lengths the head tells; resources follow once their sizes
 * are known. */
static uint64_t bind_arrays(pmesh_scene *s, uint8_t *block, uint64_t **sizes)
{
    const uint64_t meshes = s->head.mesh_count;
    const uint64_t resources = s->head.resource_count;
    uint64_t at = 0;

    s->mesh = carve(block, &at, meshes * sizeof *s->mesh);
    s->stream = carve(block, &at, meshes * sizeof *s->stream);
    s->heap = carve(block, &at, meshes * sizeof *s->heap);
    s->resource = carve(block, &at, resources * sizeof *s->resource);
    *sizes = carve(block, &at, resources * sizeof **sizes);
    s->payload = carve(block, &at, s->head.chunk_size);
    s->document.data = carve(block, &at, s->head.document_size);
    s->document.size = s->head.document_size;
    return at;
}

/*
 * The sum of the resources' sizes stands at the end of the header, behind what
 * is to be stored in the block: so the lists are walked once for the sum.
 */
static uint64_t resource_bytes(const pmesh_scene *s, pmesh_cursor in)
{
    uint64_t total = 0;

    for (uint32_t i = 0; i < s->head.mesh_count; i++) {
        pmesh_get_varint(&in);
        pmesh_get_f32(&in);
    }
    for (uint32_t i = 0; i < s->head.resource_count; i++) {
        const uint64_t size = pmesh_get_varint(&in);
        if (size > PMESH_MAX_FILE - total)
            return PMESH_MAX_FILE;
        total += size;
    }
    return total;
}

static pmesh_status allocate(pmesh_scene *s, pmesh_cursor in,
                             uint64_t **sizes)
{
    uint64_t most = bind_arrays(s, NULL, sizes);
    const uint64_t arrays = most;
    if (!s->config.skip_resources)
        most += resource_bytes(s, in);
    if (most > s->memory_left || most > SIZE_MAX)
        return fail(s, PMESH_E_LIMIT,
                    "the scene is larger than the memory limit");
    uint8_t *block = pmesh_alloc(&s->allocator, (size_t)most, 1);
    if (!block)
        return fail(s, PMESH_E_MEMORY, "no memory for the scene");
    s->block = block;
    s->block_size = most;
    s->memory_left -= most;
    bind_arrays(s, block, sizes);
    memset(block, 0, (size_t)arrays);
    return PMESH_OK;
}

static pmesh_status take_header(pmesh_scene *s)
{
    pmesh_cursor in = pmesh_cursor_make(s->header, s->frame.size);
    const char *rule = NULL;
    uint64_t *sizes;

    pmesh_status status = pmesh_scene_head_read(&in, &s->head, &rule);
    if (status != PMESH_OK)
        return fail(s, status, rule);
    status = allocate(s, in, &sizes);
    if (status != PMESH_OK)
        return status;
    status = pmesh_scene_lists_read(&in, &s->head, s->stream, sizes, &rule);
    if (status != PMESH_OK)
        return fail(s, status, rule);
    uint64_t *unused;
    uint8_t *at = (uint8_t *)s->block;
    at += bind_arrays(s, at, &unused);
    for (uint32_t i = 0; i < s->head.resource_count; i++) {
        s->resource[i].size = sizes[i];
        s->resource[i].data = s->config.skip_resources ? NULL : at;
        at += s->config.skip_resources ? 0 : sizes[i];
    }
    pmesh_release(&s->allocator, s->header, s->frame.size, 1);
    s->header = NULL;
    s->has_header = true;
    s->header_end = s->frame.offset;
    return PMESH_OK;
}

/* ---- parts -------------------------------------------------------------- */

static pmesh_status take_bytes(pmesh_scene *s, dec_scene_part *part,
                               const uint8_t *data, size_t size)
{
    if (size > part->size - part->received)
        return corrupt(s, "SPEC 11.3: more bytes than the part has");
    if (part->data)
        memcpy(part->data + part->received, data, size);
    part->received += size;
    return PMESH_OK;
}

static pmesh_status begin_mesh(pmesh_scene *s, dec_scene_mesh *mesh)
{
    pmesh_decoder_config config = s->config.decoder;

    if (s->memory_left <= sizeof(struct pmesh_decoder))
        return fail(s, PMESH_E_LIMIT,
                    "the scene is larger than the memory limit");
    s->memory_left -= sizeof(struct pmesh_decoder);
    const pmesh_status status = pmesh_decoder_create(&mesh->decoder, &config);
    return status == PMESH_OK
               ? status
               : fail(s, status, "no memory for a mesh");
}

/* How far the mesh came, and what it took. */
static void look(pmesh_scene *s, dec_scene_mesh *mesh)
{
    const struct pmesh_decoder *dec = mesh->decoder;
    if (!mesh->counted && dec->has_header) {
        mesh->counted = true;
        s->memory_left -= dec->block_size < s->memory_left ? dec->block_size
                                                           : s->memory_left;
    }
    while (mesh->levels < pmesh_decoder_progress(dec).levels)
        mesh->level_end[mesh->levels++] = s->frame.offset;
}

static pmesh_status take_mesh(pmesh_scene *s, uint32_t number,
                              const uint8_t *data, size_t size)
{
    dec_scene_mesh *mesh = &s->mesh[number];

    if (size > s->stream[number].size - mesh->received)
        return corrupt(s, "SPEC 11.3: more bytes than the part has");
    if (!mesh->decoder) {
        const pmesh_status status = begin_mesh(s, mesh);
        if (status != PMESH_OK)
            return status;
    }
    if (!mesh->counted) /* what others left since it was made */
        mesh->decoder->config.max_memory = s->memory_left;
    mesh->received += size;
    const pmesh_status status =
        pmesh_decoder_feed(mesh->decoder, data, size);
    look(s, mesh);
    return status >= 0 ? PMESH_OK
                       : fail(s, status,
                              pmesh_decoder_error(mesh->decoder).rule);
}

static pmesh_status take_part(pmesh_scene *s)
{
    const pmesh_scene_head *h = &s->head;
    pmesh_cursor in = pmesh_cursor_make(s->payload, s->frame.size);
    const uint64_t number = pmesh_get_varint(&in);
    const size_t size = (size_t)(in.end - in.next);

    if (in.overrun || size == 0 ||
        number > (uint64_t)h->mesh_count + h->resource_count)
        return corrupt(s, "SPEC 11.3: a part that is not there, or no bytes");
    if (number == 0)
        return take_bytes(s, &s->document, in.next, size);
    if (number <= h->mesh_count)
        return take_mesh(s, (uint32_t)number - 1, in.next, size);
    return take_bytes(s, &s->resource[number - 1 - h->mesh_count], in.next,
                      size);
}

static pmesh_status take_end(pmesh_scene *s)
{
    bool whole = s->document.received == s->document.size;

    for (uint32_t i = 0; i < s->head.resource_count; i++)
        whole = whole && s->resource[i].received == s->resource[i].size;
    for (uint32_t i = 0; i < s->head.mesh_count; i++)
        whole = whole && s->mesh[i].received == s->stream[i].size &&
                s->mesh[i].decoder &&
                pmesh_decoder_progress(s->mesh[i].decoder).complete;
    if (!whole)
        return corrupt(s, "SPEC 11.3: the end comes before all parts");
    return s->frame.hash == s->head.content_hash
               ? PMESH_OK
               : corrupt(s, "SPEC 11.2: the content hash does not match");
}

pmesh_status dec_scene_finish(void *scene)
{
    pmesh_scene *s = (pmesh_scene *)scene;
    switch (s->frame.type) {
    case PMESH_CHUNK_SCENE:
        return take_header(s);
    case PMESH_CHUNK_PART:
        return take_part(s);
    default:
        return take_end(s);
    }
}
