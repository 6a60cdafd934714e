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

static uint64_t largest(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* While the base of a joined mesh is coded, each fan is a vertex. */
static uint64_t rows_of(const pmesh_codec_sizes *s)
{
    return s->joined ? largest(s->base_fans, s->vertices) : s->vertices;
}

/* Levels do not visit what they make, the last one least of all. One place
 * more: what is there already is written behind the last, and not counted. */
static uint64_t order_size(const pmesh_codec_sizes *s)
{
    if (!s->coarse_vertices)
        return rows_of(s) + 1;
    return 1 + (s->joined ? largest(s->base_fans, s->coarse_vertices)
                          : s->coarse_vertices);
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

/* One after the other: the base, the options of cuts, ranking. */
static uint64_t scratch_size(const pmesh_codec_sizes *s)
{
    const uint64_t base = pmesh_base_scratch(s->base_faces);
    return largest(pmesh_cut_room(), sizeof(uint32_t) *
                                         largest(base, pmesh_rank_scratch(s)));
}

void pmesh_codec_start(pmesh_codec *c, const pmesh_tables *start)
{
    pmesh_models_init(&c->models, start);
    pmesh_place_models_init(&c->place[0],
                            c->sizes.moves ? PMESH_PREDICT_MOVED_CHILD
                                           : PMESH_PREDICT_CHILD,
                            start);
    if (c->sizes.moves)
        pmesh_place_models_init(&c->place[1], PMESH_PREDICT_MOVED_PARENT,
                                start);
    for (uint32_t i = 0; i < c->sizes.attribute_count; i++)
        pmesh_channel_models_init(&c->channel_models[i], start);
    for (uint32_t i = 0; i < c->sizes.value_count; i++)
        pmesh_value_models_init(&c->value_models[i], start);
}

uint64_t pmesh_codec_bind(pmesh_codec *c, const pmesh_codec_sizes *s,
                          void *block)
{
    carver k = { (uint8_t *)block, 0 };
    carve_mesh(&k, &c->mesh, s);
    c->sizes = *s;
    c->order = carve(&k, order_size(s), sizeof *c->order);
    c->state = carve(&k, s->vertices, sizeof *c->state);
    c->near = carve(&k, s->vertices, sizeof *c->near);
    c->made_faces = carve(&k, s->vertices, sizeof *c->made_faces);
    c->faces_before = carve(&k, s->vertices / PMESH_FACE_MARK + 1,
                            sizeof *c->faces_before);
    c->wedge_end = NULL;
    c->wedge_corner = c->wedge_order = NULL;
    c->wedge_before = c->wedge_last = NULL;
    if (s->value_count) {
        c->wedge_end = carve(&k, s->vertices, sizeof *c->wedge_end);
        c->wedge_corner = carve(&k, s->wedges, sizeof *c->wedge_corner);
        c->wedge_before = carve(&k, s->wedges, sizeof *c->wedge_before);
        c->wedge_last = carve(&k, rows_of(s), sizeof *c->wedge_last);
        c->wedge_order = carve(&k, s->block_wedges, sizeof *c->wedge_order);
    }
    c->place = carve(&k, s->moves ? 2 : 1, sizeof *c->place);
    c->channel_models =
        carve(&k, s->attribute_count, sizeof *c->channel_models);
    c->value_models = carve(&k, s->value_count, sizeof *c->value_models);
    c->unsplit = NULL;
    if (s->moves)
        c->unsplit = carve(&k, s->block_splits, sizeof *c->unsplit);
    c->child_face = carve(&k, s->block_splits, sizeof *c->child_face);
    c->child_order = carve(&k, s->block_splits, sizeof *c->child_order);
    c->face_order = carve(&k, largest(s->block_splits, pmesh_block_faces(s)),
                          sizeof *c->face_order);
    c->importance = c->face_order;
    c->scratch = carve(&k, 1, scratch_size(s));
    if (block)
        pmesh_codec_start(c, &pmesh_start);
    return k.used;
}

static bool may_be_tangent(const pmesh_attribute *a)
{
    return a->kind == PMESH_GENERIC && a->components == 4 &&
           a->minimum[0] < 0 && a->minimum[1] < 0 && a->minimum[2] < 0;
}

void pmesh_codec_limit_values(pmesh_codec *c, const pmesh_attribute *attributes,
                              uint32_t count)
{
    uint32_t component = 0, map = PMESH_NONE, normal = PMESH_NONE;
    for (uint32_t i = 0; i < count; i++) {
        const pmesh_attribute *a = &attributes[i];
        const uint32_t n = pmesh_coded_components(a);
        if (a->kind == PMESH_TEXCOORD && map == PMESH_NONE)
            map = i;
        if (a->kind == PMESH_NORMAL && normal == PMESH_NONE)
            normal = i;
        c->channel[i] = (pmesh_channel){
            .first = component, .count = n, .normal = a->kind == PMESH_NORMAL,
            .tangent = may_be_tangent(a) && map != PMESH_NONE &&
                       normal != PMESH_NONE
        };
        for (uint32_t k = 0; k < n; k++)
            c->component_max[component++] = ((uint32_t)1 << a->bits) - 1;
    }
    c->tangent_map = map;
    c->tangent_normal = normal;
}
