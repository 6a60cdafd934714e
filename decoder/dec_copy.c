/* SPDX-License-Identifier: MIT */
/*
 * dec_copy.c - the visible mesh as floats and indices in the caller's memory.
 */
#include <string.h>

#include "decoder/dec_internal.h"
#include "format/quantize.h"

static uint8_t *tuple(void *dst, size_t stride, size_t packed, uint32_t i)
{
    return (uint8_t *)dst + (size_t)i * (stride ? stride : packed);
}

static const int32_t *grid_point(const pmesh_decoder *dec, uint32_t v)
{
    return dec->view.position ? dec->view.position[v]
                              : dec->codec.mesh.position[v];
}

/* Where parents move, only those that have come to rest are exact. */
void dec_position(const pmesh_decoder *dec, uint32_t v, float xyz[3])
{
    const int32_t *q = grid_point(dec, v);
    if (v < dec->exact.count &&
        memcmp(q, dec->codec.mesh.position[v], 3 * sizeof *q) == 0) {
        memcpy(xyz, dec->exact.position[v], 3 * sizeof *xyz);
        return;
    }
    for (int k = 0; k < 3; k++)
        xyz[k] = pmesh_narrow(
            pmesh_grid_dequantize(&dec->header.grid, k, q[k]));
}

void dec_value(const pmesh_decoder *dec, uint32_t attribute, uint32_t w,
               float value[PMESH_MAX_COMPONENTS])
{
    const pmesh_attribute *a = dec->header.attributes;
    const pmesh_mesh *m = &dec->codec.mesh;
    uint32_t offset = 0;
    for (uint32_t i = 0; i < attribute; i++)
        offset += pmesh_coded_components(&a[i]);
    pmesh_attribute_dequantize(
        &a[attribute], m->value + (size_t)w * m->value_count + offset, value);
}

static uint32_t visible_wedges(const pmesh_decoder *dec)
{
    return dec_wedges_at(dec, dec->view.vertices);
}

pmesh_status pmesh_decoder_copy_positions(const pmesh_decoder *dec, float *dst,
                                          size_t stride)
{
    float xyz[3];
    if (!dec->has_base)
        return PMESH_NEED_DATA;
    if (!dst || (stride && stride < sizeof xyz))
        return PMESH_E_ARGUMENT;
    const uint32_t count = visible_wedges(dec);
    dec_view_settle(dec);
    for (uint32_t w = 0; w < count; w++) {
        dec_position(dec, dec_mesh_vertex(dec, w), xyz);
        memcpy(tuple(dst, stride, sizeof xyz, w), xyz, sizeof xyz);
    }
    return PMESH_OK;
}

pmesh_status pmesh_decoder_copy_attribute(const pmesh_decoder *dec,
                                          uint32_t attribute, float *dst,
                                          size_t stride)
{
    float value[PMESH_MAX_COMPONENTS];
    if (!dec->has_base)
        return PMESH_NEED_DATA;
    if (!dst || attribute >= dec->header.attribute_count)
        return PMESH_E_ARGUMENT;
    const size_t size =
        dec->header.attributes[attribute].components * sizeof *dst;
    if (stride && stride < size)
        return PMESH_E_ARGUMENT;
    const uint32_t count = visible_wedges(dec);
    for (uint32_t w = 0; w < count; w++) {
        dec_value(dec, attribute, w, value);
        memcpy(tuple(dst, stride, size, w), value, size);
    }
    return PMESH_OK;
}

pmesh_status pmesh_decoder_copy_morph(pmesh_decoder *dec,
                                      const pmesh_target *coarse, float *dst,
                                      size_t stride)
{
    float xyz[3];
    if (!dec->has_base)
        return PMESH_NEED_DATA;
    if (!coarse || !dst || (stride && stride < sizeof xyz))
        return PMESH_E_ARGUMENT;
    const uint32_t fine = dec->view.vertices, count = visible_wedges(dec);
    uint32_t stop = dec_target_vertices(dec, coarse);
    stop = stop < fine ? stop : fine;
    dec_view_move(dec, stop, false);
    for (uint32_t w = 0; w < count; w++) {
        uint32_t v = dec_mesh_vertex(dec, w);
        while (v >= stop)
            v = dec->codec.mesh.parent[v];
        dec_position(dec, v, xyz);
        memcpy(tuple(dst, stride, sizeof xyz, w), xyz, sizeof xyz);
    }
    dec_view_move(dec, fine, false);
    return PMESH_OK;
}

static void put_triple(void *dst, uint32_t index_size, uint32_t at,
                       const uint32_t *index)
{
    if (index_size == 2) {
        const uint16_t narrow[3] = { (uint16_t)index[0], (uint16_t)index[1],
                                     (uint16_t)index[2] };
        memcpy((uint8_t *)dst + 6 * (size_t)at, narrow, sizeof narrow);
    } else {
        memcpy((uint8_t *)dst + 12 * (size_t)at, index, 12);
    }
}

