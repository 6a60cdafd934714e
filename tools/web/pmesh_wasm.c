/* SPDX-License-Identifier: MIT */
/*
 * pmesh_wasm.c - the decoder as a WebAssembly module: one file for each
 * instance, so that letting go of the instance frees all its memory, and a
 * hostile file has nothing but its own to harm. With PMESH_WASM_SCENE the
 * file is a scene, and its meshes share the instance.
 *
 * JavaScript (src/decoder.js, src/scene.js) holds a mesh by its address, and
 * reads numbers as lists of doubles, whose order is here and there. Buffers of
 * a mesh are made once, right behind its header: a module of one mesh does not
 * grow afterwards, so views into its memory stay valid.
 */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "decoder/pmesh_scene.h"

#define EXPORT(name) __attribute__((export_name(#name)))

enum { INPUT_SIZE = 65536, PAGE = 65536, INFO_SIZE = 512 };

/* Of a mesh vertex, to inflate: pmesh_decoder_inflate_room() tells it of the
 * visible mesh alone, which has not come when the room is made. */
enum { INFLATE_ROOM = 64 };

typedef struct mesh {
    pmesh_decoder *dec;
    pmesh_buffers buffers;
    pmesh_changes changes;
    uint32_t attribute_count;
    void *sorted; /* indices by material, if there are several */
    pmesh_range *groups;
    float *morph, *inflated; /* if asked for, as is the room for it */
    void *room;
    size_t room_size;
} mesh;

static double list[INFO_SIZE]; /* answers */
static uint8_t in[INPUT_SIZE];

/* ---- what a C library would do ------------------------------------------ */

/* Memory grows and is never given back: a decoder takes two blocks, and this
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

static double *put(double *at, const double *values, unsigned count)
{
    memcpy(at, values, count * sizeof *values);
    return at + count;
}

/* ---- one mesh ----------------------------------------------------------- */

/* JavaScript's own decoder of Draco base meshes, or one that refuses. */
__attribute__((import_module("pmesh"), import_name("base"))) int
page_base(const void *data, size_t size, uint32_t vertex_count, uint32_t face_count,
          int32_t *positions, uint32_t *indices);

static pmesh_status decode_base(void *user, const void *data, size_t size,
                                uint32_t vertex_count, uint32_t face_count,
                                int32_t *positions, uint32_t *indices)
{
    (void)user;
    return (pmesh_status)page_base(data, size, vertex_count, face_count,
                                   positions, indices);
}

static pmesh_decoder_config config_of(double max_memory, int with_base)
{
    pmesh_decoder_config config = pmesh_decoder_config_default();
    config.max_memory = (uint64_t)max_memory;
    config.base_decoder = with_base ? decode_base : NULL;
    return config;
}

static mesh *mesh_of(pmesh_decoder *dec)
{
    mesh *m = malloc(sizeof *m);
    if (!m)
        return NULL;
    memset(m, 0, sizeof *m);
    m->dec = dec;
    return m;
}

EXPORT(input) uint8_t *input(void)
{
    return in;
}

EXPORT(status_text) const char *status_text(int status)
{
    return pmesh_status_text((pmesh_status)status);
}

EXPORT(material_name) const char *material_name(mesh *m, uint32_t material)
{
    return pmesh_decoder_material_name(m->dec, material);
}

/* Counts, then levels, then attributes; NULL before the header. */
EXPORT(info) const double *info(mesh *m)
{
    pmesh_header h;
    if (pmesh_decoder_header(m->dec, &h) != PMESH_OK)
        return NULL;
    const double fixed[] = {
        h.format_version, (double)(h.content_hash >> 32),
        (double)(uint32_t)h.content_hash, (double)h.bytes,
        (double)h.exact_bytes, (double)h.memory, h.profile, h.placement,
        h.base_coder, h.grid.bits, h.grid.step, h.grid.origin[0],
        h.grid.origin[1], h.grid.origin[2], h.bounds[0], h.bounds[1],
        h.bounds[2], h.faces, h.mesh_vertices, h.vertices, h.base_faces,
        h.base_mesh_vertices, h.base_vertices, h.material_count,
        h.measured, h.attribute_count, h.level_count
    };
    double *at = put(list, fixed, sizeof fixed / sizeof *fixed);
    for (uint32_t i = 0; i < h.level_count; i++) {
        const pmesh_level *l = &h.levels[i];
        const double level[] = { (double)l->bytes, l->faces, l->mesh_vertices,
                                 l->vertices, (double)l->error, (double)l->rms,
                                 (double)l->furthest };
        at = put(at, level, 7);
    }
    for (uint32_t i = 0; i < h.attribute_count; i++) {
        const pmesh_attribute *a = &h.attributes[i];
        const double attribute[] = { a->kind, a->set, a->components, a->bits };
        at = put(at, attribute, 4);
    }
    return list;
}

