/* SPDX-License-Identifier: MIT */
#include "tools/raster.h"

#include <math.h>
#include <stdlib.h>

#include "tools/shade.h"
#include "tools/topology.h"
#include "tools/trig.h"

#define GRID 3              /* samples per pixel and axis */
#define SUBSTEPS 256        /* positions per sample and axis */
#define FARTHEST 16.0       /* faces beyond this many extents are left out */
#define MARGIN 1.06         /* of the extent around the mesh */
#define CREASE 0.87         /* cosine: flatter edges are shaded smoothly */
#define WIRE_HEIGHT 14.0    /* pixels: lower faces get fainter wires */
#define WIRE_STRENGTH 0.55
#define WIRE_WIDTH 0.55     /* pixels on either side of an edge */

/* ---- camera ------------------------------------------------------------- */

static void rotate(const double rows[3][3], const double *v, double *out)
{
    for (size_t i = 0; i < 3; i++)
        out[i] = rows[i][0] * v[0] + rows[i][1] * v[1] + rows[i][2] * v[2];
}

static bool is_finite_face(const asset *mesh, size_t face)
{
    for (size_t c = 0; c < 9; c++) {
        const size_t v = mesh->indices[3 * face + c / 3];
        if (!isfinite(mesh->positions[3 * v + c % 3]))
            return false;
    }
    return true;
}

/* The box of all finite faces, halved, along the rows. */
static bool half_bounds(const asset *mesh, const double rows[3][3],
                        double low[3], double high[3])
{
    for (size_t k = 0; k < 3; k++) {
        low[k] = HUGE_VAL;
        high[k] = -HUGE_VAL;
    }
    for (size_t f = 0; f < mesh->face_count; f++) {
        if (!is_finite_face(mesh, f))
            continue;
        for (size_t c = 0; c < 3; c++) {
            const double *p =
                mesh->positions + 3 * (size_t)mesh->indices[3 * f + c];
            /* Scaled down: sums of huge coordinates would overflow. */
            const double v[3] = { p[0] / 8, p[1] / 8, p[2] / 8 };
            double q[3];
            rotate(rows, v, q);
            for (size_t k = 0; k < 3; k++) {
                low[k] = fmin(low[k], q[k] * 4);
                high[k] = fmax(high[k], q[k] * 4);
            }
        }
    }
    return low[0] <= high[0];
}

bool raster_camera_fit(raster_camera *out, const asset *mesh, double yaw,
                       double pitch)
{
    const double sy = trig_sin(yaw), cy = trig_cos(yaw);
    const double sp = trig_sin(pitch), cp = trig_cos(pitch);
    const double rows[3][3] = {
        { cy, 0, -sy },
        { -sp * sy, cp, -sp * cy },
        { cp * sy, sp, cp * cy },
    };
    double low[3], high[3], middle[3];

    if (!half_bounds(mesh, rows, low, high))
        return false;
    for (size_t k = 0; k < 3; k++)
        middle[k] = low[k] + high[k];
    for (size_t i = 0; i < 3; i++) {
        out->center[i] = 0;
        for (size_t k = 0; k < 3; k++) {
            out->rows[i][k] = rows[i][k];
            out->center[i] += rows[k][i] * middle[k]; /* rotated back */
        }
    }
    out->extent = fmax(high[0] - low[0], high[1] - low[1]) * MARGIN;
    if (!(out->extent > 0))
        out->extent = 1;
    return true;
}

/* ---- vertices ----------------------------------------------------------- */

/* What a mesh looks like from the camera. */
typedef struct scene {
    const asset *mesh;
    double *points;   /* per vertex: -1 .. 1 in the square */
    double *normals;  /* per joined vertex, unit or zero */
    uint32_t *joined; /* vertex -> first one at its position */
} scene;

