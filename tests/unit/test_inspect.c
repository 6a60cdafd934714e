/* SPDX-License-Identifier: MIT */
#include "encoder/pmesh_inspect.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_eigen.h"
#include "tests/unit/test.h"
#include "tools/glyphs.h"
#include "tools/heat.h"
#include "tools/plot.h"
#include "tools/raster.h"
#include "tools/sample.h"
#include "tools/topology.h"

/* Two sides of a right angle along x, n cells a side: a flat side, an edge. */
static asset ridge(uint32_t n)
{
    const uint32_t row = n + 1, rows = 2 * n + 1;
    asset m = { .vertex_count = (size_t)row * rows,
                .face_count = (size_t)4 * n * n };
    m.positions = calloc(3 * m.vertex_count, sizeof *m.positions);
    m.indices = calloc(3 * m.face_count, sizeof *m.indices);
    for (uint32_t j = 0; j < rows; j++)
        for (uint32_t i = 0; i < row; i++) {
            double *p = m.positions + 3 * ((size_t)j * row + i);
            p[0] = i;
            p[1] = j < n ? (double)(n - j) : 0;
            p[2] = j > n ? (double)(j - n) : 0;
        }
    uint32_t *f = m.indices;
    for (uint32_t j = 0; j + 1 < rows; j++)
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t a = j * row + i;
            const uint32_t quad[6] = { a, a + 1, a + row + 1,
                                       a, a + row + 1, a + row };
            memcpy(f, quad, sizeof quad);
            f += 6;
        }
    return m;
}

static pmesh_mesh_input input_of(const asset *m)
{
    return (pmesh_mesh_input){ .positions = m->positions,
                               .vertex_count = m->vertex_count,
                               .indices = m->indices,
                               .face_count = m->face_count };
}

TEST(inspect_costs_nothing_where_an_edge_may_go)
{
    asset m = ridge(6);
    const pmesh_mesh_input in = input_of(&m);
    double *cost = calloc(m.vertex_count, sizeof *cost);

    m.positions[3 * (7 * 3 + 3) + 2] = 0.5; /* a bump on the first side */
    CHECK(pmesh_inspect_costs(&in, NULL, cost) == PMESH_OK);
    CHECK(cost[7 * 10 + 3] < 1e-9); /* flat */
    CHECK(cost[7 * 6 + 3] < 1e-9);  /* along the edge */
    CHECK(cost[7 * 3 + 3] > 1e-2);  /* the bump */
    free(cost);
    asset_free(&m);
}

/* Flat: thin across, wide along; an edge: wide along itself alone. */
TEST(inspect_ellipsoids_show_the_shape)
{
    asset m = ridge(6);
    const pmesh_mesh_input in = input_of(&m);
    const uint32_t at[2] = { 7 * 10 + 3, 7 * 6 + 3 };
    pmesh_ellipsoid e[2];

    CHECK(pmesh_inspect_ellipsoids(&in, NULL, at, 2, 0.1, 5, e) == PMESH_OK);
    CHECK(fabs(e[0].radius[0] - 0.1) < 1e-9);
    CHECK(e[0].radius[1] == 5 && e[0].radius[2] == 5);
    CHECK(fabs(fabs(e[0].axis[0][1]) - 1) < 1e-9);
    CHECK(e[0].center[0] == 3 && e[0].center[2] == 4);
    CHECK(e[1].radius[1] < 0.2 && e[1].radius[2] == 5);
    CHECK(fabs(fabs(e[1].axis[2][0]) - 1) < 1e-9);
    asset_free(&m);
}

TEST(inspect_refuses_what_makes_no_sense)
{
    asset m = ridge(2);
    pmesh_mesh_input in = input_of(&m);
    const uint32_t beyond = (uint32_t)m.vertex_count;
    pmesh_ellipsoid e;
    double cost[16];

    CHECK(pmesh_inspect_ellipsoids(&in, NULL, &beyond, 1, 1, 1, &e) ==
          PMESH_E_INDEX);
    CHECK(pmesh_inspect_ellipsoids(&in, NULL, &beyond, 0, 0, 1, &e) ==
          PMESH_E_ARGUMENT);
    CHECK(pmesh_inspect_ellipsoids(&in, NULL, &beyond, 0, 1, NAN, &e) ==
          PMESH_E_ARGUMENT);
    m.indices[5] = beyond;
    CHECK(pmesh_inspect_costs(&in, NULL, cost) == PMESH_E_INDEX);
    in.indices = NULL;
    CHECK(pmesh_inspect_costs(&in, NULL, cost) == PMESH_E_ARGUMENT);
    asset_free(&m);
}

