/* SPDX-License-Identifier: MIT */
/*
 * dec_api.c - creation and queries.
 */
#include <string.h>

#include "decoder/dec_internal.h"
#include "format/alloc.h"
#include "format/inflate.h"
#include "format/quantize.h"

#define DEFAULT_MEMORY ((uint64_t)4 << 30)

enum { END_CHUNK_SIZE = 2 + PMESH_CRC_SIZE };

pmesh_decoder_config pmesh_decoder_config_default(void)
{
    return (pmesh_decoder_config){ .max_memory = DEFAULT_MEMORY,
                                   .max_faces = PMESH_MAX_FACES };
}

pmesh_status pmesh_decoder_create(pmesh_decoder **out,
                                  const pmesh_decoder_config *config)
{
    if (!out)
        return PMESH_E_ARGUMENT;
    *out = NULL;
    pmesh_decoder_config c =
        config ? *config : pmesh_decoder_config_default();
    if (!c.allocator.alloc != !c.allocator.release)
        return PMESH_E_ARGUMENT;
    c.allocator = pmesh_allocator_resolve(c.allocator);
    if (c.max_memory == 0)
        c.max_memory = DEFAULT_MEMORY;
    if (c.max_faces == 0)
        c.max_faces = PMESH_MAX_FACES;

    pmesh_decoder *dec = pmesh_alloc_zero(&c.allocator, 1, sizeof *dec);
    if (!dec)
        return PMESH_E_MEMORY;
    dec->self = dec;
    dec->allocator = c.allocator;
    dec->config = c;
    dec_frame_start(&dec->frame);
    *out = dec;
    return PMESH_OK;
}

void pmesh_decoder_destroy(pmesh_decoder *dec)
{
    if (!dec)
        return;
    const pmesh_allocator a = dec->allocator;
    pmesh_release(&a, dec->block, 1, (size_t)dec->block_size);
    pmesh_release(&a, dec, 1, sizeof *dec);
}

pmesh_decode_error pmesh_decoder_error(const pmesh_decoder *dec)
{
    return dec->frame.error;
}

static float measured(const pmesh_decoder *dec, uint32_t units)
{
    return pmesh_narrow(dec->header.grid.step * units / PMESH_MEASURE_UNIT);
}

static pmesh_level level_of(const pmesh_decoder *dec, uint32_t i)
{
    const pmesh_level_entry *e = &dec->header.levels[i];
    return (pmesh_level){ .bytes = dec->header_end + e->bytes,
                          .faces = e->faces,
                          .mesh_vertices = e->vertices,
                          .vertices = e->wedges,
                          .error = e->error,
                          .inflation =
                              (float)e->inflation / PMESH_INFLATE_ONE,
                          .rms = measured(dec, e->rms),
                          .furthest = measured(dec, e->most) };
}

pmesh_status pmesh_decoder_header(const pmesh_decoder *dec, pmesh_header *out)
{
    if (!dec->has_header)
        return dec->frame.error.status < 0 ? dec->frame.error.status
                                           : PMESH_NEED_DATA;
    const pmesh_header_chunk *h = &dec->header;
    *out = (pmesh_header){
        .format_version = PMESH_FORMAT_VERSION,
        .content_hash = h->content_hash,
        .profile = h->profile,
        .placement = h->sizes.moves ? PMESH_OPTIMAL : PMESH_SUBSET,
        .base_coder = h->base_coder,
        .joined = h->sizes.joined,
        .grid = h->grid,
        .faces = h->sizes.faces,
        .mesh_vertices = h->sizes.vertices,
        .vertices = h->sizes.wedges,
        .base_faces = h->sizes.base_faces,
        .base_mesh_vertices = h->base_vertices,
        .base_vertices = h->base_wedges,
        .material_count = h->sizes.material_count,
        .attribute_count = h->attribute_count,
        .level_count = h->level_count,
        .exact_bytes = h->exact_size,
        .memory = dec->block_size,
        .measured = h->measured,
    };
    memcpy(out->bounds, h->bounds, sizeof out->bounds);
    memcpy(out->attributes, h->attributes, sizeof out->attributes);
    for (uint32_t i = 0; i < h->level_count; i++)
        out->levels[i] = level_of(dec, i);
    out->bytes = out->levels[h->level_count - 1].bytes + h->exact_size +
                 END_CHUNK_SIZE;
    return PMESH_OK;
}

pmesh_progress_state pmesh_decoder_progress(const pmesh_decoder *dec)
{
    return (pmesh_progress_state){
        .bytes = dec->frame.whole,
        .faces = dec->has_base ? dec_faces_at(dec, dec->view.decoded) : 0,
        .levels = dec->levels,
        .exact_vertices = dec->exact.count,
        .complete = dec->frame.stage == DEC_END && dec->frame.error.status >= 0
    };
}

/* The error of the finest complete level at or below the visible mesh. */
static float visible_error(const pmesh_decoder *dec)
{
    float error = dec->header.levels[0].error;
    for (uint32_t i = 0; i < dec->levels; i++)
        if (dec->header.levels[i].vertices <= dec->view.vertices)
            error = dec->header.levels[i].error;
    return error;
}

pmesh_status pmesh_decoder_mesh(const pmesh_decoder *dec, pmesh_view *out)
{
    if (!dec->has_base)
        return PMESH_NEED_DATA;
    const pmesh_mesh *m = &dec->codec.mesh;
    const dec_view *view = &dec->view;
    dec_view_settle(dec);
    *out = (pmesh_view){
        .vertex_count = dec_wedges_at(dec, view->vertices),
        .mesh_vertex_count = view->vertices,
        .face_count = dec_faces_at(dec, view->vertices),
        .indices = view->index,
        .positions_of = m->wedge_vertex,
        .positions =
            view->position ? &view->position[0][0] : &m->position[0][0],
        .values = m->value,
        .value_stride = m->value_count,
        .materials = m->material,
        .error = visible_error(dec)
    };
    return PMESH_OK;
}

/* Names are stored one after the other, each with its final 0. */
const char *pmesh_decoder_material_name(const pmesh_decoder *dec,
                                        uint32_t material)
{
    if (!dec->has_names)
        return "";
    const char *name = dec->names;
    const char *end = dec->names + dec->header.names_size;
    for (; material > 0 && name < end; name++) /* a 0 stands at `end` too */
        material -= *name == 0;
    return name < end ? name : "";
}

uint32_t pmesh_decoder_parent(const pmesh_decoder *dec, uint32_t mesh_vertex)
{
    return dec->has_base && mesh_vertex < dec->view.decoded
               ? dec->codec.mesh.parent[mesh_vertex]
               : PMESH_NONE;
}
