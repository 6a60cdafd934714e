/* SPDX-License-Identifier: MIT */
/*
 * What baking does where a surface is not manifold, or in pieces.
 */
#include <stdlib.h>
#include <string.h>

#include "tests/unit/faces.h"
#include "tests/unit/import_trial.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

typedef struct model {
    double *xyz;
    uint32_t *index;
    uint32_t vertices, faces;
} model;

static model model_make(uint32_t vertices, uint32_t faces)
{
    return (model){ calloc(vertices, 3 * sizeof(double)),
                    calloc(faces, 3 * sizeof(uint32_t)), 0, 0 };
}

static void model_free(model *m)
{
    free(m->xyz);
    free(m->index);
}

static uint32_t add_vertex(model *m, double x, double y, double z)
{
    const double p[] = { x, y, z };
    memcpy(m->xyz + 3 * m->vertices, p, sizeof p);
    return m->vertices++;
}

static void add_face(model *m, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t f[] = { a, b, c };
    memcpy(m->index + 3 * m->faces++, f, sizeof f);
}

/* A grid of n x n squares with corners p, p + along, p + across, ... */
static void add_grid(model *m, uint32_t n, const double p[3],
                     const double along[3], const double across[3])
{
    const uint32_t first = m->vertices;
    for (uint32_t i = 0; i <= n; i++)
        for (uint32_t k = 0; k <= n; k++)
            add_vertex(m, p[0] + i * along[0] + k * across[0],
                       p[1] + i * along[1] + k * across[1],
                       p[2] + i * along[2] + k * across[2]);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < n; k++) {
            const uint32_t v = first + i * (n + 1) + k;
            add_face(m, v, v + n + 1, v + 1);
            add_face(m, v + 1, v + n + 1, v + n + 2);
        }
}

static pmesh_decoder *bake(const model *m, const pmesh_encoder_config *config,
                           pmesh_encode_report *report)
{
    shape_mesh shape = { .input = { .positions = m->xyz,
                                    .vertex_count = m->vertices,
                                    .indices = m->index,
                                    .face_count = m->faces } };
    shape_bytes bytes;
    pmesh_status status;
    CHECK(shape_bake(&shape, config, &bytes, report) == PMESH_OK);
    pmesh_decoder *dec =
        shape_decode(bytes.data, bytes.size, bytes.size, &status);
    CHECK(status == PMESH_OK && faces_match(&shape.input, dec));
    free(bytes.data);
    return dec;
}

static pmesh_encoder_config joining(uint32_t base_faces)
{
    pmesh_encoder_config c = pmesh_encoder_config_default();
    c.topology = PMESH_TOPOLOGY_JOIN;
    c.base_faces = base_faces;
    return c;
}

static pmesh_view view_at(pmesh_decoder *dec, uint32_t faces)
{
    const pmesh_target target = { .faces = faces };
    pmesh_view view;
    CHECK(pmesh_decoder_refine(dec, &target, NULL) == PMESH_OK);
    CHECK(pmesh_decoder_mesh(dec, &view) == PMESH_OK);
    return view;
}

/* ---- sheets stay together ------------------------------------------------ */

/* Three grids that meet in the line x = y = 0. */
static model three_sheets(uint32_t n)
{
    static const double origin[3] = { 0, 0, 0 }, up[3] = { 0, 0, 1 };
    static const double out[3][3] = { { 1, 0, 0 },
                                      { -0.5, 0.8, 0 },
                                      { -0.5, -0.9, 0 } };
    model m = model_make(3 * (n + 1) * (n + 1), 6 * n * n);
    for (int i = 0; i < 3; i++)
        add_grid(&m, n, origin, up, out[i]);
    return m;
}

static bool on_line(const pmesh_decoder *dec, const pmesh_view *v, uint32_t i)
{
    pmesh_header h;
    pmesh_decoder_header(dec, &h);
    for (int k = 0; k < 2; k++) {
        const double x =
            h.grid.origin[k] +
            h.grid.step * v->positions[3 * (size_t)v->indices[i] + (size_t)k];
        if (x < -1e-3 || x > 1e-3)
            return false;
    }
    return true;
}

/* Faces that have both vertices of side i of the index buffer. */
static uint32_t faces_with(const pmesh_view *v, uint32_t i)
{
    const uint32_t a = v->indices[i];
    const uint32_t b = v->indices[i % 3 == 2 ? i - 2 : i + 1];
    uint32_t count = 0;
    for (uint32_t f = 0; f < v->face_count; f++) {
        unsigned found = 0;
        for (uint32_t k = 3 * f; k < 3 * f + 3; k++)
            found += v->indices[k] == a || v->indices[k] == b;
        count += found == 2;
    }
    return count;
}

