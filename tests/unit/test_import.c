/* SPDX-License-Identifier: MIT */
#include "encoder/enc_mesh.h"
#include "format/quantize.h"
#include "tests/unit/import_trial.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

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
    trial t = import_trial_of(cube_corners, 8, cube_faces, 12);

    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 8 && t.report.components == 1);
    CHECK(t.report.welded_vertices + t.report.cut_vertices +
              t.report.unused_vertices == 0);
    CHECK(memcmp(t.mesh.vertex, cube_faces, sizeof cube_faces) == 0);
    CHECK(import_open_edges(&t.mesh) == 0);
    for (int k = 0; k < 3; k++)
        CHECK(t.mesh.bounds[k] == 16383 && t.mesh.position[7][k] == 16383);
    CHECK(t.mesh.grid.step == 1.0 / 16383);
    CHECK(!t.mesh.wedge && !t.mesh.material && t.mesh.material_count == 1);
    import_finish(&t);
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
    trial t = import_trial_of(soup[0], 36, indices, 12);
    t.in.position_stride = sizeof soup[0];
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 8 && t.report.welded_vertices == 28);
    CHECK(import_open_edges(&t.mesh) == 0 && t.report.components == 1);
    import_finish(&t);
}

TEST(import_welds_close_vertices_when_asked)
{
    /* Four points in a row, 0.09 apart, close the gap of two triangles. */
    static const double xyz[] = {
        0, 0, 0,  1, 0, 0,     0, 1, 0,
        1, 1, 0,  1.09, 0, 0,  -0.09, 1, 0,  1.18, 0, 0, 5, 5, 0
    };
    static const uint32_t faces[] = { 0, 1, 2, 3, 5, 6, 0, 4, 7 };
    trial t = import_trial_of(xyz, 8, faces, 3);

    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 9 && t.report.cut_vertices == 1);
    import_finish(&t);
    t.config.weld = 0.1;
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.welded_vertices == 3);
    CHECK(t.report.components == 1);
    CHECK(t.mesh.twin[1] == 4 && t.mesh.twin[4] == 1);
    import_finish(&t);
    t.config.weld = 100; /* everything */
    CHECK(import_run(&t) == PMESH_E_NO_FACES);
    CHECK(t.report.degenerate_faces == 3);
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
                xyz[v][k] = (double)import_random(&random) / 16777216.0 - 0.5;
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
        trial t = import_trial_of(xyz[0], COUNT, faces, FACES);
        t.config.weld = weld;
        const pmesh_status status = import_run(&t);
        CHECK(status == PMESH_OK || status == PMESH_E_NO_FACES);
        CHECK(t.report.degenerate_faces == degenerate);
        import_finish(&t);
    }
}

TEST(import_splits_a_bow_tie)
{
    static const double xyz[] = {
        0, 0, 0,  1, 0, 0,  1, 1, 0,  -1, 0, 0,  -1, -1, 0
    };
    static const uint32_t faces[] = { 0, 1, 2, 0, 3, 4 };
    trial t = import_trial_of(xyz, 5, faces, 2);

    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.cut_vertices == 1 && t.report.components == 1);
    CHECK(t.mesh.vertex[0] == 0 && t.mesh.vertex[3] == 5);
    CHECK(memcmp(t.mesh.position[0], t.mesh.position[5],
                 sizeof *t.mesh.position) == 0);
    import_finish(&t);
}

TEST(import_leaves_a_bow_tie_its_knot_when_fans_may_join)
{
    static const double xyz[] = {
        0, 0, 0,  1, 0, 0,  1, 1, 0,  -1, 0, 0,  -1, -1, 0
    };
    static const uint32_t faces[] = { 0, 1, 2, 0, 3, 4 };
    trial t = import_trial_of(xyz, 5, faces, 2);

    t.config.topology = PMESH_TOPOLOGY_AUTO;
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.joined && t.mesh.joined);
    CHECK(t.report.cut_vertices == 0 && t.report.joined_vertices == 1);
    CHECK(memcmp(t.mesh.vertex, faces, sizeof faces) == 0);
    import_finish(&t);
}

