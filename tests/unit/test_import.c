/* SPDX-License-Identifier: MIT */
#include "encoder/enc_mesh.h"
#include "format/quantize.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* An allocator that counts, and fails from some call on. */
typedef struct account {
    size_t bytes, peak, calls, allowed;
} account;

static void *account_alloc(void *user, size_t size)
{
    account *acc = user;

    if (acc->calls++ >= acc->allowed)
        return NULL;
    acc->bytes += size;
    if (acc->bytes > acc->peak)
        acc->peak = acc->bytes;
    return malloc(size);
}

static void account_release(void *user, void *ptr, size_t size)
{
    account *acc = user;

    acc->bytes -= size;
    free(ptr);
}

/* One import and what came of it. */
typedef struct trial {
    pmesh_mesh_input in;
    pmesh_encoder_config config;
    enc_mesh mesh;
    pmesh_encode_report report;
    account acc;
} trial;

static trial trial_of(const double *positions, size_t vertex_count,
                      const uint32_t *indices, size_t face_count)
{
    return (trial){
        .in = { .positions = positions, .vertex_count = vertex_count,
                .indices = indices, .face_count = face_count },
        .config = { .position_bits = 14, .normal_bits = 10,
                    .texcoord_bits = 12, .color_bits = 8,
                    .generic_bits = 12 },
        .acc = { .allowed = SIZE_MAX }
    };
}

static pmesh_status run(trial *t)
{
    t->config.allocator =
        (pmesh_allocator){ account_alloc, account_release, &t->acc };
    const pmesh_status status =
        enc_mesh_import(&t->in, &t->config, &t->mesh, &t->report);
    if (status) {
        CHECK(t->acc.bytes == 0);
        CHECK(!t->mesh.vertex && t->mesh.face_count == 0);
        return status;
    }
    const pmesh_encode_report *r = &t->report;
    CHECK(enc_mesh_check(&t->mesh) == NULL);
    CHECK(r->faces == t->mesh.face_count);
    CHECK(r->vertices == t->mesh.vertex_count);
    CHECK(r->wedges == t->mesh.wedge_count);
    CHECK(r->faces == r->input_faces - r->not_finite_faces -
                          r->degenerate_faces - r->duplicate_faces);
    CHECK(r->vertices == r->input_vertices - r->unused_vertices -
                             r->welded_vertices + r->cut_vertices);
    return status;
}

static void finish(trial *t)
{
    enc_mesh_destroy(&t->mesh);
    CHECK(t->acc.bytes == 0);
}

static uint32_t open_edges(const enc_mesh *mesh)
{
    uint32_t count = 0;

    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
        count += mesh->twin[h] == ENC_NONE;
    return count;
}

static const double cube_corners[8 * 3] = {
    0, 0, 0,  1, 0, 0,  0, 1, 0,  1, 1, 0,
    0, 0, 1,  1, 0, 1,  0, 1, 1,  1, 1, 1
};
static const uint32_t cube_faces[12 * 3] = {
    0, 2, 1,  1, 2, 3,  4, 5, 6,  5, 7, 6,  0, 1, 4,  1, 5, 4,
    2, 6, 3,  3, 6, 7,  0, 4, 2,  2, 4, 6,  1, 3, 5,  3, 7, 5
};

TEST(import_keeps_a_cube_as_it_is)
{
    trial t = trial_of(cube_corners, 8, cube_faces, 12);

    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 8 && t.report.components == 1);
    CHECK(t.report.welded_vertices + t.report.cut_vertices +
              t.report.unused_vertices == 0);
    CHECK(memcmp(t.mesh.vertex, cube_faces, sizeof cube_faces) == 0);
    CHECK(open_edges(&t.mesh) == 0);
    for (int k = 0; k < 3; k++)
        CHECK(t.mesh.bounds[k] == 16383 && t.mesh.position[7][k] == 16383);
    CHECK(t.mesh.grid.step == 1.0 / 16383);
    CHECK(!t.mesh.wedge && !t.mesh.material && t.mesh.material_count == 1);
    finish(&t);
}

/* Every corner a vertex of its own, in a layout with padding. */
TEST(import_welds_a_soup_with_stride)
{
    double soup[36][5];
    uint32_t indices[36];

    for (uint32_t c = 0; c < 36; c++) {
        for (int k = 0; k < 3; k++)
            soup[c][k] = cube_corners[3 * cube_faces[c] + (uint32_t)k];
        if (c % 2 && soup[c][0] == 0)
            soup[c][0] = -0.0;
        soup[c][3] = soup[c][4] = NAN;
        indices[c] = c;
    }
    trial t = trial_of(soup[0], 36, indices, 12);
    t.in.position_stride = sizeof soup[0];
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 8 && t.report.welded_vertices == 28);
    CHECK(open_edges(&t.mesh) == 0 && t.report.components == 1);
    finish(&t);
}