static bool has_crack(pmesh_decoder *dec, uint32_t faces)
{
    const pmesh_view v = view_at(dec, faces);
    for (uint32_t i = 0; i < 3 * v.face_count; i++)
        if (on_line(dec, &v, i) &&
            on_line(dec, &v, i % 3 == 2 ? i - 2 : i + 1) &&
            faces_with(&v, i) != 3)
            return true;
    return false;
}

static uint32_t levels_with_cracks(const model *m, pmesh_encoder_config config)
{
    pmesh_encode_report report;
    uint32_t cracks = 0;
    pmesh_decoder *dec = bake(m, &config, &report);
    CHECK(report.joined == (config.topology != PMESH_TOPOLOGY_KEEP));
    for (uint32_t i = 0; i < report.level_count; i++)
        cracks += has_crack(dec, report.levels[i].faces);
    pmesh_decoder_destroy(dec);
    return cracks;
}

TEST(three_sheets_at_an_edge_never_part)
{
    model m = three_sheets(12);
    for (int profile = 0; profile < 3; profile++) {
        pmesh_encoder_config config = joining(6);
        config.profile = (pmesh_profile)profile;
        CHECK(levels_with_cracks(&m, config) == 0);
        config.topology = PMESH_TOPOLOGY_AUTO;
        CHECK(levels_with_cracks(&m, config) == 0);
    }
    pmesh_encoder_config keep = joining(6);
    keep.topology = PMESH_TOPOLOGY_KEEP;
    CHECK(levels_with_cracks(&m, keep) > 0); /* so that this can fail */
    model_free(&m);
}

/* Two pyramids of grids, tip to tip. */
TEST(a_bow_tie_hangs_together_at_its_knot)
{
    static const double knot[3] = { 0, 0, 0 };
    static const double side[4][3] = { { 1, 0, 0.2 },
                                       { 0.2, 1, 0 },
                                       { -1, 0, 0.1 },
                                       { 0.1, -1, 0 } };
    model m = model_make(2 * 17 * 17, 4 * 16 * 16);
    add_grid(&m, 16, knot, side[0], side[1]);
    add_grid(&m, 16, knot, side[2], side[3]);
    pmesh_encode_report report;
    const pmesh_encoder_config config = joining(2);
    pmesh_decoder *dec = bake(&m, &config, &report);
    CHECK(report.joined_vertices == 1 && report.cut_vertices == 0);
    CHECK(report.base_faces <= 4);
    for (uint32_t i = 0; i < report.level_count; i++) {
        const pmesh_view v = view_at(dec, report.levels[i].faces);
        uint32_t piece[2 * 17 * 17], pieces = v.mesh_vertex_count;
        for (uint32_t k = 0; k < v.mesh_vertex_count; k++)
            piece[k] = k;
        for (uint32_t changed = 1; changed;) { /* the least of each piece */
            changed = 0;
            for (uint32_t k = 0; k < 3 * v.face_count; k++) {
                const uint32_t a = v.indices[k];
                const uint32_t b = v.indices[k % 3 == 2 ? k - 2 : k + 1];
                if (piece[a] > piece[b]) {
                    piece[a] = piece[b];
                    changed = 1;
                }
            }
        }
        for (uint32_t k = 0; k < v.mesh_vertex_count; k++)
            pieces -= piece[k] != k;
        CHECK(pieces == 1);
    }
    pmesh_decoder_destroy(dec);
    model_free(&m);
}

/* ---- pieces join and vanish ---------------------------------------------- */

/* Leaves: triangles far apart, some of them doubled back to back. */
static model leaves(uint32_t count, bool doubled, uint32_t seed)
{
    model m = model_make(3 * count, 2 * count);
    for (uint32_t i = 0; i < count; i++) {
        double p[3], d[6];
        for (int k = 0; k < 3; k++)
            p[k] = shape_random(&seed, 1000);
        for (int k = 0; k < 6; k++)
            d[k] = 1 + shape_random(&seed, 10);
        const uint32_t a = add_vertex(&m, p[0], p[1], p[2]);
        const uint32_t b =
            add_vertex(&m, p[0] + d[0], p[1] - d[1], p[2] + d[2]);
        const uint32_t c =
            add_vertex(&m, p[0] - d[3], p[1] + d[4], p[2] + d[5]);
        add_face(&m, a, b, c);
        if (doubled && i % 2)
            add_face(&m, b, a, c);
    }
    return m;
}

static uint32_t base_of(const model *m, pmesh_encoder_config config)
{
    pmesh_encode_report report;
    pmesh_decoder_destroy(bake(m, &config, &report));
    return report.base_faces;
}

/* Nearly: the last few may come to lie upon each other, and then no vertex has
 * a face to spare. */
TEST(a_soup_of_leaves_comes_down_to_almost_nothing)
{
    for (uint32_t seed = 1; seed <= 6; seed++) {
        model m = leaves(60 * seed, seed % 2, seed);
        pmesh_encoder_config config = joining(1);
        config.placement = seed % 3 ? PMESH_SUBSET : PMESH_OPTIMAL;
        CHECK(base_of(&m, config) <= 4);
        config.topology = PMESH_TOPOLOGY_KEEP;
        CHECK(base_of(&m, config) == m.faces);
        model_free(&m);
    }
}

