/* SPDX-License-Identifier: MIT */
/*
 * dec_chunk.c - which chunks may come when, and what they hold (SPEC 5.2, 5.3,
 * 6.2, 6.3).
 */
#include <string.h>

#include "decoder/dec_internal.h"
#include "format/alloc.h"

static pmesh_status fail(pmesh_decoder *dec, pmesh_status status,
                         const char *rule)
{
    return dec_frame_fail(&dec->frame, status, rule);
}

static pmesh_status corrupt(pmesh_decoder *dec, const char *rule)
{
    return fail(dec, PMESH_E_CORRUPT, rule);
}

static bool all_levels(const pmesh_decoder *dec)
{
    return dec->has_base && dec->levels == dec->header.level_count;
}

/* Of a lossless file: there are vertices without their exact position. */
static bool lacks_exact(const pmesh_decoder *dec)
{
    return dec->header.exact_size > 0 &&
           dec->exact.count < dec->header.sizes.vertices;
}

static pmesh_status chunk_begin(void *self)
{
    pmesh_decoder *dec = (pmesh_decoder *)self;
    const uint8_t type = dec->frame.type;
    if (type == PMESH_CHUNK_HEADER) {
        dec->frame.to = dec->small;
        if (dec->has_header)
            return corrupt(dec, "SPEC 5.2: a second header");
        return dec->frame.size <= PMESH_MAX_HEADER_SIZE
                   ? PMESH_OK
                   : corrupt(dec, "SPEC 5.3: the header is too large");
    }
    if (!dec->has_header && type == PMESH_CHUNK_SCENE)
        return fail(dec, PMESH_E_UNSUPPORTED,
                    "SPEC 11.1: a scene of meshes: see pmesh_scene.h");
    if (!dec->has_header)
        return corrupt(dec, "SPEC 5.2: the first chunk is not the header");
    if (type >= PMESH_CHUNK_SKIPPABLE)
        return PMESH_OK;
    dec->frame.to = dec->payload;
    if (type > PMESH_CHUNK_POSITIONS || type == 0)
        return fail(dec, PMESH_E_VERSION,
                    "SPEC 5.2: an unknown critical chunk");
    if (type == PMESH_CHUNK_NAMES)
        return !dec->has_base && !dec->has_names &&
                       dec->frame.size == dec->header.names_size
                   ? PMESH_OK
                   : corrupt(dec, "SPEC 5.2: a names chunk out of place");
    if (type == PMESH_CHUNK_BASE && dec->has_base)
        return corrupt(dec, "SPEC 5.2: a second base mesh");
    if (type == PMESH_CHUNK_BASE && dec->header.base_coder &&
        !dec->config.base_decoder)
        return fail(dec, PMESH_E_UNSUPPORTED,
                    "SPEC 6.2: a Draco base mesh, and the decoder was "
                    "given no base_decoder");
    if (type != PMESH_CHUNK_BASE && !dec->has_base)
        return corrupt(dec, "SPEC 5.2: a chunk before the base mesh");
    if (type == PMESH_CHUNK_END)
        return all_levels(dec) && !lacks_exact(dec) && dec->frame.size == 0
                   ? PMESH_OK
                   : corrupt(dec, "SPEC 5.2: the end comes too early");
    if (type == PMESH_CHUNK_POSITIONS && !(all_levels(dec) && lacks_exact(dec)))
        return corrupt(dec, "SPEC 5.2: a positions chunk out of place");
    if ((type == PMESH_CHUNK_BLOCK || type == PMESH_CHUNK_BLOCK_LAST) &&
        all_levels(dec))
        return corrupt(dec, "SPEC 5.2: more levels than the header declares");
    return dec->frame.size <= dec->header.chunk_size
               ? PMESH_OK
               : corrupt(dec, "SPEC 5.2: a chunk larger than the header "
                              "declares");
}

static uint64_t aligned(uint64_t size)
{
    return (size + 15) / 16 * 16;
}

/* Codec, view, payload buffer, names, exact positions and marks of what changed,
 * in this order. */