TEST(import_welds_close_vertices_when_asked)
{
    /* Four points in a row, 0.09 apart, close the gap of two triangles. */
    static const double xyz[] = {
        0, 0, 0,  1, 0, 0,     0, 1, 0,
        1, 1, 0,  1.09, 0, 0,  -0.09, 1, 0,  1.18, 0, 0, 5, 5, 0
    };
    static const uint32_t faces[] = { 0, 1, 2, 3, 5, 6, 0, 4, 7 };
    trial t = trial_of(xyz, 8, faces, 3);

    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 9 && t.report.cut_vertices == 1);
    finish(&t);
    t.config.weld = 0.1;
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.welded_vertices == 3);
    CHECK(t.report.components == 1);
    CHECK(t.mesh.twin[1] == 4 && t.mesh.twin[4] == 1);
    finish(&t);
    t.config.weld = 100; /* everything */
    CHECK(run(&t) == PMESH_E_NO_FACES);
    CHECK(t.report.degenerate_faces == 3);
}

static uint32_t next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static uint32_t root_of(const uint32_t *root, uint32_t v)
{
    while (root[v] != v)
        v = root[v];
    return v;
}

/* Against all pairs. */
TEST(import_welds_close_vertices_transitively)
{
    enum { FACES = 60, COUNT = 3 * FACES };
    static double xyz[COUNT][3];
    static uint32_t faces[COUNT], root[COUNT];

    for (uint32_t seed = 0; seed < 100; seed++) {
        uint32_t random = seed;
        const double weld = 0.01 + 0.002 * seed;
        for (uint32_t v = 0; v < COUNT; v++) {
            faces[v] = root[v] = v;
            for (int k = 0; k < 3; k++)
                xyz[v][k] = (double)next_random(&random) / 16777216.0 - 0.5;
        }
        for (uint32_t v = 0; v < COUNT; v++) {
            for (uint32_t w = 0; w < v; w++) {
                double d[3], sum = 0;
                for (int k = 0; k < 3; k++) {
                    d[k] = xyz[v][k] - xyz[w][k];
                    sum += d[k] * d[k];
                }
                const uint32_t a = root_of(root, v), b = root_of(root, w);
                if (sum <= weld * weld)
                    root[a > b ? a : b] = a > b ? b : a;
            }
        }
        uint32_t degenerate = 0;
        for (uint32_t v = 0; v < COUNT; v += 3) {
            const uint32_t a = root_of(root, v), b = root_of(root, v + 1),
                           c = root_of(root, v + 2);
            degenerate += a == b || b == c || c == a;
        }
        trial t = trial_of(xyz[0], COUNT, faces, FACES);
        t.config.weld = weld;
        const pmesh_status status = run(&t);
        CHECK(status == PMESH_OK || status == PMESH_E_NO_FACES);
        CHECK(t.report.degenerate_faces == degenerate);
        finish(&t);
    }
}

TEST(import_splits_a_bow_tie)
{
    static const double xyz[] = {
        0, 0, 0,  1, 0, 0,  1, 1, 0,  -1, 0, 0,  -1, -1, 0
    };
    static const uint32_t faces[] = { 0, 1, 2, 0, 3, 4 };
    trial t = trial_of(xyz, 5, faces, 2);

    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.cut_vertices == 1 && t.report.components == 1);
    CHECK(t.mesh.vertex[0] == 0 && t.mesh.vertex[3] == 5);
    CHECK(memcmp(t.mesh.position[0], t.mesh.position[5],
                 sizeof *t.mesh.position) == 0);
    finish(&t);
}

TEST(import_pairs_the_flatter_of_three_faces)
{
    static const double xyz[] = {
        0, 0, 0,  0, 1, 0,  1, 0, 0,  -1, 0, 0,  0.2, 0, 1
    };
    static const uint32_t faces[] = { 1, 0, 4, 0, 1, 3, 1, 0, 2 };
    trial t = trial_of(xyz, 5, faces, 3);

    CHECK(run(&t) == PMESH_OK);
    CHECK(t.mesh.twin[0] == ENC_NONE);
    CHECK(t.mesh.twin[3] == 6 && t.mesh.twin[6] == 3);
    CHECK(t.report.cut_vertices == 2 && t.report.components == 1);
    finish(&t);
}

