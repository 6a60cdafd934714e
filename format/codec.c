/* SPDX-License-Identifier: MIT */
#include "format/codec.h"
#include "format/cut.h"
#include "format/quantize.h"
#include "format/rank.h"

enum { ALIGNMENT = 16 };

typedef struct carver {
    uint8_t *block; /* NULL: only measure */
    uint64_t used;
} carver;

static void *carve(carver *k, uint64_t count, uint64_t size)
{
    void *at = k->block ? k->block + k->used : NULL;
    k->used += (count * size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    return at;
}

/* While the base of a joined mesh is coded, each fan is a vertex. */
static uint64_t rows_of(const pmesh_codec_sizes *s)
{
    return s->joined && s->base_fans > s->vertices ? s->base_fans
                                                   : s->vertices;
}

static void carve_mesh(carver *k, pmesh_mesh *m, const pmesh_codec_sizes *s)
{
    const uint64_t edges = 3 * (uint64_t)s->faces, rows = rows_of(s);
    *m = (pmesh_mesh){ .vertex_capacity = s->vertices,
                       .face_capacity = s->faces,
                       .wedge_capacity = s->wedges,
                       .value_count = s->value_count,
                       .material_count = s->material_count };
    m->vertex = carve(k, edges, sizeof *m->vertex);
    m->twin = carve(k, edges, sizeof *m->twin);
    if (s->joined)
        m->fan = carve(k, edges, sizeof *m->fan);
    m->first = carve(k, rows, sizeof *m->first);
    m->parent = carve(k, rows, sizeof *m->parent);
    m->position = carve(k, rows, sizeof *m->position);
    if (s->value_count) {
        m->wedge = carve(k, edges, sizeof *m->wedge);
        m->wedge_vertex = carve(k, s->wedges, sizeof *m->wedge_vertex);
        m->wedge_parent = carve(k, s->wedges, sizeof *m->wedge_parent);
        m->value = carve(k, (uint64_t)s->wedges * s->value_count,
                         sizeof *m->value);
    }
    if (s->material_count > 1)
        m->material = carve(k, s->faces, sizeof *m->material);
}

uint64_t pmesh_codec_bind(pmesh_codec *c, const pmesh_codec_sizes *s,
                          void *block)
{
    carver k = { (uint8_t *)block, 0 };
    carve_mesh(&k, &c->mesh, s);
    c->sizes = *s;
    c->order = carve(&k, rows_of(s), sizeof *c->order);
    c->state = carve(&k, s->vertices, sizeof *c->state);
    c->near = carve(&k, s->vertices, sizeof *c->near);
    c->face_end = carve(&k, s->vertices, sizeof *c->face_end);
    c->wedge_end = NULL;
    c->wedge_corner = c->wedge_order = NULL;
    if (s->value_count) {
        c->wedge_end = carve(&k, s->vertices, sizeof *c->wedge_end);
        c->wedge_corner = carve(&k, s->wedges, sizeof *c->wedge_corner);
        c->wedge_order = carve(&k, s->block_wedges, sizeof *c->wedge_order);
    }
    c->unsplit = NULL;
    if (s->moves)
        c->unsplit = carve(&k, s->block_splits, sizeof *c->unsplit);
    c->child_face = carve(&k, s->block_splits, sizeof *c->child_face);
    c->importance = carve(&k, s->block_splits, sizeof *c->importance);
    c->child_order = carve(&k, s->block_splits, sizeof *c->child_order);
    c->face_order = carve(&k, pmesh_block_faces(s), sizeof *c->face_order);
    c->scratch = carve(&k, pmesh_rank_scratch(s), sizeof *c->scratch);
    c->cut_room = carve(&k, 1, pmesh_cut_room());
    c->base_scratch = carve(&k, pmesh_base_scratch(s->base_faces),
                            sizeof *c->base_scratch);
    if (block)
        pmesh_models_init(&c->models, &pmesh_start);
    return k.used;
}

void pmesh_codec_limit_values(pmesh_codec *c, const pmesh_attribute *attributes,
                              uint32_t count)
{
    uint32_t component = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t n = pmesh_coded_components(&attributes[i]);
        for (uint32_t k = 0; k < n; k++)
            c->component_max[component++] =
                ((uint32_t)1 << attributes[i].bits) - 1;
    }
}
