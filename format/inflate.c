/* SPDX-License-Identifier: MIT */
#include "format/inflate.h"

#include <stddef.h>

static void face_normal(const int32_t a[3], const int32_t b[3],
                        const int32_t c[3], double out[3])
{
    double p[3], q[3];
    for (int k = 0; k < 3; k++) {
        p[k] = (double)(b[k] - a[k]);
        q[k] = (double)(c[k] - a[k]);
    }
    out[0] = p[1] * q[2] - p[2] * q[1];
    out[1] = p[2] * q[0] - p[0] * q[2];
    out[2] = p[0] * q[1] - p[1] * q[0];
}

void pmesh_bulge_add(pmesh_bulge *bulge, const uint32_t v[3],
                     const int32_t *positions)
{
    const int32_t *p[3];
    double normal[3];
    for (int i = 0; i < 3; i++)
        p[i] = positions + 3 * (size_t)v[i];
    face_normal(p[0], p[1], p[2], normal);
    for (int i = 0; i < 3; i++) {
        const int next = i == 2 ? 0 : i + 1;
        pmesh_bulge *b = &bulge[v[i]];
        for (int k = 0; k < 3; k++) {
            b->ring[k] += p[next][k];
            b->normal[k] += normal[k];
        }
        b->count++;
        b->open += v[next] - v[i == 0 ? 2 : i - 1];
    }
}

bool pmesh_bulge_height(const pmesh_bulge *b, const int32_t p[3], double out[3])
{
    const double *n = b->normal;
    const double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    double height = 0;
    if (b->open || square == 0)
        return false;
    for (int k = 0; k < 3; k++)
        height += (p[k] - b->ring[k] / b->count) * n[k];
    for (int k = 0; k < 3; k++)
        out[k] = height / square * n[k];
    return true;
}