/* Two cubes that touch in an edge, from both sides' view a right angle. */
TEST(import_parts_solids_that_touch_in_an_edge)
{
    double xyz[16 * 3];
    uint32_t faces[24 * 3];

    for (int i = 0; i < 24; i++) {
        xyz[i] = cube_corners[i];
        xyz[24 + i] = cube_corners[i] + (i % 3 < 2 ? 1 : 0);
    }
    for (uint32_t i = 0; i < 36; i++) {
        faces[i] = cube_faces[i];
        faces[36 + i] = cube_faces[i] + 8;
    }
    trial t = trial_of(xyz, 16, faces, 24);
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.welded_vertices == 2 && t.report.cut_vertices == 2);
    CHECK(open_edges(&t.mesh) == 0);
    for (uint32_t h = 0; h < 72; h++)
        CHECK(t.mesh.twin[h] / 36 == h / 36);
    finish(&t);
}

/* A ring of quads, the last one joined upside down. */
TEST(import_cuts_a_moebius_strip)
{
    enum { QUADS = 9 };
    double xyz[2 * QUADS][3];
    uint32_t faces[QUADS][6];

    for (uint32_t i = 0; i < QUADS; i++) {
        const double angle = 6.283185307179586 * i / QUADS;
        for (uint32_t j = 0; j < 2; j++) {
            const double r = 2 + (j ? 0.5 : -0.5) * cos(angle / 2);
            xyz[2 * i + j][0] = r * cos(angle);
            xyz[2 * i + j][1] = r * sin(angle);
            xyz[2 * i + j][2] = (j ? 0.5 : -0.5) * sin(angle / 2);
        }
        const uint32_t a = 2 * i, b = a + 1;
        const uint32_t c = i + 1 < QUADS ? a + 2 : 1;
        const uint32_t d = i + 1 < QUADS ? a + 3 : 0;
        const uint32_t quad[6] = { a, c, b, b, c, d };
        memcpy(faces[i], quad, sizeof quad);
    }
    trial t = trial_of(xyz[0], 2 * QUADS, faces[0], 2 * QUADS);
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.faces == 2 * QUADS && t.report.components == 1);
    CHECK(t.report.cut_vertices == 2);
    CHECK(open_edges(&t.mesh) == 2 * QUADS + 2);
    finish(&t);
}

/* An n by n grid of quads in z = 0; returns the number of faces. */
static size_t make_sheet(uint32_t n, double *xyz, uint32_t *faces)
{
    size_t count = 0;

    for (uint32_t y = 0; y <= n; y++) {
        for (uint32_t x = 0; x <= n; x++) {
            *xyz++ = x;
            *xyz++ = y;
            *xyz++ = 0;
        }
    }
    for (uint32_t y = 0; y < n; y++) {
        for (uint32_t x = 0; x < n; x++, count += 2) {
            const uint32_t a = y * (n + 1) + x, b = a + n + 1;
            const uint32_t quad[6] = { a, a + 1, b, b, a + 1, b + 1 };
            memcpy(faces + 3 * count, quad, sizeof quad);
        }
    }
    return count;
}

static void reverse_faces(const uint32_t *faces, size_t count, uint32_t *out)
{
    for (size_t i = 0; i < count; i++) {
        out[3 * i] = faces[3 * i];
        out[3 * i + 1] = faces[3 * i + 2];
        out[3 * i + 2] = faces[3 * i + 1];
    }
}

TEST(import_makes_two_sheets_of_a_two_sided_one)
{
    enum { N = 6, FACES = 2 * N * N, VERTICES = (N + 1) * (N + 1) };
    double xyz[3 * VERTICES];
    uint32_t faces[6 * FACES];

    make_sheet(N, xyz, faces);
    reverse_faces(faces, FACES, faces + 3 * FACES);
    trial t = trial_of(xyz, VERTICES, faces, 2 * FACES);
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 2 * VERTICES);
    CHECK(open_edges(&t.mesh) == 2 * 4 * N);
    for (uint32_t h = 0; h < 6 * FACES; h++)
        CHECK(t.mesh.twin[h] == ENC_NONE ||
              t.mesh.twin[h] / (3 * FACES) == h / (3 * FACES));
    CHECK(t.mesh.bounds[2] == 0 && t.mesh.bounds[0] == 16383);
    finish(&t);
}