/* Makes the buffers and binds them; info() came before. */
EXPORT(bind) int bind(mesh *m, int with_morph, int with_inflation)
{
    pmesh_header h;
    pmesh_buffers *b = &m->buffers;
    int good = pmesh_decoder_header(m->dec, &h) == PMESH_OK;

    m->attribute_count = h.attribute_count;
    b->index_size = h.vertices <= 65536 ? 2 : 4;
    const size_t indices = 3 * (size_t)h.faces * b->index_size;
    const size_t positions = 12 * (size_t)h.vertices;
    good = good && (b->indices = malloc(indices)) != NULL;
    good = good && (b->positions = malloc(positions)) != NULL;
    for (uint32_t i = 0; good && i < h.attribute_count; i++)
        good = (b->attributes[i] = malloc(4u * h.attributes[i].components *
                                          (size_t)h.vertices)) != NULL;
    if (h.material_count > 1) {
        good = good && (m->sorted = malloc(indices)) != NULL;
        good = good && (m->groups = malloc(h.material_count *
                                           sizeof *m->groups)) != NULL;
    }
    if (with_morph)
        good = good && (m->morph = malloc(positions)) != NULL;
    if (with_inflation) {
        m->room_size = INFLATE_ROOM * (size_t)h.mesh_vertices;
        good = good && (m->inflated = malloc(positions)) != NULL;
        good = good && (m->room = malloc(m->room_size)) != NULL;
    }
    return good ? pmesh_decoder_bind(m->dec, b) : PMESH_E_MEMORY;
}

/* Where the buffers are: indices, size of an index, positions, sorted indices,
 * groups, morph, inflated, ranges, then attributes; 0: there is none. */
EXPORT(buffers) const double *buffers(mesh *m)
{
    const pmesh_buffers *b = &m->buffers;
    const double fixed[] = { (size_t)b->indices, b->index_size,
                             (size_t)b->positions, (size_t)m->sorted,
                             (size_t)m->groups, (size_t)m->morph,
                             (size_t)m->inflated, (size_t)&m->changes };
    double *at = put(list, fixed, 8);
    for (uint32_t i = 0; i < m->attribute_count; i++)
        *at++ = (size_t)b->attributes[i];
    return list;
}

static pmesh_target target_of(double faces, double error, double bytes,
                              double max_ops)
{
    return (pmesh_target){ .faces = (uint32_t)faces,
                           .error = error,
                           .bytes = (uint64_t)bytes,
                           .max_ops = (uint32_t)max_ops };
}

EXPORT(refine) int refine(mesh *m, double faces, double error, double bytes,
                          double max_ops)
{
    const pmesh_target target = target_of(faces, error, bytes, max_ops);
    return pmesh_decoder_refine(m->dec, &target, &m->changes);
}

/* Bytes, faces, levels and exact vertices that are decoded; complete; visible
 * faces, output vertices, mesh vertices, error. */
EXPORT(state) const double *state(mesh *m)
{
    const pmesh_progress_state p = pmesh_decoder_progress(m->dec);
    pmesh_view v;
    if (pmesh_decoder_mesh(m->dec, &v) != PMESH_OK)
        memset(&v, 0, sizeof v);
    const double numbers[] = {
        (double)p.bytes, p.faces, p.levels, p.exact_vertices, p.complete,
        v.face_count, v.vertex_count, v.mesh_vertex_count, (double)v.error
    };
    put(list, numbers, 9);
    return list;
}

/* Fills sorted and groups. */
EXPORT(sort) int sort(mesh *m)
{
    return pmesh_decoder_copy_indices(m->dec, m->sorted,
                                      m->buffers.index_size, m->groups);
}

EXPORT(morph) int morph(mesh *m, double faces, double error, double bytes)
{
    const pmesh_target target = target_of(faces, error, bytes, 0);
    return pmesh_decoder_copy_morph(m->dec, &target, m->morph, 0);
}

EXPORT(inflate) int inflate(mesh *m)
{
    return pmesh_decoder_inflate_room(m->dec) <= m->room_size
               ? pmesh_decoder_copy_inflated(m->dec, m->inflated, 0, m->room)
               : PMESH_E_ARGUMENT;
}

/* Minimum and maximum; NULL without a mesh. */
EXPORT(bounds) const double *bounds(mesh *m)
{
    return pmesh_decoder_bounds(m->dec, list, list + 3) == PMESH_OK ? list
                                                                    : NULL;
}