TEST(solids_come_down_to_the_base_that_is_wanted)
{
    shape_mesh *s = shape_make(SHAPE_PIECES, 300, 5);
    pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report;
    shape_bytes bytes;
    CHECK(shape_bake(s, &config, &bytes, &report) == PMESH_OK);
    CHECK(report.joined && report.base_faces <= 200);
    free(bytes.data);
    config.topology = PMESH_TOPOLOGY_KEEP;
    CHECK(shape_bake(s, &config, &bytes, &report) == PMESH_OK);
    CHECK(!report.joined && report.base_faces == 4 * 300);
    free(bytes.data);
    shape_free(s);
}

/* Two plates, a little apart: a threshold lets them become one. */
TEST(plates_within_the_threshold_become_one)
{
    static const double low[3] = { 0, 0, 0 }, high[3] = { 0.5, 0.5, 0.02 };
    static const double x[3] = { 1, 0, 0 }, y[3] = { 0, 1, 0 };
    model m = model_make(2 * 21 * 21, 4 * 20 * 20);
    add_grid(&m, 20, low, x, y);
    add_grid(&m, 20, high, x, y);
    pmesh_encode_report report;
    pmesh_encoder_config config = pmesh_encoder_config_default();
    config.base_faces = 300;
    config.threshold = 1;
    pmesh_decoder *dec = bake(&m, &config, &report);
    CHECK(report.joined);
    const pmesh_view v = view_at(dec, report.base_faces);
    uint8_t side[2 * 21 * 21] = { 0 }; /* of a vertex: its faces' plates */
    uint32_t shared = 0;
    for (uint32_t f = 0; f < v.face_count; f++) {
        bool is_high = true;
        for (uint32_t k = 3 * f; k < 3 * f + 3; k++)
            is_high &= v.positions[3 * (size_t)v.indices[k] + 2] > 0;
        for (uint32_t k = 3 * f; k < 3 * f + 3; k++)
            side[v.indices[k]] |= is_high ? 2 : 1;
    }
    for (uint32_t k = 0; k < v.mesh_vertex_count; k++)
        shared += side[k] == 3;
    CHECK(shared > 10);
    pmesh_decoder_destroy(dec);
    model_free(&m);
}

/* ---- all of it ----------------------------------------------------------- */

static int swallow(void *user, const void *data, size_t size)
{
    (void)user, (void)data, (void)size;
    return 0;
}

TEST(joining_survives_every_failing_allocation)
{
    shape_mesh *s = shape_make(SHAPE_FACETS, 5, 1);
    pmesh_encoder_config config = joining(4);
    pmesh_status status = PMESH_E_MEMORY;
    size_t allowed = 0;
    config.threshold = 0.1;
    for (; status == PMESH_E_MEMORY; allowed++) {
        account acc = { .allowed = allowed };
        config.allocator =
            (pmesh_allocator){ import_alloc, import_release, &acc };
        status = pmesh_encode(&s->input, &config, swallow, NULL, NULL);
        CHECK(acc.bytes == 0);
    }
    CHECK(status == PMESH_OK && allowed > 40);
    shape_free(s);
}

static void any_shape_comes_back(shape_kind kind, uint32_t seed)
{
    shape_mesh *s = shape_make(kind, 4 + shape_random(&seed, 30), seed);
    pmesh_encoder_config config = joining(1 + shape_random(&seed, 20));
    pmesh_encode_report report;
    pmesh_status status;
    shape_bytes bytes;
    config.profile = (pmesh_profile)shape_random(&seed, 3);
    config.placement = (pmesh_placement)shape_random(&seed, 2);
    config.metric = (pmesh_metric)shape_random(&seed, 2);
    config.position_bits = (uint8_t)(4 + shape_random(&seed, 21));
    config.threshold = shape_random(&seed, 2) ? 0.05 : 0;
    CHECK(shape_bake(s, &config, &bytes, &report) == PMESH_OK);
    CHECK(report.joined);
    pmesh_decoder *dec = shape_decode(bytes.data, bytes.size, 777, &status);
    CHECK(status == PMESH_OK && faces_match(&s->input, dec));
    for (uint32_t i = 0; i < report.level_count; i++) {
        view_at(dec, report.levels[i].faces);
        CHECK(shape_view_sound(dec));
    }
    pmesh_decoder_destroy(dec);
    free(bytes.data);
    shape_free(s);
}

TEST(any_shape_that_is_joined_comes_back)
{
    for (uint32_t seed = 1; seed <= 30; seed++)
        for (int kind = 0; kind < SHAPE_COUNT; kind++)
            any_shape_comes_back((shape_kind)kind, seed);
}