TEST(eigen_finds_axes_of_any_matrix)
{
    uint32_t seed = 5;
    for (int round = 0; round < 200; round++) {
        double m[6], value[3], axis[3][3];
        for (int i = 0; i < 6; i++) {
            seed = seed * 1664525u + 1013904223u;
            m[i] = (double)(seed >> 16) / 32768 - 1;
        }
        const double full[3][3] = { { m[0], m[1], m[2] },
                                    { m[1], m[3], m[4] },
                                    { m[2], m[4], m[5] } };
        enc_eigen(m, value, axis);
        CHECK(value[0] >= value[1] && value[1] >= value[2]);
        for (int i = 0; i < 3; i++) {
            double length = 0;
            for (int k = 0; k < 3; k++) {
                double image = 0;
                for (int l = 0; l < 3; l++)
                    image += full[k][l] * axis[i][l];
                CHECK(fabs(image - value[i] * axis[i][k]) < 1e-12);
                length += axis[i][k] * axis[i][k];
            }
            CHECK(fabs(length - 1) < 1e-12);
        }
    }
}

TEST(heat_measures_the_distance_of_a_level)
{
    asset m = ridge(4), level = ridge(4);
    double diagonal;
    float out[64];

    for (size_t v = 0; v < level.vertex_count; v++)
        level.positions[3 * v + 1] -= 0.25; /* beyond the edge */
    CHECK(heat_distances(&m, &level, out, &diagonal));
    CHECK(fabs(diagonal - sqrt(48)) < 1e-9);
    CHECK(fabs((double)out[5 * 6 + 2] - 0.25) < 1e-6);
    CHECK(out[5 * 2 + 2] < 1e-6f); /* the other side slid along itself */
    asset_free(&m);
    asset_free(&level);
}

/* The pixels of a picture with all of it, on any machine. */
TEST(heat_and_glyphs_draw_the_same_pixels_everywhere)
{
    asset mesh;
    raster_camera camera;
    picture p;
    heat h;
    uint64_t hash = 14695981039346656037u;

    CHECK(sample_build(4000, &mesh));
    CHECK(heat_of_costs(&mesh, &h));
    raster_style style = { .heat = h.value, .plain = mesh.face_count };
    CHECK(raster_camera_fit(&camera, &mesh, -0.1, 0.05));
    const size_t before = mesh.face_count;
    CHECK(glyphs_add(&mesh, 40) && mesh.face_count == before + 40 * 100);
    CHECK(picture_create(&p, 128, 128, 0xFFFFFF));
    CHECK(raster_draw(&p, 0, 0, 128, &mesh, &camera, &style));
    for (size_t i = 0; i < 3 * 128 * 128; i++)
        hash = (hash ^ p.rgb[i]) * 1099511628211u;
    CHECK(hash == 0xe34530c9c3ea4758u);
    picture_free(&p);
    heat_free(&h);
    asset_free(&mesh);
}

/* Each ball is closed and turned outward. */
TEST(glyphs_are_closed)
{
    asset m = ridge(5);
    topology_report report;

    const size_t faces = m.face_count;
    CHECK(glyphs_add(&m, 7));
    m.face_count -= faces;
    memmove(m.indices, m.indices + 3 * faces,
            3 * m.face_count * sizeof *m.indices);
    CHECK(topology_measure(&m, &report));
    CHECK(report.components == 7 && report.euler == 14);
    CHECK(report.boundary_edges == 0 && report.misoriented_edges == 0);
    double volume = 0;
    for (size_t f = 0; f < m.face_count; f++) {
        const double *a = m.positions + 3 * (size_t)m.indices[3 * f];
        const double *b = m.positions + 3 * (size_t)m.indices[3 * f + 1];
        const double *c = m.positions + 3 * (size_t)m.indices[3 * f + 2];
        for (int k = 0; k < 3; k++)
            volume += a[k] * (b[(k + 1) % 3] * c[(k + 2) % 3] -
                              b[(k + 2) % 3] * c[(k + 1) % 3]) / 6;
    }
    CHECK(volume > 0);
    asset_free(&m);
}

TEST(plot_writes_svg_for_any_points)
{
    static plot_curve curves[2];
    asset_bytes out = { 0 };

    memset(curves, 0, sizeof curves);
    strcpy(curves[0].name, "a<b>&\"\xff.pmesh");
    plot_add(&curves[0], 1000, 0.01);
    plot_add(&curves[0], 0, 1);    /* no logarithm */
    plot_add(&curves[0], NAN, 1);
    plot_add(&curves[0], 20000, 0.0001);
    CHECK(curves[0].count == 2);
    CHECK(plot_write(curves, 2, "x", "y", &out));
    asset_put(&out, "", 1);
    const char *text = (const char *)out.data;
    CHECK(strstr(text, "a&lt;b&gt;&amp;\"?.pmesh</text>"));
    CHECK(strstr(text, "M74.00 24.00L") && strstr(text, ">1e5</text>"));
    CHECK(strstr(text, "</svg>\n"));
    asset_bytes_free(&out);
}
