/* SPDX-License-Identifier: MIT */
/*
 * triangulate.c - polygons of any shape into triangles, by ear clipping.
 *
 * The polygon is projected along the axis its normal is closest to. Corners
 * that may lie in an ear (the ones that are not convex) are kept in a grid, so
 * that an ear looks at its surroundings only. Work is bounded, at
 * WORK_PER_CORNER looks a corner: what is left of a polygon then ends as a fan.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/asset.h"

#define WORK_PER_CORNER 1024
#define NONE UINT32_MAX
#define MAX_GRID 512 /* cells a side */

typedef struct point {
    double x, y;
} point;

typedef struct corner {
    point at;               /* counter-clockwise, within 0 .. 1 */
    uint32_t before, after; /* the ring of corners that are left */
    uint32_t next;          /* the cell's list */
    bool blunt;             /* not convex: may lie in an ear */
    bool queued, gone;
} corner;

typedef struct ears {
    corner *corners;
    uint32_t *cells; /* grid * grid lists of blunt corners */
    uint32_t grid;
    uint32_t *queue; /* a ring buffer of `size` corners to look at */
    size_t size, head, queued;
    uint32_t cursor; /* some corner that is left */
    size_t left;     /* so many are */
    size_t work;
    uint32_t *out;
} ears;

typedef double vector[3];

static void subtract(const double *a, const double *b, vector out)
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static void add_cross(const vector a, const vector b, vector sum)
{
    sum[0] += a[1] * b[2] - a[2] * b[1];
    sum[1] += a[2] * b[0] - a[0] * b[2];
    sum[2] += a[0] * b[1] - a[1] * b[0];
}

static void put(uint32_t **out, uint32_t a, uint32_t b, uint32_t c)
{
    (*out)[0] = a;
    (*out)[1] = b;
    (*out)[2] = c;
    *out += 3;
}

static void put_fan(uint32_t **out, size_t n)
{
    for (uint32_t i = 2; i < n; i++)
        put(out, 0, i - 1, i);
}

/* ---- quads --------------------------------------------------------------- */

/* How far the two triangles beside the diagonal from corner `a` agree. */
static double diagonal_agreement(const double (*p)[3], int a)
{
    vector e[3], n[2] = { { 0 }, { 0 } };
    for (int k = 0; k < 3; k++)
        subtract(p[(a + k + 1) % 4], p[a], e[k]);
    add_cross(e[0], e[1], n[0]);
    add_cross(e[1], e[2], n[1]);
    return n[0][0] * n[1][0] + n[0][1] * n[1][1] + n[0][2] * n[1][2];
}

static void put_quad(const double (*p)[3], uint32_t *out)
{
    if (!(diagonal_agreement(p, 0) > 0) && diagonal_agreement(p, 1) > 0) {
        put(&out, 0, 1, 3);
        put(&out, 1, 2, 3);
    } else {
        put_fan(&out, 4);
    }
}

/* ---- projection ---------------------------------------------------------- */

/* Fills in corners[].at; false if the polygon has no plane (not finite, all
 * on a line, or its parts cancel out). */
static bool project(const double (*p)[3], size_t n, corner *corners)
{
    vector normal = { 0 }, low, high;
    memcpy(low, p[0], sizeof low);
    memcpy(high, p[0], sizeof high);
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) {
            if (!isfinite(p[i][k]))
                return false;
            low[k] = fmin(low[k], p[i][k]);
            high[k] = fmax(high[k], p[i][k]);
        }
    }
    double size = 0;
    for (int k = 0; k < 3; k++)
        size = fmax(size, high[k] - low[k]);
    if (!(size > 0) || !isfinite(size))
        return false;

    /* Newell's sum, about corner 0, in a box of size 1. */
    vector a = { 0 };
    for (size_t i = 1; i < n; i++) {
        vector b;
        subtract(p[i], p[0], b);
        for (int k = 0; k < 3; k++)
            b[k] /= size;
        add_cross(a, b, normal);
        memcpy(a, b, sizeof a);
    }
    int drop = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[drop]))
            drop = k;
    if (!(fabs(normal[drop]) > 1e-12))
        return false;
    int u = (drop + 1) % 3, v = (drop + 2) % 3;
    if (normal[drop] < 0) {
        const int t = u;
        u = v;
        v = t;
    }
    /* Both sides become 1: what is inside stays inside, and the grid fits. */
    const double width = high[u] - low[u], height = high[v] - low[v];
    for (size_t i = 0; i < n; i++)
        corners[i].at = (point){ (p[i][u] - low[u]) / width,
                                 (p[i][v] - low[v]) / height };
    return true;
}