TEST(import_gives_fans_beyond_the_48th_another_vertex)
{
    enum { FANS = 100 };
    double xyz[1 + 2 * FANS][3] = { { 0 } };
    uint32_t faces[FANS][3];

    for (uint32_t i = 0; i < FANS; i++) {
        for (uint32_t k = 0; k < 3; k++)
            faces[i][k] = k == 0 ? 0 : 2 * i + k;
        for (uint32_t k = 0; k < 2; k++) {
            xyz[1 + 2 * i + k][0] = i + 1;
            xyz[1 + 2 * i + k][1] = k;
        }
    }
    trial t = import_trial_of(xyz[0], 1 + 2 * FANS, faces[0], FANS);
    t.config.topology = PMESH_TOPOLOGY_JOIN;
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.cut_vertices == 2 && t.report.joined_vertices == 1);
    for (uint32_t i = 0; i < FANS; i++)
        CHECK(t.mesh.vertex[3 * i] == (i < 48 ? 0 : 200 + i / 48));
    import_finish(&t);
}

TEST(import_pairs_the_flatter_of_three_faces)
{
    static const double xyz[] = {
        0, 0, 0,  0, 1, 0,  1, 0, 0,  -1, 0, 0,  0.2, 0, 1
    };
    static const uint32_t faces[] = { 1, 0, 4, 0, 1, 3, 1, 0, 2 };
    trial t = import_trial_of(xyz, 5, faces, 3);

    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.mesh.twin[0] == ENC_NONE);
    CHECK(t.mesh.twin[3] == 6 && t.mesh.twin[6] == 3);
    CHECK(t.report.cut_vertices == 2 && t.report.components == 1);
    import_finish(&t);
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
    trial t = import_trial_of(xyz, 16, faces, 24);
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.welded_vertices == 2 && t.report.cut_vertices == 2);
    CHECK(import_open_edges(&t.mesh) == 0);
    for (uint32_t h = 0; h < 72; h++)
        CHECK(t.mesh.twin[h] / 36 == h / 36);
    import_finish(&t);
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
    trial t = import_trial_of(xyz[0], 2 * QUADS, faces[0], 2 * QUADS);
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.faces == 2 * QUADS && t.report.components == 1);
    CHECK(t.report.cut_vertices == 2);
    CHECK(import_open_edges(&t.mesh) == 2 * QUADS + 2);
    import_finish(&t);
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
    trial t = import_trial_of(xyz, VERTICES, faces, 2 * FACES);
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 2 * VERTICES);
    CHECK(import_open_edges(&t.mesh) == 2 * 4 * N);
    for (uint32_t h = 0; h < 6 * FACES; h++)
        CHECK(t.mesh.twin[h] == ENC_NONE ||
              t.mesh.twin[h] / (3 * FACES) == h / (3 * FACES));
    CHECK(t.mesh.bounds[2] == 0 && t.mesh.bounds[0] == 16383);
    import_finish(&t);
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
    trial t = import_trial_of(xyz, VERTICES, faces, 2 * FACES);
    t.in.materials = materials;
    t.in.material_count = 2;
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 2 * VERTICES);
    CHECK(import_open_edges(&t.mesh) == 2 * 4 * N);
    CHECK(memcmp(t.mesh.material, materials, sizeof materials) == 0);
    import_finish(&t);
    t.in.materials = NULL;
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.duplicate_faces == FACES);
    CHECK(t.report.vertices == VERTICES && t.report.cut_vertices == 0);
    import_finish(&t);
    materials[7] = 2;
    t.in.materials = materials;
    CHECK(import_run(&t) == PMESH_E_INDEX && t.report.error_index == 7);
}