/* Face, distance, weights; NULL: nothing met. */
EXPORT(raycast) const double *raycast(mesh *m, double x, double y, double z,
                                      double dx, double dy, double dz)
{
    const double origin[3] = { x, y, z }, direction[3] = { dx, dy, dz };
    pmesh_hit hit;
    if (!pmesh_decoder_raycast(m->dec, origin, direction, &hit))
        return NULL;
    const double numbers[] = { hit.face, hit.distance, hit.weight[0],
                               hit.weight[1], hit.weight[2] };
    put(list, numbers, 5);
    return list;
}

#ifndef PMESH_WASM_SCENE

static mesh *only;

EXPORT(create) mesh *create(double max_memory, int with_base)
{
    const pmesh_decoder_config config = config_of(max_memory, with_base);
    pmesh_decoder *dec;
    if (pmesh_decoder_create(&dec, &config) == PMESH_OK)
        only = mesh_of(dec);
    return only;
}

EXPORT(feed) int feed(uint32_t size)
{
    return pmesh_decoder_feed(only->dec, in, size);
}

/* Where feed() failed, and by which rule. */
EXPORT(offset) double offset(void)
{
    return (double)pmesh_decoder_error(only->dec).offset;
}

EXPORT(rule) const char *rule(void)
{
    return pmesh_decoder_error(only->dec).rule;
}

#else

static pmesh_scene *scene;
static uint32_t *shares; /* of a budget, for each mesh */
static mesh **meshes;

EXPORT(create) int create(double max_memory, int with_base)
{
    const pmesh_scene_config config = { .decoder =
                                            config_of(max_memory, with_base) };
    return pmesh_scene_create(&scene, &config) == PMESH_OK;
}

EXPORT(feed) int feed(uint32_t size)
{
    return pmesh_scene_feed(scene, in, size);
}

EXPORT(offset) double offset(void)
{
    return (double)pmesh_scene_error(scene).offset;
}

EXPORT(rule) const char *rule(void)
{
    return pmesh_scene_error(scene).rule;
}

static int make_lists(uint32_t count)
{
    if (shares)
        return 1;
    meshes = malloc(count * sizeof *meshes);
    if (meshes)
        memset(meshes, 0, count * sizeof *meshes);
    shares = meshes ? malloc(count * sizeof *shares) : NULL;
    return shares != NULL;
}

/* Counts, form of the document, levels; NULL before the header. */
EXPORT(scene_info) const double *scene_info(void)
{
    pmesh_scene_header h;
    if (pmesh_scene_get_header(scene, &h) != PMESH_OK ||
        !make_lists(h.mesh_count))
        return NULL;
    const double fixed[] = { (double)(h.content_hash >> 32),
                             (double)(uint32_t)h.content_hash, h.mesh_count,
                             h.resource_count, h.document_form,
                             h.level_count };
    double *at = put(list, fixed, 6);
    for (uint32_t i = 0; i < h.level_count; i++) {
        const pmesh_scene_level *l = &h.levels[i];
        const double level[] = { (double)l->bytes, (double)l->faces,
                                 (double)l->vertices, (double)l->error };
        at = put(at, level, 4);
    }
    return list;
}

/* Bytes, faces, meshes with a base, whether the document is there, complete. */
EXPORT(scene_state) const double *scene_state(void)
{
    const pmesh_scene_progress p = pmesh_scene_get_progress(scene);
    const double numbers[] = { (double)p.bytes, (double)p.faces, p.bases,
                               p.document, p.complete };
    put(list, numbers, 5);
    return list;
}

/* A mesh once its header is there, else NULL. */
EXPORT(scene_mesh) mesh *scene_mesh(uint32_t number)
{
    pmesh_decoder *dec = pmesh_scene_mesh(scene, number);
    pmesh_header unused;
    if (!meshes[number] && dec &&
        pmesh_decoder_header(dec, &unused) == PMESH_OK)
        meshes[number] = mesh_of(dec);
    return meshes[number];
}

EXPORT(scene_scale) double scene_scale(uint32_t number)
{
    return (double)pmesh_scene_scale(scene, number);
}

/* Faces for each mesh; NULL while there is no base mesh. */
EXPORT(scene_share) const uint32_t *scene_share(double faces, double error,
                                                double bytes)
{
    const pmesh_scene_target target = { .faces = (uint64_t)faces,
                                        .error = error,
                                        .bytes = (uint64_t)bytes };
    return pmesh_scene_share(scene, &target, shares) == PMESH_OK ? shares
                                                                 : NULL;
}

/* Address, size and what has arrived of a resource, or of the document: -1. */
EXPORT(scene_bytes) const double *scene_bytes(int number)
{
    const pmesh_scene_bytes b =
        number < 0 ? pmesh_scene_document(scene)
                   : pmesh_scene_resource(scene, (uint32_t)number);
    const double numbers[] = { (size_t)b.data, (double)b.size,
                               (double)b.arrived };
    put(list, numbers, 3);
    return list;
}

#endif