/* ---- ears ---------------------------------------------------------------- */

/* Twice the area: > 0 if a, b, c turn left. */
static double turn(point a, point b, point c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static bool same_point(point a, point b)
{
    return a.x == b.x && a.y == b.y;
}

static double turn_at(const ears *e, uint32_t i)
{
    const corner *c = &e->corners[i];
    return turn(e->corners[c->before].at, c->at, e->corners[c->after].at);
}

static uint32_t cell_of(const ears *e, double x)
{
    const double cell = x * e->grid;
    if (!(cell > 0))
        return 0;
    return cell < e->grid ? (uint32_t)cell : e->grid - 1;
}

static uint32_t *cell_at(const ears *e, uint32_t row, double x)
{
    return &e->cells[(size_t)row * e->grid + cell_of(e, x)];
}

typedef struct range {
    double low, high;
} range;

/* Widens `x` to what the edge covers of a row of cells. */
static void cover_edge(point a, point b, range row, range *x)
{
    if (a.y > b.y) {
        const point t = a;
        a = b;
        b = t;
    }
    if (b.y < row.low || a.y > row.high)
        return;
    const double slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0;
    const double from = a.y < row.low ? a.x + slope * (row.low - a.y) : a.x;
    const double to = b.y > row.high ? a.x + slope * (row.high - a.y) : b.x;
    x->low = fmin(x->low, fmin(from, to));
    x->high = fmax(x->high, fmax(from, to));
}

/* Whether a blunt corner of a cell, other than a, b, c (by place), lies in the
 * triangle or on its border; with `strict` the border does not count. */
static bool is_cell_in_way(ears *e, uint32_t *link, const point t[3],
                           bool strict)
{
    for (e->work++; *link != NONE; e->work++) {
        corner *k = &e->corners[*link];
        if (!k->blunt) { /* clipped or convex by now */
            *link = k->next;
            continue;
        }
        link = &k->next;
        const point p = k->at;
        const double u = turn(t[0], t[1], p), v = turn(t[1], t[2], p),
                     w = turn(t[2], t[0], p);
        if (strict ? u > 0 && v > 0 && w > 0
                   : u >= 0 && v >= 0 && w >= 0 && !same_point(p, t[0]) &&
                         !same_point(p, t[1]) && !same_point(p, t[2]))
            return true;
    }
    return false;
}

/* Looks at the cells that the triangle touches, row by row. */
static bool is_occupied(ears *e, const point t[3], bool strict)
{
    const double margin = 1e-9; /* rounding in cover_edge is below this */
    const uint32_t first = cell_of(e, fmin(t[0].y, fmin(t[1].y, t[2].y)));
    const uint32_t last = cell_of(e, fmax(t[0].y, fmax(t[1].y, t[2].y)));
    for (uint32_t row = first; row <= last; row++) {
        const range y = { (double)row / e->grid - margin,
                          (double)(row + 1) / e->grid + margin };
        range x = { 1, 0 };
        e->work += 8; /* about what this costs */
        for (int k = 0; k < 3; k++)
            cover_edge(t[k], t[(k + 1) % 3], y, &x);
        uint32_t *cell = cell_at(e, row, x.low - margin);
        uint32_t *end = cell_at(e, row, x.high + margin);
        for (; cell <= end; cell++)
            if (is_cell_in_way(e, cell, t, strict))
                return true;
    }
    return false;
}

static bool is_ear(ears *e, uint32_t i, bool strict)
{
    const corner *c = &e->corners[i];
    if (c->blunt)
        return false;
    const point triangle[3] = { e->corners[c->before].at, c->at,
                                e->corners[c->after].at };
    return !is_occupied(e, triangle, strict);
}

/* A corner never turns blunt when a neighbour goes, if the polygon is simple;
 * otherwise it may, and is then missed as an obstacle. */
static void update_blunt(ears *e, uint32_t i)
{
    e->corners[i].blunt = e->corners[i].blunt && !(turn_at(e, i) > 0);
}

static void enqueue(ears *e, uint32_t i)
{
    corner *c = &e->corners[i];
    if (c->queued)
        return;
    c->queued = true;
    e->queue[(e->head + e->queued++) % e->size] = i;
}

static uint32_t dequeue(ears *e)
{
    const uint32_t i = e->queue[e->head];
    e->head = (e->head + 1) % e->size;
    e->queued--;
    e->corners[i].queued = false;
    return i;
}

/* Every second corner first: rounder ears. */
static void enqueue_all(ears *e)
{
    for (size_t start = 0; start < 2; start++)
        for (size_t i = start; i < e->size; i += 2)
            if (!e->corners[i].gone)
                enqueue(e, (uint32_t)i);
}

static void clip(ears *e, uint32_t i)
{
    corner *c = &e->corners[i];
    put(&e->out, c->before, i, c->after);
    e->corners[c->before].after = c->after;
    e->corners[c->after].before = c->before;
    c->blunt = false;
    c->gone = true;
    update_blunt(e, c->before);
    update_blunt(e, c->after);
    enqueue(e, c->before);
    enqueue(e, c->after);
    e->cursor = c->after;
    e->left--;
}

/* A convex corner if there is one. */
static uint32_t any_corner(ears *e)
{
    uint32_t i = e->cursor;
    for (size_t k = 0; k < e->left && e->corners[i].blunt; k++, e->work++)
        i = e->corners[i].after;
    return i;
}

/* Whether a corner is an ear depends on its neighbours only (in a simple
 * polygon), so a clipped ear calls for a new look at these two. */
static void clip_all(ears *e)
{
    const size_t budget = e->size * WORK_PER_CORNER;
    bool strict = false;
    enqueue_all(e);
    while (e->left > 3 && e->work < budget) {
        if (e->queued) {
            const uint32_t i = dequeue(e);
            e->work++;
            if (!e->corners[i].gone && is_ear(e, i, strict))
                clip(e, i);
        } else if (!strict) {
            strict = true; /* the polygon touches itself */
            enqueue_all(e);
        } else {
            clip(e, any_corner(e)); /* it crosses itself */
        }
    }
    while (e->left >= 3)
        clip(e, e->cursor);
}

static void build_ring(ears *e)
{
    const size_t n = e->size;
    const size_t cells = (size_t)e->grid * e->grid;
    for (size_t k = 0; k < cells; k++)
        e->cells[k] = NONE;
    for (size_t k = 0; k < n; k++) {
        corner *c = &e->corners[k];
        c->before = (uint32_t)(k ? k - 1 : n - 1);
        c->after = (uint32_t)(k + 1 < n ? k + 1 : 0);
        c->queued = c->gone = false;
    }
    for (uint32_t k = 0; k < n; k++) {
        corner *c = &e->corners[k];
        c->blunt = !(turn_at(e, k) > 0);
        if (!c->blunt)
            continue;
        uint32_t *cell = cell_at(e, cell_of(e, c->at.y), c->at.x);
        c->next = *cell;
        *cell = k;
    }
}

static uint32_t grid_size(size_t n)
{
    uint32_t grid = 1;
    while (grid < MAX_GRID && (size_t)grid * grid < n / 2)
        grid *= 2;
    return grid;
}

void asset_triangulate(const double (*corners)[3], size_t n, uint32_t *out)
{
    if (n == 3) {
        put_fan(&out, n);
        return;
    }
    if (n == 4) {
        put_quad(corners, out);
        return;
    }
    ears e = { .grid = grid_size(n), .size = n, .left = n, .out = out };
    if (n <= SIZE_MAX / sizeof *e.corners) {
        e.corners = malloc(n * sizeof *e.corners);
        e.queue = malloc(n * sizeof *e.queue);
    }
    e.cells = malloc((size_t)e.grid * e.grid * sizeof *e.cells);
    if (e.corners && e.queue && e.cells && project(corners, n, e.corners)) {
        build_ring(&e);
        clip_all(&e);
    } else {
        put_fan(&out, n);
    }
    free(e.corners);
    free(e.queue);
    free(e.cells);
}