/*
 * Two flat tetrahedra share the edge 0-1, seen from the end:
 *
 *    3 ---___     ___--- 4    Their faces continue each other straight across
 *    |       >0,1<       |    the edge, so that it is in the surface twice and
 *    2 ---***     ***--- 5    both ends have one fan. One end must be cut. */
TEST(import_cuts_a_fan_that_meets_a_neighbour_twice)
{
    static const double xyz[] = { 0,  0,   0,   0, 0,   1,   -1, -0.1, 0.5,
                                  -1, 0.1, 0.5, 1, 0.1, 0.5, 1,  -0.1, 0.5 };
    static const uint32_t faces[] = {
        0, 1, 2,  0, 2, 3,  0, 3, 1,  1, 3, 2,
        0, 1, 4,  0, 4, 5,  0, 5, 1,  1, 5, 4
    };
    trial t = import_trial_of(xyz, 6, faces, 8);

    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.mesh.twin[0] == 20 && t.mesh.twin[12] == 8);
    CHECK(t.report.cut_vertices == 1 && import_open_edges(&t.mesh) == 4);
    CHECK(t.report.faces == 8 && t.report.components == 1);
    import_finish(&t);
}

TEST(import_counts_repeated_and_degenerate_faces)
{
    static const uint32_t faces[] = {
        0, 1, 2,  1, 2, 0,  2, 1, 0,  0, 0, 1,  1, 2, 3,  2, 0, 1,  3, 1, 2,
        5, 5, 5
    };
    trial t = import_trial_of(cube_corners, 8, faces, 8);

    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.faces == 3 && t.report.duplicate_faces == 3);
    CHECK(t.report.degenerate_faces == 2);
    CHECK(t.report.unused_vertices == 4);
    CHECK(t.mesh.vertex[0] == 0 && t.mesh.vertex[1] == 1);
    import_finish(&t);
}

TEST(import_drops_faces_that_are_not_finite)
{
    double xyz[8 * 3] = { 0 };
    trial t = import_trial_of(xyz, 8, cube_faces, 12);

    memcpy(xyz, cube_corners, sizeof xyz);
    xyz[0] = NAN; /* in three faces */
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.not_finite_faces == 3 && t.report.vertices == 7);
    import_finish(&t);
    for (int i = 0; i < 24; i += 3)
        xyz[i] = INFINITY;
    CHECK(import_run(&t) == PMESH_E_NOT_FINITE);
    CHECK(t.report.not_finite_faces == 12 && t.report.error_index == 0);
}

TEST(import_names_the_face_with_a_bad_index)
{
    uint32_t faces[36] = { 0 };
    trial t = import_trial_of(cube_corners, 8, faces, 12);

    memcpy(faces, cube_faces, sizeof faces);
    faces[17] = 8;
    CHECK(import_run(&t) == PMESH_E_INDEX && t.report.error_index == 5);
    faces[17] = UINT32_MAX;
    CHECK(import_run(&t) == PMESH_E_INDEX && t.report.error_index == 5);
}

TEST(import_rejects_illegal_arguments)
{
    const trial good = import_trial_of(cube_corners, 8, cube_faces, 12);
    trial t = good;

    t.in.face_count = 0;
    CHECK(import_run(&t) == PMESH_E_NO_FACES);
    t.in.face_count = ((size_t)1 << 30) / 3 + 1;
    CHECK(import_run(&t) == PMESH_E_LIMIT);
    t = good;
    t.in.indices = NULL;
    CHECK(import_run(&t) == PMESH_E_ARGUMENT);
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
        CHECK(import_run(&t) == PMESH_E_ARGUMENT);
    }
    t = good;
    t.config.weld = NAN;
    CHECK(import_run(&t) == PMESH_E_ARGUMENT);
    t = good;
    t.config.position_bits = 25;
    CHECK(import_run(&t) == PMESH_E_ARGUMENT);
    t = good;
    t.in.position_stride = 8;
    CHECK(import_run(&t) == PMESH_E_ARGUMENT);
    pmesh_attribute_input normals = { .kind = PMESH_NORMAL, .components = 3,
                                      .values = NULL, .count = 8 };
    t = good;
    t.in.attributes = &normals;
    t.in.attribute_count = 1;
    CHECK(import_run(&t) == PMESH_E_ARGUMENT);
}

