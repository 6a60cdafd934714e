/* SPDX-License-Identifier: MIT */
#include "tools/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEAF_FACES 4u
#define MAX_DEPTH 32u
#define MAX_TIES 256u /* of a mesh that is a speck from afar all faces tie */

/* ---- frame ------------------------------------------------------------- */

static bool face_is_finite(const asset *mesh, size_t face)
{
    for (size_t k = 0; k < 3; k++) {
        const double *p = mesh->positions + 3 * (size_t)
                          mesh->indices[3 * face + k];
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
            return false;
    }
    return true;
}

bool surface_frame_of(const asset *const *meshes, size_t count,
                      surface_frame *out)
{
    double low[3] = { HUGE_VAL, HUGE_VAL, HUGE_VAL };
    double high[3] = { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL };

    for (size_t m = 0; m < count; m++) {
        for (size_t f = 0; f < meshes[m]->face_count; f++) {
            if (!face_is_finite(meshes[m], f))
                continue;
            for (size_t c = 0; c < 9; c++) {
                const size_t corner = 3 * f + c / 3;
                const size_t axis = c % 3;
                const double x = meshes[m]->positions[
                    3 * (size_t)meshes[m]->indices[corner] + axis];
                low[axis] = fmin(low[axis], x);
                high[axis] = fmax(high[axis], x);
            }
        }
    }
    if (low[0] > high[0])
        return false;

    double half = 0;
    for (size_t k = 0; k < 3; k++) {
        /* Halves first: the extent of huge coordinates may overflow. */
        out->center[k] = low[k] * 0.5 + high[k] * 0.5;
        half = fmax(half, high[k] * 0.5 - low[k] * 0.5);
    }
    out->exponent = 0;
    if (half > 0)
        frexp(half, &out->exponent);
    return true;
}

/* ---- tree -------------------------------------------------------------- */

/* A face on its way into the tree: twice its box's centre, roughly. */
typedef struct item {
    float center[3];
    uint32_t face;
} item;

/* First face of the i-th node of a row: halves meet at every depth because
 * floor(n * 2i / 2^(d+1)) = floor(n * i / 2^d). */
static size_t row_first(size_t faces, size_t i, unsigned depth)
{
    return (size_t)(((uint64_t)faces * i) >> depth);
}

static float axis_extent(const item *items, size_t count, unsigned axis)
{
    float low = items[0].center[axis];
    float high = low;
    for (size_t i = 1; i < count; i++) {
        const float c = items[i].center[axis];
        if (c < low)
            low = c;
        if (c > high)
            high = c;
    }
    return high - low;
}

static void swap_items(item *a, item *b)
{
    const item t = *a;
    *a = *b;
    *b = t;
}

/*
 * Reorders so that no item before `middle` is behind one after it, on an axis.
 * Pivots are drawn by a generator and equal keys end in a part of their own:
 * no input makes this quadratic.
 */
static void select_middle(item *items, size_t count, size_t middle,
                          unsigned axis, uint32_t *random)
{
    while (count > 1) {
        *random = *random * 1664525u + 1013904223u;
        const float pivot =
            items[((uint64_t)*random * count) >> 32].center[axis];
        size_t below = 0; /* [0, below) < pivot, [below, i) = pivot */
        size_t above = count; /* [above, count) > pivot */
        for (size_t i = 0; i < above;) {
            if (items[i].center[axis] < pivot)
                swap_items(&items[i++], &items[below++]);
            else if (items[i].center[axis] > pivot)
                swap_items(&items[i], &items[--above]);
            else
                i++;
        }
        if (middle < below) {
            count = below;
        } else if (middle >= above) {
            items += above;
            count -= above;
            middle -= above;
        } else {
            return;
        }
    }
}

static void split_rows(item *items, size_t faces, unsigned depth)
{
    uint32_t random = 1;
    for (unsigned d = 0; d < depth; d++) {
        for (size_t i = 0; i < (size_t)1 << d; i++) {
            const size_t first = row_first(faces, i, d);
            const size_t end = row_first(faces, i + 1, d);
            const size_t middle = row_first(faces, 2 * i + 1, d + 1);
            unsigned widest = 0;
            float extent = -1;
            for (unsigned axis = 0; axis < 3; axis++) {
                const float e = axis_extent(items + first, end - first, axis);
                if (e > extent) {
                    extent = e;
                    widest = axis;
                }
            }
            select_middle(items + first, end - first, middle - first, widest,
                          &random);
        }
    }
}

static void node_add_point(surface_node *node, const double *p)
{
    for (size_t k = 0; k < 3; k++) {
        const float f = (float)p[k];
        /* Outwards, so that the box holds the point before rounding too. */
        node->low[k] = fminf(node->low[k], nextafterf(f, -2.0f));
        node->high[k] = fmaxf(node->high[k], nextafterf(f, 2.0f));
    }
}