static uint64_t measure(pmesh_codec *codec, const pmesh_header_chunk *h,
                        uint64_t part[6])
{
    const uint32_t payload =
        h->chunk_size > h->names_size ? h->chunk_size : h->names_size;
    part[0] = aligned(pmesh_codec_bind(codec, &h->sizes, NULL));
    part[1] = aligned(dec_view_bind(NULL, h, NULL));
    part[2] = aligned(payload);
    part[3] = aligned((uint64_t)h->names_size + 1);
    part[4] = h->exact_size == 0
                  ? 0
                  : aligned(pmesh_exact_bind(NULL, &h->grid, h->exact_form,
                                             h->sizes.vertices, NULL));
    part[5] = dec_changed_bind(NULL, h, NULL);
    return part[0] + part[1] + part[2] + part[3] + part[4] + part[5];
}

static pmesh_status allocate(pmesh_decoder *dec)
{
    const pmesh_header_chunk *h = &dec->header;
    uint64_t part[6];
    dec->block_size = measure(&dec->codec, h, part);
    if (h->sizes.faces > dec->config.max_faces ||
        dec->block_size > dec->config.max_memory ||
        dec->block_size > SIZE_MAX)
        return fail(dec, PMESH_E_LIMIT,
                    "the mesh is larger than the decoder's limits");
    uint8_t *at = pmesh_alloc(&dec->allocator, 1, (size_t)dec->block_size);
    if (!at)
        return fail(dec, PMESH_E_MEMORY, "no memory for the mesh");
    dec->block = at;
    pmesh_codec_bind(&dec->codec, &h->sizes, at);
    dec_view_bind(&dec->view, h, at + part[0]);
    dec->payload = at + part[0] + part[1];
    dec->names = (char *)at + part[0] + part[1] + part[2];
    memset(dec->names, 0, h->names_size + 1);
    at += part[0] + part[1] + part[2] + part[3];
    if (h->exact_size > 0)
        pmesh_exact_bind(&dec->exact, &h->grid, h->exact_form,
                         h->sizes.vertices, at);
    dec_changed_bind(&dec->changed, h, at + part[4]);

    memcpy(dec->codec.bounds, h->bounds, sizeof dec->codec.bounds);
    pmesh_codec_limit_values(&dec->codec, h->attributes, h->attribute_count);
    return PMESH_OK;
}

static pmesh_status take_header(pmesh_decoder *dec)
{
    pmesh_cursor in = pmesh_cursor_make(dec->small, dec->frame.size);
    const char *rule = NULL;
    pmesh_status status = pmesh_header_read(&in, &dec->header, &rule);
    if (status != PMESH_OK)
        return fail(dec, status, rule);
    status = allocate(dec);
    if (status != PMESH_OK)
        return status;
    dec->has_header = true;
    dec->header_end = dec->frame.offset;
    return PMESH_OK;
}

/* The counts of the level table bind what was decoded. */
static pmesh_status finish_level(pmesh_decoder *dec)
{
    const pmesh_level_entry *e = &dec->header.levels[dec->levels];
    const pmesh_mesh *m = &dec->codec.mesh;
    if (m->face_count != e->faces || m->vertex_count != e->vertices ||
        m->wedge_count != e->wedges)
        return corrupt(dec, "SPEC 6.3: a level differs from the level table");
    dec->levels++;
    dec->in_level = false;
    return PMESH_OK;
}

/* The Draco buffer at the start of a payload, and its size before it. */
static pmesh_status take_draco(pmesh_decoder *dec, pmesh_cursor *in)
{
    const pmesh_header_chunk *h = &dec->header;
    const uint64_t size = pmesh_get_varint(in);
    if (in->overrun || size > (size_t)(in->end - in->next)) {
        dec->codec.rule = "SPEC 6.2: a Draco buffer larger than its chunk";
        return PMESH_E_CORRUPT;
    }
    const pmesh_base_source source = { dec->config.base_decoder,
                                       dec->config.base_user, in->next,
                                       (size_t)size };
    in->next += size;
    return pmesh_base_import(&dec->codec, &source, h->base_vertices,
                             h->sizes.base_faces);
}