TEST(import_keeps_coincident_layers_apart_by_material)
{
    enum { N = 5, FACES = 2 * N * N, VERTICES = (N + 1) * (N + 1) };
    double xyz[3 * VERTICES];
    uint32_t faces[6 * FACES], materials[2 * FACES];

    make_sheet(N, xyz, faces);
    memcpy(faces + 3 * FACES, faces, 3 * FACES * sizeof *faces);
    for (uint32_t i = 0; i < 2 * FACES; i++)
        materials[i] = i / FACES;
    trial t = trial_of(xyz, VERTICES, faces, 2 * FACES);
    t.in.materials = materials;
    t.in.material_count = 2;
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 2 * VERTICES);
    CHECK(open_edges(&t.mesh) == 2 * 4 * N);
    CHECK(memcmp(t.mesh.material, materials, sizeof materials) == 0);
    finish(&t);
    t.in.materials = NULL;
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.duplicate_faces == FACES);
    CHECK(t.report.vertices == VERTICES && t.report.cut_vertices == 0);
    finish(&t);
    materials[7] = 2;
    t.in.materials = materials;
    CHECK(run(&t) == PMESH_E_INDEX && t.report.error_index == 7);
}

/*
 * Two flat tetrahedra share the edge 0-1, seen from the end:
 *
 *    3 ---___     ___--- 4    Their faces continue each other straight across
 *    |       >0,1<       |    the edge, so that it is in the surface twice and
 *    2 ---***     ***--- 5    both ends have one fan. One end must be cut.     */
TEST(import_cuts_a_fan_that_meets_a_neighbour_twice)
{
    static const double xyz[] = {
        0, 0, 0,  0, 0, 1,  -1, -0.1, 0.5,  -1, 0.1, 0.5,
        1, 0.1, 0.5,  1, -0.1, 0.5
    };
    static const uint32_t faces[] = {
        0, 1, 2,  0, 2, 3,  0, 3, 1,  1, 3, 2,
        0, 1, 4,  0, 4, 5,  0, 5, 1,  1, 5, 4
    };
    trial t = trial_of(xyz, 6, faces, 8);

    CHECK(run(&t) == PMESH_OK);
    CHECK(t.mesh.twin[0] == 20 && t.mesh.twin[12] == 8);
    CHECK(t.report.cut_vertices == 1 && open_edges(&t.mesh) == 4);
    CHECK(t.report.faces == 8 && t.report.components == 1);
    finish(&t);
}

TEST(import_counts_repeated_and_degenerate_faces)
{
    static const uint32_t faces[] = {
        0, 1, 2,  1, 2, 0,  2, 1, 0,  0, 0, 1,  1, 2, 3,  2, 0, 1,  3, 1, 2,
        5, 5, 5
    };
    trial t = trial_of(cube_corners, 8, faces, 8);

    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.faces == 3 && t.report.duplicate_faces == 3);
    CHECK(t.report.degenerate_faces == 2);
    CHECK(t.report.unused_vertices == 4);
    CHECK(t.mesh.vertex[0] == 0 && t.mesh.vertex[1] == 1);
    finish(&t);
}

TEST(import_drops_faces_that_are_not_finite)
{
    double xyz[8 * 3] = { 0 };
    trial t = trial_of(xyz, 8, cube_faces, 12);

    memcpy(xyz, cube_corners, sizeof xyz);
    xyz[0] = NAN; /* in three faces */
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.not_finite_faces == 3 && t.report.vertices == 7);
    finish(&t);
    for (int i = 0; i < 24; i += 3)
        xyz[i] = INFINITY;
    CHECK(run(&t) == PMESH_E_NOT_FINITE);
    CHECK(t.report.not_finite_faces == 12 && t.report.error_index == 0);
}

TEST(import_names_the_face_with_a_bad_index)
{
    uint32_t faces[36] = { 0 };
    trial t = trial_of(cube_corners, 8, faces, 12);

    memcpy(faces, cube_faces, sizeof faces);
    faces[17] = 8;
    CHECK(run(&t) == PMESH_E_INDEX && t.report.error_index == 5);
    faces[17] = UINT32_MAX;
    CHECK(run(&t) == PMESH_E_INDEX && t.report.error_index == 5);
}