static bool index_size_fits(const pmesh_decoder *dec, uint32_t size)
{
    return size == 0 || size == 4 ||
           (size == 2 && dec->header.sizes.wedges <= 65536);
}

/* Counting sort; a group's count serves as its fill while copying. */
static void copy_sorted(const pmesh_decoder *dec, void *dst,
                        uint32_t index_size, pmesh_range *groups)
{
    const uint32_t *material = dec->codec.mesh.material;
    const uint32_t materials = dec->header.sizes.material_count;
    const uint32_t faces = dec_faces_at(dec, dec->view.vertices);
    uint32_t first = 0;

    memset(groups, 0, materials * sizeof *groups);
    for (uint32_t f = 0; f < faces; f++)
        groups[material[f]].count++;
    for (uint32_t i = 0; i < materials; i++) {
        groups[i].first = first;
        first += groups[i].count;
        groups[i].count = 0;
    }
    for (uint32_t f = 0; f < faces; f++) {
        pmesh_range *g = &groups[material[f]];
        put_triple(dst, index_size, g->first + g->count++,
                   dec->view.index + 3 * (size_t)f);
    }
}

pmesh_status pmesh_decoder_copy_indices(const pmesh_decoder *dec, void *dst,
                                        uint32_t index_size,
                                        pmesh_range *groups)
{
    if (!dec->has_base)
        return PMESH_NEED_DATA;
    if (!dst || !index_size_fits(dec, index_size))
        return PMESH_E_ARGUMENT;
    const uint32_t faces = dec_faces_at(dec, dec->view.vertices);
    dec_view_settle(dec);
    if (groups && dec->codec.mesh.material) {
        copy_sorted(dec, dst, index_size, groups);
        return PMESH_OK;
    }
    for (uint32_t f = 0; f < faces; f++)
        put_triple(dst, index_size, f, dec->view.index + 3 * (size_t)f);
    if (groups)
        groups[0] = (pmesh_range){ 0, faces };
    return PMESH_OK;
}

static bool buffers_legal(const pmesh_decoder *dec, const pmesh_buffers *b)
{
    const pmesh_header_chunk *h = &dec->header;
    if (!index_size_fits(dec, b->index_size) ||
        (b->position_stride && b->position_stride < 3 * sizeof(float)))
        return false;
    for (uint32_t i = 0; i < PMESH_MAX_ATTRIBUTES; i++) {
        const size_t stride = b->attribute_strides[i];
        if (b->attributes[i] &&
            (i >= h->attribute_count ||
             (stride && stride < h->attributes[i].components * sizeof(float))))
            return false;
    }
    return true;
}

static void write_vertex(const pmesh_decoder *dec, uint32_t w)
{
    const pmesh_buffers *b = &dec->buffers;
    float value[PMESH_MAX_COMPONENTS];
    if (b->positions) {
        dec_position(dec, dec_mesh_vertex(dec, w), value);
        memcpy(tuple(b->positions, b->position_stride, 12, w), value, 12);
    }
    for (uint32_t i = 0; i < dec->header.attribute_count; i++) {
        const size_t size =
            dec->header.attributes[i].components * sizeof *value;
        if (!b->attributes[i])
            continue;
        dec_value(dec, i, w, value);
        memcpy(tuple(b->attributes[i], b->attribute_strides[i], size, w), value,
               size);
    }
}

void dec_write_bound(const pmesh_decoder *dec)
{
    const pmesh_buffers *b = &dec->buffers;
    const dec_changed *c = &dec->changed;
    const uint32_t faces = dec_faces_at(dec, dec->view.vertices);
    const uint32_t wedges = visible_wedges(dec);
    uint32_t i;

    for (i = dec_touched_next(&c->faces, 0, faces); b->indices && i < faces;
         i = dec_touched_next(&c->faces, i + 1, faces))
        put_triple(b->indices, b->index_size, i,
                   dec->view.index + 3 * (size_t)i);
    for (i = dec_touched_next(&c->vertices, 0, wedges); i < wedges;
         i = dec_touched_next(&c->vertices, i + 1, wedges))
        write_vertex(dec, i);
}

pmesh_status pmesh_decoder_bind(pmesh_decoder *dec,
                                const pmesh_buffers *buffers)
{
    if (!dec->has_header)
        return PMESH_NEED_DATA;
    if (buffers && !buffers_legal(dec, buffers))
        return PMESH_E_ARGUMENT;
    dec->bound = buffers != NULL;
    if (!buffers)
        return PMESH_OK;
    dec->buffers = *buffers;
    if (!dec->has_base)
        return PMESH_OK;
    dec_view_settle(dec);
    if (buffers->indices)
        pmesh_decoder_copy_indices(dec, buffers->indices, buffers->index_size,
                                   NULL);
    const uint32_t count = visible_wedges(dec);
    for (uint32_t w = 0; w < count; w++)
        write_vertex(dec, w);
    return PMESH_OK;
}