static pmesh_status take_base(pmesh_decoder *dec)
{
    pmesh_cursor in = pmesh_cursor_make(dec->payload, dec->frame.size);
    const pmesh_header_chunk *h = &dec->header;
    const bool native = h->base_coder == PMESH_BASE_NATIVE;
    pmesh_status status = native ? PMESH_OK : take_draco(dec, &in);
    if (status != PMESH_OK)
        return fail(dec, status, dec->codec.rule);

    pmesh_coder coder;
    pmesh_coder_decode(&coder, in.next, (size_t)(in.end - in.next));
    if (native)
        status = pmesh_base_code(&dec->codec, &coder, NULL, h->base_vertices,
                                 h->sizes.base_faces);
    if (status == PMESH_OK)
        status = pmesh_base_attributes_code(&dec->codec, &coder, NULL,
                                            h->base_wedges);
    if (status != PMESH_OK)
        return fail(dec, status, dec->codec.rule);
    if (!pmesh_coder_finish(&coder))
        return corrupt(dec, "SPEC 6.1: bytes behind the base mesh");
    status = finish_level(dec);
    if (status != PMESH_OK)
        return status;
    dec->has_base = true;
    dec->changed.base = true;
    dec_view_start(dec);
    return PMESH_OK;
}

static pmesh_status take_splits(pmesh_decoder *dec, pmesh_coder *coder,
                                uint32_t splits)
{
    const pmesh_status status =
        pmesh_block_code(&dec->codec, coder, NULL, splits);
    if (status != PMESH_OK)
        return fail(dec, status, dec->codec.rule);
    if (!pmesh_coder_finish(coder))
        return corrupt(dec, "SPEC 6.1: bytes behind a block");
    return dec_view_append(dec)
               ? PMESH_OK
               : corrupt(dec, "SPEC 5.3: more moved corners than declared");
}

static pmesh_status take_block(pmesh_decoder *dec)
{
    pmesh_cursor in = pmesh_cursor_make(dec->payload, dec->frame.size);
    const uint32_t splits = pmesh_get_count(&in, PMESH_MAX_BLOCK_SPLITS);
    if (in.overrun || splits == 0)
        return corrupt(dec, "SPEC 6.3: a block's count is out of range");
    if (!dec->in_level)
        pmesh_level_begin(&dec->codec);
    dec->in_level = true;

    pmesh_coder coder;
    pmesh_coder_decode(&coder, in.next, (size_t)(in.end - in.next));
    dec_view_raise(dec);
    const pmesh_status status = take_splits(dec, &coder, splits);
    if (status != PMESH_OK) {
        dec_view_restore(dec);
        return status;
    }
    return dec->frame.type == PMESH_CHUNK_BLOCK_LAST ? finish_level(dec) : PMESH_OK;
}

/* The count that others see changes once the chunk is known to be good. */
static pmesh_status take_positions(pmesh_decoder *dec)
{
    const uint32_t before = dec->exact.count;
    pmesh_cursor in = pmesh_cursor_make(dec->payload, dec->frame.size);
    const uint32_t count =
        pmesh_get_count(&in, dec->header.sizes.vertices - before);
    if (in.overrun || count == 0)
        return corrupt(dec, "SPEC 6.8: a count of positions is out of range");

    pmesh_coder coder;
    pmesh_coder_decode(&coder, in.next, (size_t)(in.end - in.next));
    bool good = true;
    while (good && dec->exact.count - before < count)
        good = pmesh_exact_code(&dec->exact, &coder, &dec->codec.mesh);
    if (good && pmesh_coder_finish(&coder))
        return PMESH_OK;
    dec->exact.count = before;
    return corrupt(dec, good ? "SPEC 6.1: bytes behind positions"
                             : "SPEC 6.8: a position is out of reach");
}

static pmesh_status take_end(pmesh_decoder *dec)
{
    return dec->frame.hash == dec->header.content_hash
               ? PMESH_OK
               : corrupt(dec, "SPEC 5.3: the content hash does not match");
}

static pmesh_status chunk_finish(void *self)
{
    pmesh_decoder *dec = (pmesh_decoder *)self;
    switch (dec->frame.type) {
    case PMESH_CHUNK_HEADER:
        return take_header(dec);
    case PMESH_CHUNK_NAMES:
        memcpy(dec->names, dec->payload, dec->frame.size);
        dec->has_names = true;
        return PMESH_OK;
    case PMESH_CHUNK_BASE:
        return take_base(dec);
    case PMESH_CHUNK_POSITIONS:
        return take_positions(dec);
    case PMESH_CHUNK_END:
        return take_end(dec);
    default:
        return take_block(dec);
    }
}

pmesh_status pmesh_decoder_feed(pmesh_decoder *dec, const void *data,
                                size_t size)
{
    if (!dec || (!data && size > 0))
        return PMESH_E_ARGUMENT;
    const dec_frame_owner owner = { dec, chunk_begin, chunk_finish };
    return dec_frame_feed(&dec->frame, &owner, data, size);
}
