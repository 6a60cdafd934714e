/* SPDX-License-Identifier: MIT */
#include "tests/unit/float_faces.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { CORNER = 3 * sizeof(uint32_t) };

static int compare(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(float_face));
}

/* False if two corners are at one place. */
static bool make_face(const float *xyz, const uint32_t *v, float_face *out)
{
    const float *c[3] = { xyz + 3 * (size_t)v[0], xyz + 3 * (size_t)v[1],
                          xyz + 3 * (size_t)v[2] };
    for (int turn = 0; turn < 3; turn++) {
        float_face f;
        if (memcmp(c[turn], c[(turn + 1) % 3], CORNER) == 0)
            return false;
        for (int k = 0; k < 3; k++)
            memcpy(f.x + 3 * k, c[(turn + k) % 3], CORNER);
        if (turn == 0 || compare(&f, out) < 0)
            *out = f;
    }
    return true;
}

size_t float_faces(const float *xyz, const uint32_t *indices, size_t count,
                   float_face *out)
{
    size_t made = 0, kept = 0;
    for (size_t f = 0; f < count; f++)
        made += make_face(xyz, indices + 3 * f, &out[made]);
    qsort(out, made, sizeof *out, compare);
    for (size_t i = 0; i < made; i++)
        if (i == 0 || compare(&out[i], &out[i - 1]) != 0)
            out[kept++] = out[i];
    return kept;
}

size_t float_faces_of(const double *xyz, size_t vertices,
                      const uint32_t *indices, size_t count, float_face *out)
{
    float *floats = malloc(3 * vertices * sizeof *floats);
    for (size_t i = 0; i < 3 * vertices; i++)
        floats[i] = (float)xyz[i];
    const size_t kept = float_faces(floats, indices, count, out);
    free(floats);
    return kept;
}
