/* SPDX-License-Identifier: MIT */
#include "encoder/enc_nearest.h"

#include <math.h>
#include <stdbool.h>

#include "encoder/enc_distance.h"
#include "format/alloc.h"

/* A range of so many faces is not halved: there are fewer nodes than faces. */
enum { LEAF = 4 };

static uint32_t node_room(const enc_nearest *n)
{
    return n->mesh.face_count + 1;
}

/* Twice the middle of a face's box. */
static int64_t middle(const enc_triangles *m, uint32_t face, int axis)
{
    int64_t low = INT32_MAX, high = INT32_MIN;

    for (uint32_t k = 0; k < 3; k++) {
        const int32_t x = m->position[m->corner[3 * face + k]][axis];
        low = x < low ? x : low;
        high = x > high ? x : high;
    }
    return low + high;
}

static bool before(const enc_triangles *m, uint32_t a, uint32_t b, int axis)
{
    const int64_t x = middle(m, a, axis), y = middle(m, b, axis);
    return x != y ? x < y : a < b;
}

/* Puts into place `half` what would be there if the range were sorted, and
 * what comes before it in front. */
static void select_half(const enc_triangles *m, uint32_t *order, uint32_t low,
                        uint32_t high, uint32_t half, int axis)
{
    while (high - low > 1) {
        const uint32_t pivot = order[low + (high - low - 1) / 2];
        uint32_t i = low, j = high - 1;
        for (;;) {
            while (before(m, order[i], pivot, axis))
                i++;
            while (before(m, pivot, order[j], axis))
                j--;
            if (i >= j)
                break;
            const uint32_t kept = order[i];
            order[i++] = order[j];
            order[j--] = kept;
        }
        /* No range is empty: a pivot that is the last one has moved j. */
        const uint32_t cut = j + 1;
        if (half < cut)
            high = cut;
        else
            low = cut;
    }
}

static int longest_axis(const int32_t box[6])
{
    int axis = 0;

    for (int k = 1; k < 3; k++)
        if (box[3 + k] - box[k] > box[3 + axis] - box[axis])
            axis = k;
    return axis;
}

static void build(enc_nearest *n, uint32_t node, uint32_t low, uint32_t high)
{
    int32_t *box = n->box[node];

    for (int k = 0; k < 3; k++) {
        box[k] = INT32_MAX;
        box[3 + k] = INT32_MIN;
    }
    for (uint32_t c = 3 * low; c < 3 * high; c++) {
        const int32_t *p =
            n->mesh.position[n->mesh.corner[3 * n->order[c / 3] + c % 3]];
        for (int k = 0; k < 3; k++) {
            box[k] = p[k] < box[k] ? p[k] : box[k];
            box[3 + k] = p[k] > box[3 + k] ? p[k] : box[3 + k];
        }
    }
    if (high - low <= LEAF)
        return;
    const uint32_t half = low + (high - low) / 2;
    select_half(&n->mesh, n->order, low, high, half, longest_axis(box));
    build(n, 2 * node + 1, low, half);
    build(n, 2 * node + 2, half, high);
}

pmesh_status enc_nearest_create(const pmesh_allocator *allocator,
                                const enc_triangles *mesh, enc_nearest *out)
{
    *out = (enc_nearest){ .allocator = *allocator, .mesh = *mesh };
    out->order = pmesh_alloc(allocator, mesh->face_count, sizeof *out->order);
    out->box = pmesh_alloc(allocator, node_room(out), sizeof *out->box);
    if (!out->order || !out->box) {
        enc_nearest_destroy(out);
        return PMESH_E_MEMORY;
    }
    for (uint32_t f = 0; f < mesh->face_count; f++)
        out->order[f] = f;
    build(out, 0, 0, mesh->face_count);
    return PMESH_OK;
}

void enc_nearest_destroy(enc_nearest *n)
{
    if (!n->allocator.release)
        return;
    pmesh_release(&n->allocator, n->order, n->mesh.face_count,
                  sizeof *n->order);
    pmesh_release(&n->allocator, n->box, node_room(n), sizeof *n->box);
    *n = (enc_nearest){ 0 };
}

static double box_square(const int32_t box[6], const double x[3])
{
    double sum = 0;

    for (int k = 0; k < 3; k++) {
        const double off = x[k] < box[k]       ? box[k] - x[k]
                           : x[k] > box[3 + k] ? x[k] - box[3 + k]
                                               : 0;
        sum += off * off;
    }
    return sum;
}

static double face_square(const enc_triangles *m, uint32_t face,
                          const double x[3])
{
    double corner[3][3];

    for (uint32_t k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            corner[k][i] = m->position[m->corner[3 * face + k]][i];
    return enc_distance_square(x, corner[0], corner[1], corner[2]);
}

static void look(const enc_nearest *n, uint32_t node, uint32_t low,
                 uint32_t high, const double x[3], double *least)
{
    if (high - low <= LEAF) {
        for (; low < high; low++) {
            const double square = face_square(&n->mesh, n->order[low], x);
            *least = square < *least ? square : *least;
        }
        return;
    }
    const uint32_t half = low + (high - low) / 2, child = 2 * node + 1;
    const double left = box_square(n->box[child], x);
    const double right = box_square(n->box[child + 1], x);
    if (left <= right && left < *least)
        look(n, child, low, half, x, least);
    if (right < *least)
        look(n, child + 1, half, high, x, least);
    if (left > right && left < *least)
        look(n, child, low, half, x, least);
}

double enc_nearest_square(const enc_nearest *n, const double x[3])
{
    double least = INFINITY;

    look(n, 0, 0, n->mesh.face_count, x, &least);
    return least;
}
