/* SPDX-License-Identifier: MIT */
#include "encoder/enc_guide_pull.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_eigen.h"
#include "encoder/enc_import.h"
#include "format/alloc.h"

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void enc_pull_line(enc_quadric *q, const double t[3], double weight)
{
    const double square = dot(t, t);
    const double w = square > 0 ? weight / square : 0;

    enc_pull_point(q, weight);
    q->a[0] -= w * t[0] * t[0];
    q->a[1] -= w * t[0] * t[1];
    q->a[2] -= w * t[0] * t[2];
    q->a[3] -= w * t[1] * t[1];
    q->a[4] -= w * t[1] * t[2];
    q->a[5] -= w * t[2] * t[2];
}

void enc_pull_point(enc_quadric *q, double weight)
{
    q->a[0] += weight;
    q->a[3] += weight;
    q->a[5] += weight;
    q->weight += weight;
}

void enc_pull_plane(enc_quadric *q, const double n[3], const double through[3],
                    double weight)
{
    enc_quadric plane = { .c = 0 };

    enc_quadric_add_plane(&plane, n, weight);
    enc_quadric_add(q, &plane, through);
}

void enc_pull_fit(const double covariance[6], double n[3])
{
    double spread[3], axis[3][3];

    enc_eigen(covariance, spread, axis);
    memcpy(n, axis[2], sizeof axis[2]);
}

/* Vertices by the number they had before cutting: all at one place. */
typedef struct puller {
    enc_mesh *mesh;
    const uint32_t *number;
    uint32_t numbers;
    uint32_t *head; /* per number: a vertex, or ENC_NONE */
    uint32_t *next; /* per vertex: another of the same number */
    double *area;   /* per vertex: of the faces around */
} puller;

static void measure_areas(puller *p)
{
    const enc_mesh *mesh = p->mesh;

    for (uint32_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *v = &mesh->vertex[3 * f];
        double a[3], b[3];
        for (int k = 0; k < 3; k++) {
            a[k] = mesh->position[v[1]][k] - mesh->position[v[0]][k];
            b[k] = mesh->position[v[2]][k] - mesh->position[v[0]][k];
        }
        const double n[3] = { a[1] * b[2] - a[2] * b[1],
                              a[2] * b[0] - a[0] * b[2],
                              a[0] * b[1] - a[1] * b[0] };
        for (int k = 0; k < 3; k++)
            p->area[v[k]] += 0.5 * sqrt(dot(n, n));
    }
}

/* No more than where the determinant of a quadric is finite. */
static double strength(double importance)
{
    const double most = 1e60;
    return ENC_PULL * (importance > most ? most
                       : importance > 0  ? importance
                                         : 1);
}

static void vector(const enc_mesh *mesh, uint32_t from, uint32_t to,
                   double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = mesh->position[to][k] - mesh->position[from][k];
}

/* ---- the constraints of the guide ---------------------------------------- */

/* A vertex for an input vertex, ENC_NONE if no face uses it. */
static uint32_t vertex_of(const puller *p, uint32_t input)
{
    const uint32_t number = p->number[input];
    return number < p->numbers ? p->head[number] : ENC_NONE;
}

static void pull_contour(const puller *p, const pmesh_constraint *c)
{
    for (size_t i = 1; i < c->vertex_count; i++) {
        const uint32_t u = vertex_of(p, c->vertices[i - 1]);
        const uint32_t v = vertex_of(p, c->vertices[i]);
        double along[3];
        if (u == ENC_NONE || v == ENC_NONE)
            continue;
        vector(p->mesh, u, v, along);
        for (int end = 0; end < 2; end++)
            for (uint32_t w = end ? v : u; w != ENC_NONE; w = p->next[w])
                enc_pull_line(&p->mesh->guide->pull[w], along,
                              strength(c->importance) * p->area[w]);
    }
}

static void pull_points(const puller *p, const pmesh_constraint *c)
{
    for (size_t i = 0; i < c->vertex_count; i++)
        for (uint32_t v = vertex_of(p, c->vertices[i]); v != ENC_NONE;
             v = p->next[v])
            enc_pull_point(&p->mesh->guide->pull[v],
                           strength(c->importance) * p->area[v]);
}

/* False if no vertex is in use. */
static bool fit_plane(const puller *p, const pmesh_constraint *c,
                      double mean[3], double n[3])
{
    double sum[6] = { 0 }, count = 0;

    mean[0] = mean[1] = mean[2] = 0;
    for (size_t i = 0; i < c->vertex_count; i++) {
        const uint32_t v = vertex_of(p, c->vertices[i]);
        for (int k = 0; v != ENC_NONE && k < 3; k++)
            mean[k] += p->mesh->position[v][k];
        count += v != ENC_NONE;
    }
    for (int k = 0; k < 3 && count > 0; k++)
        mean[k] /= count;
    for (size_t i = 0; i < c->vertex_count; i++) {
        const uint32_t v = vertex_of(p, c->vertices[i]);
        double d[3];
        if (v == ENC_NONE)
            continue;
        for (int k = 0; k < 3; k++)
            d[k] = p->mesh->position[v][k] - mean[k];
        const double product[6] = { d[0] * d[0], d[0] * d[1], d[0] * d[2],
                                    d[1] * d[1], d[1] * d[2], d[2] * d[2] };
        for (int k = 0; k < 6; k++)
            sum[k] += product[k];
    }
    enc_pull_fit(sum, n);
    return count > 0;
}