/* Sizes at the ends of what doubles can hold, and no size at all. */
TEST(import_takes_any_extent)
{
    static const double scales[] = { 1e-320, 1e-300, 1e300, 1e308 };
    double xyz[8 * 3] = { 0 };
    trial t = import_trial_of(xyz, 8, cube_faces, 12);

    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        for (int k = 0; k < 24; k++)
            xyz[k] = (cube_corners[k] - 0.5) * scales[i];
        t.config.position_bits = 24;
        CHECK(import_run(&t) == (i < 3 ? PMESH_OK : PMESH_E_NOT_FINITE));
        CHECK(i == 3 || (t.report.vertices == 8 && t.mesh.grid.step > 0));
        import_finish(&t);
    }
}

/* A coarse grid joins positions, not vertices. */
TEST(import_keeps_vertices_on_one_grid_point_apart)
{
    enum { N = 40, FACES = 2 * N * N, VERTICES = (N + 1) * (N + 1) };
    static double xyz[3 * VERTICES];
    static uint32_t faces[3 * FACES];

    make_sheet(N, xyz, faces);
    trial t = import_trial_of(xyz, VERTICES, faces, FACES);
    t.config.position_bits = 4;
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.vertices == VERTICES && t.report.faces == FACES);
    import_finish(&t);
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
    trial t = import_trial_of(xyz, VERTICES, faces, FACES);
    t.in.attributes = &attribute;
    t.in.attribute_count = 1;
    CHECK(import_run(&t) == PMESH_OK);
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
    import_finish(&t);
    corners[10] = 2 * VERTICES;
    CHECK(import_run(&t) == PMESH_E_INDEX && t.report.error_index == 3);
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
    trial t = import_trial_of(soup[0], 36, indices, 12);
    t.in.attributes = &attribute;
    t.in.attribute_count = 1;
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.vertices == 8 && t.report.wedges == 24);
    CHECK(t.report.not_finite_values == 0);
    import_finish(&t);
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
    trial t = import_trial_of(xyz, 5, faces, 2);
    t.in.attributes = &attribute;
    t.in.attribute_count = 1;
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.wedges == 6 && t.mesh.value_count == 4);
    CHECK(t.report.not_finite_values == 2);
    CHECK(t.mesh.wedge[0] != t.mesh.wedge[3]);
    CHECK(memcmp(t.mesh.value + 4 * t.mesh.wedge[0],
                 t.mesh.value + 4 * t.mesh.wedge[3],
                 4 * sizeof *t.mesh.value) == 0);
    CHECK(t.mesh.value[4 * t.mesh.wedge[1] + 1] == 255);
    import_finish(&t);
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
    trial t = import_trial_of(cube_corners, 8, cube_faces, 12);
    float out[3];

    t.in.attributes = &attribute;
    t.in.attribute_count = 1;
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.not_finite_values == 2 && t.report.wedges == 8);
    for (uint32_t w = 0; w < 4; w++) {
        pmesh_attribute_dequantize(&t.mesh.attribute[0],
                                   t.mesh.value + 2 * w, out);
        CHECK(out[2] == (w == 0 ? 1.0f : w == 3 ? -1.0f : 0.0f));
    }
    import_finish(&t);
}

TEST(check_notices_what_is_broken)
{
    trial t = import_trial_of(cube_corners, 8, cube_faces, 12);
    enc_mesh *mesh = &t.mesh;

    CHECK(import_run(&t) == PMESH_OK);
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
    import_finish(&t);
    enc_mesh_destroy(NULL);
}