TEST(import_rejects_illegal_arguments)
{
    const trial good = trial_of(cube_corners, 8, cube_faces, 12);
    trial t = good;

    t.in.face_count = 0;
    CHECK(run(&t) == PMESH_E_NO_FACES);
    t.in.face_count = ((size_t)1 << 30) / 3 + 1;
    CHECK(run(&t) == PMESH_E_LIMIT);
    t = good;
    t.in.indices = NULL;
    CHECK(run(&t) == PMESH_E_ARGUMENT);
    static const uint8_t illegal[][2] = {
        { PMESH_NORMAL, 2 }, { PMESH_TEXCOORD, 3 }, { PMESH_COLOR, 2 },
        { PMESH_COLOR, 5 }, { PMESH_GENERIC, 0 }, { PMESH_GENERIC, 5 },
        { 4, 3 }
    };
    for (size_t i = 0; i < sizeof illegal / sizeof *illegal; i++) {
        const float zeros[8 * 5] = { 0 };
        const pmesh_attribute_input attribute = {
            .kind = (pmesh_attribute_kind)illegal[i][0],
            .components = illegal[i][1], .values = zeros, .count = 8
        };
        t = good;
        t.in.attributes = &attribute;
        t.in.attribute_count = 1;
        CHECK(run(&t) == PMESH_E_ARGUMENT);
    }
    t = good;
    t.config.weld = NAN;
    CHECK(run(&t) == PMESH_E_ARGUMENT);
    t = good;
    t.config.position_bits = 25;
    CHECK(run(&t) == PMESH_E_ARGUMENT);
    t = good;
    t.in.position_stride = 8;
    CHECK(run(&t) == PMESH_E_ARGUMENT);
    pmesh_attribute_input normals = { .kind = PMESH_NORMAL, .components = 3,
                                      .values = NULL, .count = 8 };
    t = good;
    t.in.attributes = &normals;
    t.in.attribute_count = 1;
    CHECK(run(&t) == PMESH_E_ARGUMENT);
}

/* Sizes at the ends of what doubles can hold, and no size at all. */
TEST(import_takes_any_extent)
{
    static const double scales[] = { 1e-320, 1e-300, 1e300, 1e308 };
    double xyz[8 * 3] = { 0 };
    trial t = trial_of(xyz, 8, cube_faces, 12);

    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        for (int k = 0; k < 24; k++)
            xyz[k] = (cube_corners[k] - 0.5) * scales[i];
        t.config.position_bits = 24;
        CHECK(run(&t) == (i < 3 ? PMESH_OK : PMESH_E_NOT_FINITE));
        CHECK(i == 3 || (t.report.vertices == 8 && t.mesh.grid.step > 0));
        finish(&t);
    }
}

/* A coarse grid joins positions, not vertices. */
TEST(import_keeps_vertices_on_one_grid_point_apart)
{
    enum { N = 40, FACES = 2 * N * N, VERTICES = (N + 1) * (N + 1) };
    static double xyz[3 * VERTICES];
    static uint32_t faces[3 * FACES];

    make_sheet(N, xyz, faces);
    trial t = trial_of(xyz, VERTICES, faces, FACES);
    t.config.position_bits = 4;
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.vertices == VERTICES && t.report.faces == FACES);
    finish(&t);
}

/* A sheet with one chart left of x = 2 and one right of it. */
TEST(import_makes_wedges_along_a_seam)
{
    enum { N = 4, FACES = 2 * N * N, VERTICES = (N + 1) * (N + 1) };
    double xyz[3 * VERTICES];
    uint32_t faces[3 * FACES], corners[3 * FACES];
    float uv[2 * VERTICES][2];

    make_sheet(N, xyz, faces);
    for (uint32_t v = 0; v < 2 * VERTICES; v++) {
        uv[v][0] = (float)(v % VERTICES % (N + 1) + (v < VERTICES ? 0 : 9));
        uv[v][1] = (float)(v % VERTICES / (N + 1));
    }
    for (uint32_t c = 0; c < 3 * FACES; c++)
        corners[c] = faces[c] + (c / 6 % N < 2 ? 0 : VERTICES);
    const pmesh_attribute_input attribute = {
        .kind = PMESH_TEXCOORD, .set = 1, .components = 2, .bits = 10,
        .values = uv[0], .count = 2 * VERTICES, .indices = corners
    };
    trial t = trial_of(xyz, VERTICES, faces, FACES);
    t.in.attributes = &attribute;
    t.in.attribute_count = 1;
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.vertices == VERTICES);
    CHECK(t.report.wedges == VERTICES + N + 1);
    const pmesh_attribute *a = &t.mesh.attribute[0];
    CHECK(a->kind == PMESH_TEXCOORD && a->set == 1 && a->bits == 10);
    for (uint32_t c = 0; c < 3 * FACES; c++) {
        float out[2];
        pmesh_attribute_dequantize(a, t.mesh.value + 2 * t.mesh.wedge[c],
                                   out);
        CHECK(fabsf(out[0] - uv[corners[c]][0]) < 0.01f);
        CHECK(fabsf(out[1] - uv[corners[c]][1]) < 0.01f);
    }
    finish(&t);
    corners[10] = 2 * VERTICES;
    CHECK(run(&t) == PMESH_E_INDEX && t.report.error_index == 3);
}