static void build_boxes(surface *s)
{
    const size_t leaves = (size_t)1 << s->depth;
    for (size_t i = 0; i < leaves; i++) {
        surface_node *node = &s->nodes[leaves + i];
        *node = (surface_node){ { 2, 2, 2 }, { -2, -2, -2 } };
        const size_t end = 3 * row_first(s->face_count, i + 1, s->depth);
        for (size_t c = 3 * row_first(s->face_count, i, s->depth); c < end; c++)
            node_add_point(node, s->points + 3 * (size_t)s->corners[c]);
    }
    for (size_t i = leaves - 1; i > 0; i--) {
        const surface_node *left = &s->nodes[2 * i];
        const surface_node *right = &s->nodes[2 * i + 1];
        for (size_t k = 0; k < 3; k++) {
            s->nodes[i].low[k] = fminf(left->low[k], right->low[k]);
            s->nodes[i].high[k] = fmaxf(left->high[k], right->high[k]);
        }
    }
}

static size_t collect_faces(const surface *s, const asset *mesh, item *items,
                            double *diagonal)
{
    double low[3] = { 2, 2, 2 };
    double high[3] = { -2, -2, -2 };
    size_t count = 0;

    for (size_t f = 0; f < mesh->face_count; f++) {
        if (!face_is_finite(mesh, f))
            continue;
        item *it = &items[count++];
        it->face = (uint32_t)f;
        for (size_t axis = 0; axis < 3; axis++) {
            double a = 2;
            double b = -2;
            for (size_t k = 0; k < 3; k++) {
                const size_t v = mesh->indices[3 * f + k];
                a = fmin(a, s->points[3 * v + axis]);
                b = fmax(b, s->points[3 * v + axis]);
            }
            low[axis] = fmin(low[axis], a);
            high[axis] = fmax(high[axis], b);
            it->center[axis] = (float)(a + b);
        }
    }
    double sum = 0;
    for (size_t k = 0; k < 3 && count > 0; k++)
        sum += (high[k] - low[k]) * (high[k] - low[k]);
    *diagonal = sqrt(sum);
    return count;
}

static bool build_tree(surface *s, const asset *mesh, item *items)
{
    s->face_count = collect_faces(s, mesh, items, &s->diagonal);
    s->depth = 0;
    while (s->depth < MAX_DEPTH - 1 &&
           ((s->face_count - 1) >> s->depth) >= LEAF_FACES)
        s->depth++;
    const size_t node_count = (size_t)2 << s->depth;
    s->corners = malloc((3 * s->face_count + 1) * sizeof *s->corners);
    s->nodes = malloc(node_count * sizeof *s->nodes);
    if (!s->corners || !s->nodes)
        return false;
    split_rows(items, s->face_count, s->depth);
    for (size_t i = 0; i < s->face_count; i++)
        memcpy(s->corners + 3 * i, mesh->indices + 3 * (size_t)items[i].face,
               3 * sizeof *s->corners);
    build_boxes(s);
    return true;
}

bool surface_build(surface *out, const asset *mesh, const surface_frame *frame)
{
    const double scale = ldexp(1.0, -frame->exponent);
    /* 2^-exponent itself overflows for tiny models: two steps then. */
    const double step = isfinite(scale) ? 1.0 : ldexp(1.0, 512);
    const double rest = isfinite(scale)
                            ? scale
                            : ldexp(1.0, -frame->exponent - 512);

    *out = (surface){ .point_count = mesh->vertex_count };
    item *items = malloc((mesh->face_count + 1) * sizeof *items);
    out->points = malloc((3 * mesh->vertex_count + 1) * sizeof *out->points);
    bool ok = items && out->points;
    if (ok) {
        for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
            out->points[i] =
                (mesh->positions[i] - frame->center[i % 3]) * step * rest;
        ok = build_tree(out, mesh, items);
    }
    free(items);
    if (!ok)
        surface_free(out);
    return ok;
}

void surface_free(surface *s)
{
    free(s->points);
    free(s->corners);
    free(s->nodes);
    *s = (surface){ 0 };
}

