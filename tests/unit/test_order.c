/* SPDX-License-Identifier: MIT */
/* Large meshes are numbered by place: see enc_order.c. */
#include <stdlib.h>
#include <string.h>

#include "tests/unit/import_trial.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

/* 0 .. count - 1 in any order. */
static uint32_t *shuffled(uint32_t count, uint32_t seed)
{
    uint32_t *at = malloc(count * sizeof *at);

    for (uint32_t i = 0; i < count; i++) {
        const uint32_t j = shape_random(&seed, i + 1);
        at[i] = at[j];
        at[j] = i;
    }
    return at;
}

/* Vertex v becomes number[v], face f the face[f]-th. */
static void scatter(shape_mesh *s, uint32_t seed)
{
    const size_t n = s->input.vertex_count, faces = s->input.face_count;
    uint32_t *number = shuffled((uint32_t)n, seed);
    uint32_t *face = shuffled((uint32_t)faces, seed + 1);
    double *xyz = malloc(3 * n * sizeof *xyz);
    uint32_t *corner = malloc(3 * faces * sizeof *corner);

    for (size_t v = 0; v < n; v++)
        memcpy(xyz + 3 * number[v], s->positions + 3 * v, 3 * sizeof *xyz);
    for (size_t c = 0; c < 3 * faces; c++)
        corner[3 * face[c / 3] + c % 3] = number[s->indices[c]];
    memcpy(s->positions, xyz, 3 * n * sizeof *xyz);
    memcpy(s->indices, corner, 3 * faces * sizeof *corner);
    free(number);
    free(face);
    free(xyz);
    free(corner);
}

static trial trial_of(const shape_mesh *s)
{
    trial t = import_trial_of(s->positions, s->input.vertex_count, s->indices,
                              s->input.face_count);
    t.in.materials = s->materials;
    t.in.material_count = s->input.material_count;
    t.in.attributes = s->input.attributes;
    t.in.attribute_count = s->input.attribute_count;
    t.config.lossless = true;
    t.config.cost = PMESH_COST_CUSTOM; /* asks for the vertices' sources */
    return t;
}

/* How far the numbers of neighbouring faces are apart, in the mean. */
static double spread(const enc_mesh *m)
{
    double sum = 0;

    for (uint32_t h = 0; h < 3 * m->face_count; h++) {
        const double d = (double)(h / 3) - m->twin[h] / 3;
        sum += m->twin[h] == ENC_NONE ? 0 : d < 0 ? -d : d;
    }
    return sum / (3.0 * m->face_count);
}

TEST(order_brings_neighbours_together)
{
    shape_mesh *s = shape_make(SHAPE_TORUS, 128, 1);

    scatter(s, 7);
    trial t = trial_of(s);
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.mesh.face_count == 32768);
    CHECK(spread(&t.mesh) < 500); /* a third of all faces, if scattered */
    import_finish(&t);
    shape_free(s);
}

TEST(order_takes_all_of_a_vertex_along)
{
    shape_mesh *s = shape_make(SHAPE_SPHERE, 100, 1);
    trial t = trial_of(s);

    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.mesh.face_count > 16384 && t.mesh.wedge);
    CHECK(t.mesh.material_count > 1 && t.mesh.material_count <= 8);
    for (uint32_t v = 0; v < t.mesh.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            CHECK((double)t.mesh.exact[v][k] ==
                  (double)(float)s->positions[3 * t.mesh.source[v] +
                                              (size_t)k]);
    uint32_t dyed[8] = { 0 }, expected[8] = { 0 };
    for (uint32_t f = 0; f < t.mesh.face_count; f++)
        dyed[t.mesh.material[f]]++;
    for (size_t f = 0; f < s->input.face_count; f++) {
        const uint32_t *v = s->indices + 3 * f;
        bool thin = false;
        for (int k = 0; k < 3; k++)
            thin |= memcmp(s->positions + 3 * v[k],
                           s->positions + 3 * v[(k + 1) % 3],
                           3 * sizeof *s->positions) == 0;
        expected[s->materials[f]] += !thin;
    }
    CHECK(memcmp(dyed, expected, sizeof dyed) == 0);
    import_finish(&t);
    shape_free(s);
}

/* No two vertices of the torus fall into one cell of the curve. */
TEST(order_makes_one_file_of_all_orders)
{
    shape_bytes straight = { 0 }, mixed = { 0 };
    shape_mesh *s = shape_make(SHAPE_TORUS, 96, 1);
    pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report = { 0 };

    CHECK(shape_bake(s, &config, &straight, &report) == PMESH_OK);
    scatter(s, 3);
    CHECK(shape_bake(s, &config, &mixed, &report) == PMESH_OK);
    CHECK(straight.size == mixed.size &&
          memcmp(straight.data, mixed.data, mixed.size) == 0);
    free(straight.data);
    free(mixed.data);
    shape_free(s);
}

TEST(order_survives_every_failing_allocation)
{
    shape_mesh *s = shape_make(SHAPE_SPHERE, 100, 1);
    pmesh_status status = PMESH_E_MEMORY;
    size_t allowed = 4;

    for (; status == PMESH_E_MEMORY; allowed++) {
        trial t = trial_of(s);
        t.acc.allowed = allowed;
        t.config.allocator =
            (pmesh_allocator){ import_alloc, import_release, &t.acc };
        status = enc_mesh_import(&t.in, &t.config, NULL, &t.mesh, &t.report);
        CHECK(status == PMESH_OK || t.acc.bytes == 0);
        import_finish(&t);
    }
    CHECK(status == PMESH_OK && allowed > 20);
    shape_free(s);
}