/* Without indices tuples go with input vertices: equal ones make no seam. */
TEST(import_unites_equal_attributes_of_a_soup)
{
    double soup[36][3];
    float normals[36][4];
    uint32_t indices[36];

    for (uint32_t c = 0; c < 36; c++) {
        for (uint32_t k = 0; k < 3; k++)
            soup[c][k] = cube_corners[3 * cube_faces[c] + k];
        const uint32_t side = c / 6; /* -z +z -y +y -x +x */
        memset(normals[c], 0, sizeof normals[c]);
        normals[c][2 - side / 2] = side % 2 ? 1.0f : -1.0f;
        normals[c][3] = NAN;
        indices[c] = c;
    }
    const pmesh_attribute_input attribute = {
        .kind = PMESH_NORMAL, .components = 3, .values = normals[0],
        .count = 36, .stride = sizeof normals[0]
    };
    trial t = trial_of(soup[0], 36, indices, 12);
    t.in.attributes = &attribute;
    t.in.attribute_count = 1;
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 8 && t.report.wedges == 24);
    CHECK(t.report.not_finite_values == 0);
    finish(&t);
}

TEST(import_follows_cut_vertices_with_wedges)
{
    static const double xyz[] = {
        0, 0, 0,  1, 0, 0,  1, 1, 0,  -1, 0, 0,  -1, -1, 0
    };
    static const uint32_t faces[] = { 0, 1, 2, 0, 3, 4 };
    static const float colors[5][4] = {
        { 1, 0, 0, 1 }, { 0, 2, 0, -1 }, { NAN, 0, 0, 1 }
    };
    const pmesh_attribute_input attribute = {
        .kind = PMESH_COLOR, .components = 4, .values = colors[0], .count = 5
    };
    trial t = trial_of(xyz, 5, faces, 2);
    t.in.attributes = &attribute;
    t.in.attribute_count = 1;
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.wedges == 6 && t.mesh.value_count == 4);
    CHECK(t.report.not_finite_values == 2);
    CHECK(t.mesh.wedge[0] != t.mesh.wedge[3]);
    CHECK(memcmp(t.mesh.value + 4 * t.mesh.wedge[0],
                 t.mesh.value + 4 * t.mesh.wedge[3],
                 4 * sizeof *t.mesh.value) == 0);
    CHECK(t.mesh.value[4 * t.mesh.wedge[1] + 1] == 255);
    finish(&t);
}

TEST(import_repairs_normals_without_length)
{
    static const float normals[8][3] = {
        { 0, 0, 0 }, { 1, NAN, 0 }, { 1, 0, 0 }, { 0, 0, -2 }, { 0, 1, 0 },
        { 0, 1, 0 }, { 0, 1, 0 }, { 0, 1, 0 }
    };
    const pmesh_attribute_input attribute = {
        .kind = PMESH_NORMAL, .components = 3, .values = normals[0],
        .count = 8
    };
    trial t = trial_of(cube_corners, 8, cube_faces, 12);
    float out[3];

    t.in.attributes = &attribute;
    t.in.attribute_count = 1;
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.not_finite_values == 2 && t.report.wedges == 8);
    for (uint32_t w = 0; w < 4; w++) {
        pmesh_attribute_dequantize(&t.mesh.attribute[0],
                                   t.mesh.value + 2 * w, out);
        CHECK(out[2] == (w == 0 ? 1.0f : w == 3 ? -1.0f : 0.0f));
    }
    finish(&t);
}