/* ---- closest point ----------------------------------------------------- */

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double *a, const double *b, double *out)
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void subtract(const double *a, const double *b, double *out)
{
    for (size_t k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

/* Squared length of v - t * side for the best t in 0 .. 1. */
static double side_distance2(const double *v, const double *side)
{
    const double length2 = dot(side, side);
    const double along = dot(v, side);
    double t = 0;
    if (along > 0 && length2 > 0)
        t = along < length2 ? along / length2 : 1;
    double d[3];
    for (size_t k = 0; k < 3; k++)
        d[k] = v[k] - t * side[k];
    return dot(d, d);
}

/*
 * Either the foot of the perpendicular lies inside: then the distance is that
 * to the plane. Or the closest point lies on a side.
 */
double surface_face_distance2(const surface *s, size_t face, const double p[3])
{
    const uint32_t *corner = s->corners + 3 * face;
    const double *a = s->points + 3 * (size_t)corner[0];
    const double *b = s->points + 3 * (size_t)corner[1];
    const double *c = s->points + 3 * (size_t)corner[2];
    double ab[3], ac[3], ap[3], n[3], across[3];

    subtract(b, a, ab);
    subtract(c, a, ac);
    subtract(p, a, ap);
    cross(ab, ac, n);
    const double nn = dot(n, n);
    if (nn > 0) {
        cross(ap, ac, across);
        const double v = dot(across, n);
        cross(ab, ap, across);
        const double w = dot(across, n);
        if (v >= 0 && w >= 0 && v + w <= nn) {
            const double height = dot(ap, n);
            return height * height / nn;
        }
    }
    double bc[3], bp[3];
    subtract(c, b, bc);
    subtract(p, b, bp);
    const double d = fmin(side_distance2(ap, ab), side_distance2(ap, ac));
    return fmin(d, side_distance2(bp, bc));
}

static double box_distance2(const surface_node *node, const double *p)
{
    double sum = 0;
    for (size_t k = 0; k < 3; k++) {
        double d = 0;
        if (p[k] < (double)node->low[k])
            d = (double)node->low[k] - p[k];
        else if (p[k] > (double)node->high[k])
            d = p[k] - (double)node->high[k];
        sum += d * d;
    }
    return sum;
}

/* Nodes still to visit; one per depth and the current pair. */
typedef struct visit {
    size_t node;
    double distance2;
} visit;

/* Pushes the children within `limit` so that the nearer one comes first. */
static size_t push_children(const surface *s, size_t node, const double *p,
                            double limit, visit *stack, size_t count)
{
    visit near = { 2 * node, box_distance2(&s->nodes[2 * node], p) };
    visit far = { 2 * node + 1, box_distance2(&s->nodes[2 * node + 1], p) };
    if (far.distance2 < near.distance2) {
        const visit t = near;
        near = far;
        far = t;
    }
    if (far.distance2 <= limit)
        stack[count++] = far;
    if (near.distance2 <= limit)
        stack[count++] = near;
    return count;
}

double surface_closest(const surface *s, const double p[3], uint32_t *hint)
{
    const size_t leaves = (size_t)1 << s->depth;
    visit stack[MAX_DEPTH + 2];
    size_t count = 0;
    double best = surface_face_distance2(s, *hint, p);

    stack[count++] = (visit){ 1, 0 };
    while (count > 0) {
        const visit at = stack[--count];
        if (at.distance2 >= best)
            continue;
        if (at.node < leaves) {
            count = push_children(s, at.node, p, best, stack, count);
            continue;
        }
        const size_t i = at.node - leaves;
        const size_t end = row_first(s->face_count, i + 1, s->depth);
        for (size_t f = row_first(s->face_count, i, s->depth); f < end; f++) {
            const double d = surface_face_distance2(s, f, p);
            if (d < best) {
                best = d;
                *hint = (uint32_t)f;
            }
        }
    }
    return best;
}

static double face_cosine(const surface *s, size_t face, const double *n)
{
    const uint32_t *corner = s->corners + 3 * face;
    const double *a = s->points + 3 * (size_t)corner[0];
    double ab[3], ac[3], normal[3];

    subtract(s->points + 3 * (size_t)corner[1], a, ab);
    subtract(s->points + 3 * (size_t)corner[2], a, ac);
    cross(ab, ac, normal);
    const double length = sqrt(dot(normal, normal));
    return length > 0 ? dot(normal, n) / length : -1;
}

double surface_alignment(const surface *s, const double p[3],
                         const double n[3], double distance2)
{
    /* A tie: within 1e-7 of the extent, or a part in 2 million. */
    const double limit =
        distance2 * (1 + 1e-6) + 1e-14 * s->diagonal * s->diagonal;
    const size_t leaves = (size_t)1 << s->depth;
    visit stack[MAX_DEPTH + 2];
    size_t count = 0;
    double best = -1;
    unsigned ties = 0;

    stack[count++] = (visit){ 1, 0 };
    while (count > 0 && ties < MAX_TIES) {
        const visit at = stack[--count];
        if (at.node < leaves) {
            count = push_children(s, at.node, p, limit, stack, count);
            continue;
        }
        const size_t i = at.node - leaves;
        const size_t end = row_first(s->face_count, i + 1, s->depth);
        for (size_t f = row_first(s->face_count, i, s->depth); f < end; f++) {
            if (surface_face_distance2(s, f, p) > limit)
                continue;
            best = fmax(best, face_cosine(s, f, n));
            ties++;
        }
    }
    return best;
}
