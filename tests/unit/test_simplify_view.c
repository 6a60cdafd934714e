/* SPDX-License-Identifier: MIT */
#include "encoder/pmesh_simplify.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/lods.h"
#include "tests/unit/test.h"

enum { SIZE = 200 }; /* pixels */

/* A camera on the y axis that looks at the origin; one unit wide at one unit's
 * distance on either side. */
static void project(const double p[3], double camera, double out[3])
{
    out[2] = camera - p[1];
    out[0] = SIZE / 2 * (1 + p[0] / out[2]);
    out[1] = SIZE / 2 * (1 + p[2] / out[2]);
}

static void draw_face(const double p[3][3], double shade, double *image,
                      double *near)
{
    double low[2] = { SIZE, SIZE }, high[2] = { 0, 0 };
    const double area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) -
                        (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);

    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], fmax(p[k][i], 0));
            high[i] = fmax(high[i], fmin(p[k][i], SIZE - 1));
        }
    for (int y = (int)low[1]; y <= (int)high[1]; y++)
        for (int x = (int)low[0]; x <= (int)high[0]; x++) {
            double weight[3], depth = 0;
            for (int k = 0; k < 3; k++) {
                const double *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
                weight[k] = ((a[0] - x - 0.5) * (b[1] - y - 0.5) -
                             (a[1] - y - 0.5) * (b[0] - x - 0.5)) /
                            area;
                depth += weight[k] / p[k][2];
            }
            if (weight[0] >= 0 && weight[1] >= 0 && weight[2] >= 0 &&
                depth > near[y * SIZE + x]) {
                near[y * SIZE + x] = depth;
                image[y * SIZE + x] = shade;
            }
        }
}

static double *draw(const double *xyz, const uint32_t *tri, size_t faces,
                    double camera)
{
    double *image = calloc(SIZE * SIZE, sizeof *image);
    double *near = calloc(SIZE * SIZE, sizeof *near);

    for (size_t f = 0; f < faces; f++) {
        double p[3][3], a[3], b[3];
        for (size_t k = 0; k < 3; k++)
            project(&xyz[3 * (size_t)tri[3 * f + k]], camera, p[k]);
        for (size_t i = 0; i < 3; i++) {
            const double from = xyz[3 * (size_t)tri[3 * f] + i];
            a[i] = xyz[3 * (size_t)tri[3 * f + 1] + i] - from;
            b[i] = xyz[3 * (size_t)tri[3 * f + 2] + i] - from;
        }
        const double n[3] = { a[1] * b[2] - a[2] * b[1],
                              a[2] * b[0] - a[0] * b[2],
                              a[0] * b[1] - a[1] * b[0] };
        const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (length > 0 && n[1] > 0)
            draw_face((const double (*)[3])p, 0.2 + 0.8 * n[1] / length, image,
                      near);
    }
    free(near);
    return image;
}

/* Of the level's drawing against the original's; what neither covers is not
 * counted. */
static double psnr(const lods *l, double camera)
{
    double *a = draw(l->xyz, l->tri, l->in.face_count, camera);
    double *b = draw(l->out.positions, l->out.indices, l->out.face_count,
                     camera);
    double sum = 0;
    size_t count = 0;

    for (size_t i = 0; i < SIZE * SIZE; i++) {
        if (a[i] <= 0 && b[i] <= 0)
            continue;
        sum += (a[i] - b[i]) * (a[i] - b[i]);
        count++;
    }
    free(a);
    free(b);
    return -10 * log10(sum / (double)count);
}

/* A long bumpy body, its near end close to the camera. */
static lods *body(uint32_t size)
{
    lods *l = lods_sphere(size);

    for (size_t v = 0; v < l->in.vertex_count; v++) {
        double *p = &l->xyz[3 * v];
        const double bump =
            1 + 0.06 * sin(9 * p[0]) * sin(9 * p[2]) * cos(7 * p[1]);
        p[0] *= bump;
        p[2] *= bump;
        p[1] *= 3 * bump;
    }
    return l;
}

TEST(error_as_a_camera_sees_it_gives_the_best_picture)
{
    static const pmesh_cost costs[3] = { PMESH_COST_QUADRIC_CAMERA,
                                         PMESH_COST_QUADRIC,
                                         PMESH_COST_CAMERA };
    const double camera = 5;
    double quality[3];
    lods *l = body(40);

    l->options.faces = 600;
    l->options.camera[1] = camera;
    for (int k = 0; k < 3; k++) {
        l->options.cost = costs[k];
        CHECK(lods_run(l) == PMESH_OK);
        quality[k] = psnr(l, camera);
    }
    CHECK(quality[0] > quality[1] && quality[0] > quality[2]);
    lods_free(l);
}

/* 98 % of the faces less, so far away that it covers some pixels only. */
TEST(far_away_a_fiftieth_of_the_faces_looks_alike)
{
    lods *l = body(60);
    double mean = 0;

    l->options.faces = l->in.face_count / 50;
    CHECK(lods_run(l) == PMESH_OK);
    double *a = draw(l->xyz, l->tri, l->in.face_count, 60);
    double *b = draw(l->out.positions, l->out.indices, l->out.face_count, 60);
    for (size_t i = 0; i < SIZE * SIZE; i++)
        mean += fabs(a[i] - b[i]) / (SIZE * SIZE);
    CHECK(mean < 1.0 / 255);
    free(a);
    free(b);
    lods_free(l);
}