TEST(check_notices_what_is_broken)
{
    trial t = trial_of(cube_corners, 8, cube_faces, 12);
    enc_mesh *mesh = &t.mesh;

    CHECK(run(&t) == PMESH_OK);
    const uint32_t twin = mesh->twin[0], corner = mesh->vertex[0];
    mesh->twin[0] = ENC_NONE;
    CHECK(enc_mesh_check(mesh) != NULL);
    mesh->twin[twin] = ENC_NONE; /* open, but both ways are still there */
    CHECK(enc_mesh_check(mesh) != NULL);
    mesh->twin[0] = twin;
    mesh->twin[twin] = 0;
    CHECK(enc_mesh_check(mesh) == NULL);
    mesh->vertex[0] = mesh->vertex[1];
    CHECK(enc_mesh_check(mesh) != NULL);
    mesh->vertex[0] = 8;
    CHECK(enc_mesh_check(mesh) != NULL);
    mesh->vertex[0] = corner;
    mesh->position[7][2]++;
    CHECK(enc_mesh_check(mesh) != NULL);
    mesh->position[7][2]--;
    CHECK(enc_mesh_check(mesh) == NULL);
    finish(&t);
    enc_mesh_destroy(NULL);
}

/* A random soup on few vertices, with everything that can be wrong. */
typedef struct soup {
    double xyz[64][3];
    uint32_t faces[200][3], materials[200], tuples[200][3];
    float values[16][2];
    pmesh_attribute_input attribute;
} soup;

static trial make_soup(soup *s, uint32_t seed)
{
    uint32_t random = seed * 7919 + 1;
    const uint32_t vertices = 4 + next_random(&random) % 60;
    const uint32_t faces = 1 + next_random(&random) % 200;
    const uint32_t side = 2 + next_random(&random) % 4;

    for (uint32_t v = 0; v < vertices; v++)
        for (int k = 0; k < 3; k++)
            s->xyz[v][k] = next_random(&random) % side;
    if (seed % 7 == 0)
        s->xyz[0][1] = NAN;
    for (uint32_t i = 0; i < faces; i++) {
        for (int k = 0; k < 3; k++) {
            s->faces[i][k] = next_random(&random) % vertices;
            s->tuples[i][k] = next_random(&random) % 16;
        }
        s->materials[i] = next_random(&random) % 2;
    }
    for (int i = 0; i < 16; i++)
        for (int k = 0; k < 2; k++)
            s->values[i][k] = (float)(next_random(&random) % 3);
    s->attribute = (pmesh_attribute_input){
        .kind = PMESH_GENERIC, .components = 2, .values = s->values[0],
        .count = 16, .indices = s->tuples[0]
    };
    trial t = trial_of(s->xyz[0], vertices, s->faces[0], faces);
    t.in.materials = seed % 3 ? NULL : s->materials;
    t.in.material_count = 2;
    t.in.attributes = &s->attribute;
    t.in.attribute_count = seed % 2;
    return t;
}

typedef struct flat_face {
    int32_t corner[3][3];
    uint32_t material;
} flat_face;

static int compare_faces(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(flat_face));
}

/* With the least corner first, so that rotation does not matter. */
static void rotate_face(flat_face *face)
{
    const size_t size = sizeof face->corner[0];

    for (int i = 0; i < 2; i++) {
        if (memcmp(face->corner[0], face->corner[1], size) <= 0 &&
            memcmp(face->corner[0], face->corner[2], size) <= 0)
            return;
        int32_t first[3];
        memcpy(first, face->corner[0], size);
        memmove(face->corner[0], face->corner[1], 2 * size);
        memcpy(face->corner[2], first, size);
    }
}

/* The input's faces by grid position, without those that must go: sorted, and
 * equal ones united. Positions of soups are equal only if they are welded. */
static size_t expected_faces(const trial *t, flat_face *out)
{
    size_t count = 0, kept = 0;

    for (size_t i = 0; i < t->in.face_count; i++) {
        flat_face *face = &out[count];
        bool finite = true;
        face->material = t->in.materials ? t->in.materials[i] : 0;
        for (size_t j = 0; j < 3; j++) {
            for (int k = 0; k < 3; k++) {
                const double x =
                    t->in.positions[3 * t->in.indices[3 * i + j] +
                                    (size_t)k];
                finite &= x == x;
                face->corner[j][k] =
                    pmesh_grid_quantize(&t->report.grid, k, x);
            }
        }
        const size_t size = sizeof face->corner[0];
        rotate_face(face);
        count += finite &&
            memcmp(face->corner[0], face->corner[1], size) != 0 &&
            memcmp(face->corner[1], face->corner[2], size) != 0 &&
            memcmp(face->corner[2], face->corner[0], size) != 0;
    }
    qsort(out, count, sizeof *out, compare_faces);
    for (size_t i = 0; i < count; i++)
        if (i == 0 || compare_faces(&out[i], &out[kept - 1]) != 0)
            out[kept++] = out[i];
    return kept;
}

