/* SPDX-License-Identifier: MIT */
/* The good files that are broken. */
#include "tests/corrupt/corrupt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/pmesh_scene_encode.h"
#include "tests/golden/golden_mesh.h"
#include "tools/draco_base.h"

static shape_bytes made[BASE_FILES];

typedef struct recipe {
    int mesh;
    uint32_t size, base_faces;
    uint8_t bits;
    bool moving, lossless, measured, draco;
    pmesh_topology topology;
} recipe;

static const recipe recipes[] = {
    [PLAIN] = { SHAPE_TORUS, 8, 12, 10 },
    [FULL] = { SHAPE_SPHERE, 6, 30, 11, .lossless = true, .measured = true },
    [MOVING] = { SHAPE_TERRAIN, 8, 12, 12, .moving = true },
    [FACETS] = { SHAPE_FACETS, 6, 12, 9 },
    [JOINED] = { GOLDEN_LEAVES, 14, 20, 10, .topology = PMESH_TOPOLOGY_JOIN },
    [SOUP] = { SHAPE_SOUP, 40, 12, 8, .topology = PMESH_TOPOLOGY_JOIN },
    [COARSE] = { SHAPE_TERRAIN, 6, 12, 4, .lossless = true },
    [DRACO] = { SHAPE_TORUS, 8, 40, 10, .draco = true }
};

static void fail(const char *what)
{
    fprintf(stderr, "corrupt: no %s\n", what);
    exit(2);
}

static void bake(const recipe *from, shape_bytes *out)
{
    golden_mesh mesh;
    pmesh_encode_report report;
    pmesh_encoder_config config = pmesh_encoder_config_default();
    config.base_faces = from->base_faces;
    config.position_bits = from->bits;
    config.normal_bits = 4;
    config.placement = from->moving ? PMESH_OPTIMAL : PMESH_SUBSET;
    config.topology = from->topology;
    config.lossless = from->lossless;
    config.measure = from->measured;
    config.base_coder = from->draco ? PMESH_BASE_DRACO : PMESH_BASE_NATIVE;
    config.base_encoder = draco_base_encode;
    config.base_decoder = draco_base_decode;
    golden_mesh_make(&mesh, from->mesh, from->size);
    mesh.shape->input = mesh.input;
    if (shape_bake(mesh.shape, &config, out, &report) != PMESH_OK)
        fail("base file");
    golden_mesh_free(&mesh);
}

static int collect(void *user, const void *data, size_t size)
{
    bytes_put(user, data, size);
    return 0;
}

static void bake_scene(shape_bytes *out)
{
    const shape_bytes *a = base_bytes(PLAIN), *b = base_bytes(MOVING);
    const pmesh_scene_mesh_input meshes[] = { { a->data, a->size, 1 },
                                              { b->data, b->size, 2 } };
    const pmesh_scene_blob resources[] = { { "early", 5 }, { "late", 4 } };
    const pmesh_scene_input scene = { .meshes = meshes,
                                      .mesh_count = 2,
                                      .document = { "document", 8 },
                                      .resources = resources,
                                      .resource_count = 2,
                                      .early_count = 1 };
    if (pmesh_scene_encode(&scene, NULL, collect, out, NULL) != PMESH_OK)
        fail("scene");
}

const shape_bytes *base_bytes(base_file which)
{
    shape_bytes *b = &made[which];
    if (!b->data && which == SCENE)
        bake_scene(b);
    else if (!b->data)
        bake(&recipes[which], b);
    return b;
}

void bases_free(void)
{
    for (int i = 0; i < BASE_FILES; i++)
        free(made[i].data);
}

chunks take_base_file(base_file which)
{
    chunks c;
    chunks_take_apart(base_bytes(which), &c);
    return c;
}

chunk *find_chunk(chunks *c, int type, int n)
{
    chunk *found = NULL;
    for (uint32_t i = 0; i < c->count; i++)
        if (c->at[i].type == type) {
            found = &c->at[i];
            if (n-- == 0)
                break;
        }
    if (!found)
        fail("such chunk");
    return found;
}

size_t chunk_offset(const chunks *c, const chunk *of)
{
    size_t at = 8;
    for (const chunk *i = c->at; i < of; i++)
        at += chunk_framed_size(i);
    return at;
}

void insert_chunk(chunks *c, uint32_t at, chunk one)
{
    memmove(c->at + at + 1, c->at + at, (c->count - at) * sizeof *c->at);
    c->at[at] = one;
    c->count++;
}

void drop_chunk(chunks *c, chunk *one)
{
    free(one->data);
    c->count--;
    memmove(one, one + 1, (size_t)(c->at + c->count - one) * sizeof *one);
}
