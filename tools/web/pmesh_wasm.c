/* SPDX-License-Identifier: MIT */
/*
 * pmesh_wasm.c - the decoder as a WebAssembly module without imports: one mesh
 * for each instance, so that letting go of the instance frees all its memory,
 * and a hostile file has nothing but its own to harm.
 *
 * JavaScript (src/decoder.js) reads numbers as lists of doubles, whose order is
 * here and there. Buffers are made once, right behind the header: the memory
 * does not grow afterwards, so views into it stay valid.
 */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "decoder/pmesh_decode.h"

#define EXPORT(name) __attribute__((export_name(#name)))

enum { INPUT_SIZE = 65536, PAGE = 65536, INFO_SIZE = 1024 };

static struct {
    pmesh_decoder *dec;
    pmesh_buffers buffers;
    pmesh_changes changes;
    pmesh_header header;
    void *sorted; /* indices by material, if there are several */
    pmesh_range *groups;
    float *morph; /* if asked for */
    double list[INFO_SIZE]; /* answers */
    uint8_t input[INPUT_SIZE];
} self;

/* Memory grows and is never given back: the decoder takes two blocks, and this
 * file its buffers. */
extern unsigned char __heap_base;
static size_t heap_end;

void *malloc(size_t size)
{
    if (heap_end == 0)
        heap_end = ((size_t)&__heap_base + 15) / 16 * 16;
    const size_t room = (size_t)__builtin_wasm_memory_size(0) * PAGE - heap_end;
    if (size > SIZE_MAX - 2 * PAGE - heap_end)
        return NULL;
    size = (size + 15) / 16 * 16;
    if (size > room) {
        const size_t pages = (size - room + PAGE - 1) / PAGE;
        if (__builtin_wasm_memory_grow(0, pages) == SIZE_MAX)
            return NULL;
    }
    void *at = (void *)heap_end;
    heap_end += size;
    return at;
}

void free(void *ptr)
{
    (void)ptr;
}

int memcmp(const void *a, const void *b, size_t size)
{
    const uint8_t *x = a, *y = b;
    for (; size > 0; size--, x++, y++)
        if (*x != *y)
            return *x < *y ? -1 : 1;
    return 0;
}

EXPORT(create) int create(double max_memory)
{
    pmesh_decoder_config config = pmesh_decoder_config_default();
    config.max_memory = (uint64_t)max_memory;
    return pmesh_decoder_create(&self.dec, &config);
}

EXPORT(input) uint8_t *input(void)
{
    return self.input;
}

EXPORT(feed) int feed(uint32_t size)
{
    return pmesh_decoder_feed(self.dec, self.input, size);
}

EXPORT(rule) const char *rule(void)
{
    return pmesh_decoder_error(self.dec).rule;
}

EXPORT(status_text) const char *status_text(int status)
{
    return pmesh_status_text((pmesh_status)status);
}

EXPORT(material_name) const char *material_name(uint32_t material)
{
    return pmesh_decoder_material_name(self.dec, material);
}

static double *put(double *at, const double *values, unsigned count)
{
    memcpy(at, values, count * sizeof *values);
    return at + count;
}

/* Counts, then levels, then attributes; NULL before the header. */
EXPORT(info) const double *info(void)
{
    pmesh_header *h = &self.header;
    if (pmesh_decoder_header(self.dec, h) != PMESH_OK)
        return NULL;
    const double fixed[] = {
        h->format_version, (double)(h->content_hash >> 32),
        (double)(uint32_t)h->content_hash, (double)h->bytes,
        (double)h->exact_bytes, (double)h->memory, h->profile, h->placement,
        h->base_coder, h->grid.bits, h->grid.step, h->grid.origin[0],
        h->grid.origin[1], h->grid.origin[2], h->bounds[0], h->bounds[1],
        h->bounds[2], h->faces, h->mesh_vertices, h->vertices, h->base_faces,
        h->base_mesh_vertices, h->base_vertices, h->material_count,
        h->attribute_count, h->level_count
    };
    double *at = put(self.list, fixed, sizeof fixed / sizeof *fixed);
    for (uint32_t i = 0; i < h->level_count; i++) {
        const pmesh_level *l = &h->levels[i];
        const double level[] = { (double)l->bytes, l->faces, l->mesh_vertices,
                                 l->vertices, (double)l->error };
        at = put(at, level, 5);
    }
    for (uint32_t i = 0; i < h->attribute_count; i++) {
        const pmesh_attribute *a = &h->attributes[i];
        const double attribute[] = { a->kind, a->set, a->components, a->bits };
        at = put(at, attribute, 4);
    }
    return self.list;
}