static void face_normal(const scene *s, size_t face, double *n)
{
    const uint32_t *corner = s->mesh->indices + 3 * face;
    const double *a = s->points + 3 * (size_t)corner[0];
    const double *b = s->points + 3 * (size_t)corner[1];
    const double *c = s->points + 3 * (size_t)corner[2];
    const double u[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
    const double v[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };

    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
}

static void normalize(double *v)
{
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (size_t k = 0; k < 3 && length > 0; k++)
        v[k] /= length;
}

static bool is_in_reach(const scene *s, size_t face)
{
    for (size_t c = 0; c < 9; c++) {
        const size_t v = s->mesh->indices[3 * face + c / 3];
        if (!(fabs(s->points[3 * v + c % 3]) < FARTHEST))
            return false;
    }
    return true;
}

static bool prepare(scene *s, const asset *mesh, const raster_camera *camera)
{
    const size_t nv = mesh->vertex_count;

    *s = (scene){ .mesh = mesh };
    s->points = malloc((3 * nv + 1) * sizeof *s->points);
    s->normals = calloc(3 * nv + 1, sizeof *s->normals);
    s->joined = topology_join(mesh);
    if (!s->points || !s->normals || !s->joined)
        return false;
    for (size_t v = 0; v < nv; v++) {
        double local[3];
        for (size_t k = 0; k < 3; k++)
            local[k] = (mesh->positions[3 * v + k] - camera->center[k]) /
                       camera->extent;
        rotate(camera->rows, local, s->points + 3 * v);
    }
    for (size_t f = 0; f < mesh->face_count; f++) {
        double n[3];
        if (!is_in_reach(s, f))
            continue;
        face_normal(s, f, n); /* longer for larger faces: a fair weight */
        for (size_t c = 0; c < 9; c++)
            s->normals[3 * (size_t)s->joined[mesh->indices[3 * f + c / 3]] +
                       c % 3] += n[c % 3];
    }
    for (size_t v = 0; v < nv; v++)
        normalize(s->normals + 3 * v);
    return true;
}

static void release(scene *s)
{
    free(s->points);
    free(s->normals);
    free(s->joined);
}

/* ---- faces -------------------------------------------------------------- */

typedef struct target {
    int64_t side; /* samples */
    float *depth;
    uint32_t *color;
} target;

typedef struct corner {
    int64_t x, y; /* SUBSTEPS per sample, y down */
    double z, light, heat;
} corner;

typedef struct triangle {
    corner corners[3]; /* clockwise in the picture, y down */
    int64_t area2;     /* > 0, in SUBSTEPS^2 */
    double wire;       /* 0 .. 1 */
    double reach[3];   /* edge function of WIRE_WIDTH, per edge */
    bool inside;       /* seen from behind */
    bool warm;         /* its corners have heat */
} triangle;

static int64_t side_of(const corner *a, const corner *b, int64_t x, int64_t y)
{
    return (b->x - a->x) * (y - a->y) - (b->y - a->y) * (x - a->x);
}

static double light_of(const scene *s, size_t vertex, const double *face_n,
                       bool flat, bool inside)
{
    const double *n = s->normals + 3 * (size_t)s->joined[vertex];
    const double cosine =
        n[0] * face_n[0] + n[1] * face_n[1] + n[2] * face_n[2];
    return shade_light(flat || cosine < CREASE ? face_n : n, inside);
}

static void set_wire(triangle *t)
{
    double longest = 0;
    for (size_t i = 0; i < 3; i++) {
        const corner *a = &t->corners[(i + 1) % 3];
        const corner *b = &t->corners[(i + 2) % 3];
        const double dx = (double)(b->x - a->x);
        const double dy = (double)(b->y - a->y);
        const double length = sqrt(dx * dx + dy * dy);
        longest = fmax(longest, length);
        t->reach[i] = length * WIRE_WIDTH * GRID * SUBSTEPS;
    }
    const double height =
        (double)t->area2 / longest / (GRID * SUBSTEPS); /* pixels */
    t->wire = WIRE_STRENGTH * fmin(1, height / WIRE_HEIGHT);
}

/* False if the face cannot be seen at all. */
static bool set_up(const scene *s, size_t face, const raster_style *style,
                   int64_t side, triangle *t)
{
    const uint32_t *v = s->mesh->indices + 3 * face;
    double n[3];

    if (!is_in_reach(s, face))
        return false;
    for (size_t k = 0; k < 3; k++) {
        const double *p = s->points + 3 * (size_t)v[k];
        const double scale = (double)(side * SUBSTEPS) / 2;
        t->corners[k].x = (int64_t)floor((1 + p[0]) * scale + 0.5);
        t->corners[k].y = (int64_t)floor((1 - p[1]) * scale + 0.5);
        t->corners[k].z = p[2];
    }
    t->area2 = side_of(&t->corners[0], &t->corners[1], t->corners[2].x,
                       t->corners[2].y);
    if (t->area2 == 0)
        return false;
    t->inside = t->area2 > 0;
    face_normal(s, face, n);
    normalize(n);
    for (size_t k = 0; k < 3; k++)
        t->corners[k].light = light_of(s, v[k], n, style->flat, t->inside);
    t->warm = style->heat && (style->plain == 0 || face < style->plain);
    for (size_t k = 0; k < 3; k++)
        t->corners[k].heat = t->warm ? (double)style->heat[v[k]] : 0;
    if (t->area2 < 0) {
        const corner c = t->corners[1];
        t->corners[1] = t->corners[2];
        t->corners[2] = c;
        t->area2 = -t->area2;
    }
    t->wire = 0;
    if (style->wire)
        set_wire(t);
    return true;
}

/* b1 and b2: the shares of corners 1 and 2. */
static double mix(double c0, double c1, double c2, double b1, double b2)
{
    return c0 + b1 * (c1 - c0) + b2 * (c2 - c0);
}

static uint32_t color_at(const triangle *t, const int64_t w[3], double b1,
                         double b2)
{
    const corner *c = t->corners;
    const double light = mix(c[0].light, c[1].light, c[2].light, b1, b2);
    double wire = 0;
    if (t->wire > 0)
        for (size_t i = 0; i < 3; i++)
            if ((double)w[i] < t->reach[i])
                wire = t->wire;
    return t->warm
               ? shade_warm(light, mix(c[0].heat, c[1].heat, c[2].heat, b1, b2),
                            wire)
               : shade_color(light, t->inside, wire);
}

/* w[i] is the edge function opposite of corner i: their sum is the area. */
static void fill_sample(const target *to, const triangle *t, size_t at,
                        const int64_t w[3])
{
    const corner *c = t->corners;
    const double b1 = (double)w[1] / (double)t->area2;
    const double b2 = (double)w[2] / (double)t->area2;
    const float z = (float)mix(c[0].z, c[1].z, c[2].z, b1, b2);
    if (z <= to->depth[at])
        return;
    to->depth[at] = z;
    to->color[at] = color_at(t, w, b1, b2);
}

/* The first sample of a row whose centre is at or behind v. */
static int64_t first_sample(int64_t v, int64_t side)
{
    if (v <= 0)
        return 0;
    const int64_t i = (v + SUBSTEPS / 2 - 1) / SUBSTEPS;
    return i < side ? i : side;
}

/* The samples that may be covered: [x0, x1) and [y0, y1). */
static void bounds(const triangle *t, int64_t side, int64_t *x0, int64_t *x1,
                   int64_t *y0, int64_t *y1)
{
    const corner *c = t->corners;
    *x0 = *x1 = c[0].x;
    *y0 = *y1 = c[0].y;
    for (size_t k = 1; k < 3; k++) {
        *x0 = c[k].x < *x0 ? c[k].x : *x0;
        *x1 = c[k].x > *x1 ? c[k].x : *x1;
        *y0 = c[k].y < *y0 ? c[k].y : *y0;
        *y1 = c[k].y > *y1 ? c[k].y : *y1;
    }
    *x0 = first_sample(*x0, side);
    *y0 = first_sample(*y0, side);
    *x1 = first_sample(*x1 + 1, side);
    *y1 = first_sample(*y1 + 1, side);
}

static void fill(const target *to, const triangle *t)
{
    int64_t x0, x1, y0, y1;
    bounds(t, to->side, &x0, &x1, &y0, &y1);

    for (int64_t y = y0; y < y1; y++) {
        int64_t w[3], step[3];
        for (size_t i = 0; i < 3; i++) {
            const corner *a = &t->corners[(i + 1) % 3];
            const corner *b = &t->corners[(i + 2) % 3];
            w[i] = side_of(a, b, x0 * SUBSTEPS + SUBSTEPS / 2,
                           y * SUBSTEPS + SUBSTEPS / 2);
            step[i] = -(b->y - a->y) * SUBSTEPS;
        }
        for (int64_t x = x0; x < x1; x++) {
            if ((w[0] | w[1] | w[2]) >= 0)
                fill_sample(to, t, (size_t)(y * to->side + x), w);
            for (size_t i = 0; i < 3; i++)
                w[i] += step[i];
        }
    }
}

/* ---- picture ------------------------------------------------------------ */

/* Averages the samples of every pixel over what the picture shows already. */
static void resolve(const target *from, picture *p, uint32_t x, uint32_t y,
                    uint32_t size)
{
    for (uint32_t j = 0; j < size; j++) {
        for (uint32_t i = 0; i < size; i++) {
            uint32_t sum[3] = { 0 };
            uint32_t covered = 0;
            for (uint32_t k = 0; k < GRID * GRID; k++) {
                const size_t at =
                    (size_t)(j * GRID + k / GRID) * (size_t)from->side +
                    i * GRID + k % GRID;
                if (from->depth[at] == -HUGE_VALF)
                    continue;
                covered++;
                for (uint32_t c = 0; c < 3; c++)
                    sum[c] += from->color[at] >> (16 - 8 * c) & 0xFF;
            }
            if (covered == 0)
                continue;
            picture_color color = 0;
            for (uint32_t c = 0; c < 3; c++)
                color = color << 8 | (sum[c] + covered / 2) / covered;
            picture_blend(p, (int64_t)x + i, (int64_t)y + j, color,
                          (covered * 255 + GRID * GRID / 2) / (GRID * GRID));
        }
    }
}

bool raster_draw(picture *p, uint32_t x, uint32_t y, uint32_t size,
                 const asset *mesh, const raster_camera *camera,
                 const raster_style *style)
{
    target to = { .side = (int64_t)size * GRID };
    const size_t samples = (size_t)(to.side * to.side);
    scene s;

    bool ok = prepare(&s, mesh, camera);
    to.depth = malloc((samples + 1) * sizeof *to.depth);
    to.color = malloc((samples + 1) * sizeof *to.color);
    ok = ok && to.depth && to.color;
    if (ok) {
        for (size_t i = 0; i < samples; i++)
            to.depth[i] = -HUGE_VALF;
        for (size_t f = 0; f < mesh->face_count; f++) {
            triangle t;
            if (set_up(&s, f, style, to.side, &t))
                fill(&to, &t);
        }
        resolve(&to, p, x, y, size);
    }
    release(&s);
    free(to.depth);
    free(to.color);
    return ok;
}