static void pull_plane(const puller *p, const pmesh_constraint *c)
{
    double mean[3], n[3];

    if (!fit_plane(p, c, mean, n))
        return;
    for (size_t i = 0; i < c->vertex_count; i++)
        for (uint32_t v = vertex_of(p, c->vertices[i]); v != ENC_NONE;
             v = p->next[v]) {
            const int32_t *at = p->mesh->position[v];
            const double through[3] = { mean[0] - at[0], mean[1] - at[1],
                                        mean[2] - at[2] };
            enc_pull_plane(&p->mesh->guide->pull[v], n, through,
                           strength(c->importance) * p->area[v]);
        }
}

/* ---- contours that the mesh has by itself -------------------------------- */

static void normal_of(const enc_mesh *mesh, uint32_t face, double n[3])
{
    const uint32_t *v = &mesh->vertex[3 * face];
    double a[3], b[3];

    vector(mesh, v[0], v[1], a);
    vector(mesh, v[0], v[2], b);
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = a[i] * b[j] - a[j] * b[i];
    }
}

static bool bends(const enc_mesh *mesh, uint32_t h, double cosine)
{
    double m[3], n[3];

    normal_of(mesh, h / 3, m);
    normal_of(mesh, mesh->twin[h] / 3, n);
    return dot(m, n) < cosine * sqrt(dot(m, m) * dot(n, n));
}

static bool is_seam(const enc_mesh *mesh, uint32_t h)
{
    const uint32_t t = mesh->twin[h];
    return mesh->wedge &&
           (mesh->wedge[h] != mesh->wedge[enc_next_corner(t)] ||
            mesh->wedge[enc_next_corner(h)] != mesh->wedge[t]);
}

static bool is_border(const enc_mesh *mesh, uint32_t h)
{
    return mesh->material &&
           mesh->material[h / 3] != mesh->material[mesh->twin[h] / 3];
}

/* Of an angle in degrees, 0 .. 180, by its series: the same on every machine,
 * which cos() is not. */
static double cosine_of(double degrees)
{
    const double x = 0.017453292519943295 * (degrees < 180 ? degrees : 180);
    double term = 1, sum = 1;

    for (int i = 1; i < 30; i += 2) {
        term *= -x * x / (i * (i + 1));
        sum += term;
    }
    return sum;
}

static void pull_edges(const puller *p, const pmesh_guide *guide)
{
    const enc_mesh *mesh = p->mesh;
    const double cosine = cosine_of(guide->crease);

    for (uint32_t h = 0; h < 3 * mesh->face_count; h++) {
        if (mesh->twin[h] == ENC_NONE || mesh->twin[h] < h)
            continue;
        if (!(guide->crease > 0 && bends(mesh, h, cosine)) &&
            !(guide->seams && is_seam(mesh, h)) &&
            !(guide->borders && is_border(mesh, h)))
            continue;
        const uint32_t end[2] = { mesh->vertex[h],
                                  mesh->vertex[enc_next_corner(h)] };
        double along[3];
        vector(mesh, end[0], end[1], along);
        for (int k = 0; k < 2; k++)
            enc_pull_line(&mesh->guide->pull[end[k]], along,
                          strength(guide->importance) * p->area[end[k]]);
    }
}

static void run(puller *p, const pmesh_guide *guide, const uint32_t *first)
{
    memset(p->head, 0xff, p->numbers * sizeof *p->head);
    for (uint32_t v = 0; v < p->mesh->vertex_count; v++) {
        p->next[v] = p->head[first[v]];
        p->head[first[v]] = v;
    }
    measure_areas(p);
    for (size_t i = 0; i < guide->constraint_count; i++) {
        const pmesh_constraint *c = &guide->constraints[i];
        if (c->kind == PMESH_CONTOUR)
            pull_contour(p, c);
        else if (c->kind == PMESH_PLANE)
            pull_plane(p, c);
        else
            pull_points(p, c);
    }
    if (guide->crease > 0 || guide->seams || guide->borders)
        pull_edges(p, guide);
}

pmesh_status enc_pull_all(enc_mesh *mesh, const pmesh_guide *guide,
                          const uint32_t *number, const uint32_t *first)
{
    const pmesh_allocator *a = &mesh->allocator;
    const size_t n = mesh->vertex_count; /* not below the numbers before */
    puller p = { .mesh = mesh, .number = number, .numbers = (uint32_t)n,
                 .head = pmesh_alloc(a, n, sizeof *p.head),
                 .next = pmesh_alloc(a, n, sizeof *p.next),
                 .area = pmesh_alloc_zero(a, n, sizeof *p.area) };
    const bool ready = p.head && p.next && p.area;

    if (ready)
        run(&p, guide, first);
    pmesh_release(a, p.area, n, sizeof *p.area);
    pmesh_release(a, p.next, n, sizeof *p.next);
    pmesh_release(a, p.head, n, sizeof *p.head);
    return ready ? PMESH_OK : PMESH_E_MEMORY;
}