/* Makes the buffers and binds them; info() came before. */
EXPORT(bind) int bind(int with_morph)
{
    const pmesh_header *h = &self.header;
    pmesh_buffers *b = &self.buffers;
    int good = 1;

    b->index_size = h->vertices <= 65536 ? 2 : 4;
    const size_t indices = 3 * (size_t)h->faces * b->index_size;
    good = good && (b->indices = malloc(indices)) != NULL;
    good = good && (b->positions = malloc(12 * (size_t)h->vertices)) != NULL;
    for (uint32_t i = 0; good && i < h->attribute_count; i++)
        good = (b->attributes[i] = malloc(4u * h->attributes[i].components *
                                          (size_t)h->vertices)) != NULL;
    if (h->material_count > 1) {
        good = good && (self.sorted = malloc(indices)) != NULL;
        good = good && (self.groups = malloc(h->material_count *
                                             sizeof *self.groups)) != NULL;
    }
    if (with_morph)
        good = good && (self.morph = malloc(12 * (size_t)h->vertices)) != NULL;
    return good ? pmesh_decoder_bind(self.dec, b) : PMESH_E_MEMORY;
}

/* Where the buffers are: indices, size of an index, positions, sorted indices,
 * groups, morph, ranges, then attributes; 0: there is none. */
EXPORT(buffers) const double *buffers(void)
{
    const pmesh_buffers *b = &self.buffers;
    const double fixed[] = { (size_t)b->indices, b->index_size,
                             (size_t)b->positions, (size_t)self.sorted,
                             (size_t)self.groups, (size_t)self.morph,
                             (size_t)&self.changes };
    double *at = put(self.list, fixed, 7);
    for (uint32_t i = 0; i < self.header.attribute_count; i++)
        *at++ = (size_t)b->attributes[i];
    return self.list;
}

static pmesh_target target_of(double faces, double error, double bytes,
                              double max_ops)
{
    return (pmesh_target){ .faces = (uint32_t)faces,
                           .error = error,
                           .bytes = (uint64_t)bytes,
                           .max_ops = (uint32_t)max_ops };
}

EXPORT(refine) int refine(double faces, double error, double bytes,
                          double max_ops)
{
    const pmesh_target target = target_of(faces, error, bytes, max_ops);
    return pmesh_decoder_refine(self.dec, &target, &self.changes);
}

/* Bytes, faces, levels and exact vertices that are decoded; complete; offset of
 * the error; visible faces, output vertices, mesh vertices, error. */
EXPORT(state) const double *state(void)
{
    const pmesh_progress_state p = pmesh_decoder_progress(self.dec);
    pmesh_view v;
    if (pmesh_decoder_mesh(self.dec, &v) != PMESH_OK)
        memset(&v, 0, sizeof v);
    const double list[] = {
        (double)p.bytes, p.faces, p.levels, p.exact_vertices, p.complete,
        (double)pmesh_decoder_error(self.dec).offset, v.face_count,
        v.vertex_count, v.mesh_vertex_count, (double)v.error
    };
    put(self.list, list, 10);
    return self.list;
}

/* Fills sorted and groups. */
EXPORT(sort) int sort(void)
{
    return pmesh_decoder_copy_indices(self.dec, self.sorted,
                                      self.buffers.index_size, self.groups);
}

EXPORT(morph) int morph(double faces, double error, double bytes)
{
    const pmesh_target target = target_of(faces, error, bytes, 0);
    return pmesh_decoder_copy_morph(self.dec, &target, self.morph, 0);
}

/* Minimum and maximum; NULL without a mesh. */
EXPORT(bounds) const double *bounds(void)
{
    return pmesh_decoder_bounds(self.dec, self.list, self.list + 3) == PMESH_OK
               ? self.list
               : NULL;
}

/* Face, distance, weights; NULL: nothing met. */
EXPORT(raycast) const double *raycast(double x, double y, double z, double dx,
                                      double dy, double dz)
{
    const double origin[3] = { x, y, z }, direction[3] = { dx, dy, dz };
    pmesh_hit hit;
    if (!pmesh_decoder_raycast(self.dec, origin, direction, &hit))
        return NULL;
    const double list[] = { hit.face, hit.distance, hit.weight[0],
                            hit.weight[1], hit.weight[2] };
    put(self.list, list, 5);
    return self.list;
}
