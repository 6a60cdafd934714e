/* SPDX-License-Identifier: MIT */
#include "format/octant.h"

#include "format/star.h"

enum { FOLD_BITS = 30 };

static int32_t size_of(int32_t x)
{
    return x < 0 ? -x : x;
}

void pmesh_octant_mirror(int32_t centre, int32_t code[2])
{
    const int32_t a = code[0] - centre, b = code[1] - centre;
    const int32_t x = centre - size_of(b), y = centre - size_of(a);
    code[0] = centre + (a < 0 ? -x : x);
    code[1] = centre + (b < 0 ? -y : y);
}

int32_t pmesh_octant_below(int32_t centre, const uint16_t code[2])
{
    return size_of(code[0] - centre) + size_of(code[1] - centre) - centre;
}

void pmesh_octant_fold(const int64_t v[3], int32_t centre, int32_t fraction,
                       bool mirrored, int64_t code[2])
{
    const int64_t one = (int64_t)centre * fraction;
    uint64_t size[3], all = 0, sum = 0;
    for (int k = 0; k < 3; k++) {
        size[k] = (uint64_t)(v[k] < 0 ? -v[k] : v[k]);
        all |= size[k];
    }
    const unsigned bits = pmesh_bit_length(all);
    const unsigned drop = bits > FOLD_BITS ? bits - FOLD_BITS : 0;
    for (int k = 0; k < 3; k++)
        sum += size[k] >> drop;
    if (sum == 0) {
        code[0] = code[1] = one;
        return;
    }
    int64_t a = (int64_t)((size[0] >> drop) * (uint64_t)one / sum);
    int64_t b = (int64_t)((size[1] >> drop) * (uint64_t)one / sum);
    if (v[2] != 0 && (v[2] < 0) != mirrored) {
        const int64_t x = one - b;
        b = one - a;
        a = x;
    }
    code[0] = v[0] < 0 ? one - a : one + a;
    code[1] = v[1] < 0 ? one - b : one + b;
}

void pmesh_octant_unfold(const uint16_t code[2], int32_t centre, int32_t v[3])
{
    const int32_t a = code[0] - centre, b = code[1] - centre;
    v[0] = a;
    v[1] = b;
    v[2] = centre - size_of(a) - size_of(b);
    if (v[2] >= 0)
        return;
    v[0] = a < 0 ? size_of(b) - centre : centre - size_of(b);
    v[1] = b < 0 ? size_of(a) - centre : centre - size_of(a);
}