TEST(import_conserves_the_faces_of_random_soups)
{
    static soup s;
    static flat_face expected[200], actual[200];

    for (uint32_t seed = 0; seed < 2000; seed++) {
        trial t = make_soup(&s, seed);
        const pmesh_status status = run(&t);
        if (status) {
            CHECK(status == PMESH_E_NO_FACES || status == PMESH_E_NOT_FINITE);
            continue;
        }
        for (uint32_t i = 0; i < t.mesh.face_count; i++) {
            for (uint32_t j = 0; j < 3; j++)
                memcpy(actual[i].corner[j],
                       t.mesh.position[t.mesh.vertex[3 * i + j]],
                       sizeof actual[i].corner[j]);
            actual[i].material = t.mesh.material[i];
            rotate_face(&actual[i]);
        }
        qsort(actual, t.mesh.face_count, sizeof *actual, compare_faces);
        CHECK(expected_faces(&t, expected) == t.mesh.face_count);
        CHECK(memcmp(actual, expected,
                     t.mesh.face_count * sizeof *actual) == 0);
        finish(&t);
    }
}

TEST(import_keeps_attributes_of_random_soups)
{
    static soup s;

    for (uint32_t seed = 1; seed < 400; seed += 2) {
        trial t = make_soup(&s, seed);
        if (run(&t))
            continue;
        CHECK(t.mesh.value_count == 2);
        uint32_t previous = 0;
        for (uint32_t w = 0; w < t.mesh.wedge_count; w++) {
            CHECK(t.mesh.wedge_vertex[w] >= previous); /* by vertex */
            previous = t.mesh.wedge_vertex[w];
            for (uint32_t v = w;
                 v-- > 0 && t.mesh.wedge_vertex[v] == previous;)
                CHECK(memcmp(t.mesh.value + 2 * w, t.mesh.value + 2 * v,
                             2 * sizeof *t.mesh.value) != 0);
        }
        finish(&t);
    }
}

TEST(import_survives_every_failing_allocation)
{
    static soup s;

    for (uint32_t seed = 1; seed < 40; seed++) {
        size_t allowed = 0;
        for (;; allowed++) {
            trial t = make_soup(&s, seed);
            t.config.weld = seed % 5 == 0 ? 0.5 : 0;
            t.acc.allowed = allowed;
            t.config.allocator =
                (pmesh_allocator){ account_alloc, account_release, &t.acc };
            const pmesh_status status =
                enc_mesh_import(&t.in, &t.config, &t.mesh, &t.report);
            if (status)
                CHECK(t.acc.bytes == 0);
            enc_mesh_destroy(&t.mesh);
            CHECK(t.acc.bytes == 0);
            if (status != PMESH_E_MEMORY)
                break;
        }
        CHECK(allowed > 3);
    }
}

/* `count` triangles around vertex 0, or all on the edge 0-1, or apart. */
typedef enum crowd_kind { CROWD_FAN, CROWD_EDGE, CROWD_APART } crowd_kind;

static void check_crowd(crowd_kind kind, uint32_t count)
{
    double *xyz = calloc(3 * (size_t)count + 6, 3 * sizeof *xyz);
    uint32_t *faces = calloc(3 * (size_t)count, sizeof *faces);
    uint32_t vertices = kind == CROWD_APART ? 3 * count : count + 2;

    CHECK(xyz && faces);
    for (uint32_t v = 0; v < 3 * vertices; v++)
        xyz[v] = (double)(v * v % 65521);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t spoke = 2 + i, next = 2 + (i + 1) % count;
        const uint32_t fan[3] = { 0, spoke, next };
        const uint32_t edge[3] = { i % 2, 1 - i % 2, spoke };
        const uint32_t apart[3] = { 3 * i, 3 * i + 1, 3 * i + 2 };
        memcpy(faces + 3 * i,
               kind == CROWD_FAN ? fan : kind == CROWD_EDGE ? edge : apart,
               sizeof fan);
    }
    trial t = trial_of(xyz, vertices, faces, count);
    CHECK(run(&t) == PMESH_OK);
    CHECK(t.report.faces == count);
    CHECK(t.acc.peak < 4096 + 150 * (size_t)count);
    finish(&t);
    free(faces);
    free(xyz);
}

TEST(import_is_linear_on_crowds)
{
    check_crowd(CROWD_FAN, 70000);
    check_crowd(CROWD_EDGE, 1000);
    check_crowd(CROWD_EDGE, 70000);
    check_crowd(CROWD_APART, 10000);
}
