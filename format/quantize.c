/* SPDX-License-Identifier: MIT */
#include "format/quantize.h"

#include <assert.h>
#include <float.h>
#include <string.h>

/* 1 (s390x) computes floats as doubles: harmless, we compute in doubles only. */
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD < 0 || FLT_EVAL_METHOD == 2)
#error "excess precision breaks reproducibility: use -msse2 -mfpmath=sse"
#endif

static double finite_or_zero(float value)
{
    return value >= -FLT_MAX && value <= FLT_MAX ? (double)value : 0.0;
}

/* The integer nearest to `t`, halves up, within 0 .. last; NaN gives 0. */
static int32_t round_within(double t, int32_t last)
{
    if (!(t > 0.0))
        return 0;
    return t >= (double)last ? last : (int32_t)(t + 0.5);
}

int32_t pmesh_grid_quantize(const pmesh_grid *grid, int axis, double value)
{
    const double cells = (value - grid->origin[axis]) / grid->step;

    return round_within(cells, ((int32_t)1 << grid->bits) - 1);
}

double pmesh_grid_dequantize(const pmesh_grid *grid, int axis, int32_t q)
{
    return grid->origin[axis] + grid->step * (double)q;
}

float pmesh_narrow(double value)
{
    if (!(value >= -(double)FLT_MAX))
        return -FLT_MAX;
    return value <= (double)FLT_MAX ? (float)value : FLT_MAX;
}

/*
 * Normals: the octahedron |x| + |y| + |z| = c, unfolded to the square of
 * 2c + 1 by 2c + 1 codes, c = 2^(bits - 1) - 1. The odd side puts all six axes
 * on codes (the highest code of `bits` bits stays unused):
 *
 *   -z --- +y --- -z   The inner diamond is the upper half, the four corner
 *    |   /  |  \   |    triangles, folded outwards, are the lower half. Each
 *   -x --- +z --- +x   edge of the square is folded onto itself around its
 *    |   \  |  /   |    middle: (2c, v) and (2c, 2c - v) are one direction.
 *   -z --- -y --- -z   Of two such codes the canonical one is up or right.  */
static int32_t half_side(const pmesh_attribute *attribute)
{
    return ((int32_t)1 << (attribute->bits - 1)) - 1;
}

static int32_t magnitude(int32_t value)
{
    return value < 0 ? -value : value;
}

/* The direction of the code (a + c, b + c), not normalised, never zero. */
static void octahedron_unfold(int32_t c, int32_t a, int32_t b, double out[3])
{
    int32_t x = a, y = b;
    const int32_t z = c - magnitude(a) - magnitude(b);

    if (z < 0) {
        x = a < 0 ? magnitude(b) - c : c - magnitude(b);
        y = b < 0 ? magnitude(a) - c : c - magnitude(a);
    }
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

/* 1 / sqrt(t) for normal t > 0, within 2 ulp. The shift halves and negates the
 * exponent (3.5 % off), each Newton step about squares the error. */
static double reciprocal_root(double t)
{
    uint64_t word;
    double root;

    memcpy(&word, &t, sizeof word);
    word = UINT64_C(0x5fe6eb50c7b537a9) - (word >> 1);
    memcpy(&root, &word, sizeof root);
    for (int step = 0; step < 4; step++)
        root = root * (1.5 - 0.5 * t * root * root);
    return root;
}

static void normalize(double v[3])
{
    const double scale =
        reciprocal_root(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);

    for (int k = 0; k < 3; k++)
        v[k] *= scale;
}

static void normal_dequantize(int32_t c, const uint16_t *in, float *out)
{
    double v[3];

    octahedron_unfold(c, (int32_t)in[0] - c, (int32_t)in[1] - c, v);
    normalize(v);
    for (int k = 0; k < 3; k++)
        out[k] = (float)v[k];
}

/* The largest code at or below `t` that has an upper neighbour. */
static int32_t lower_code(double t, int32_t c)
{
    const int32_t code = t > 0.0 ? (int32_t)t : 0;

    return code < 2 * c ? code : 2 * c - 1;
}

static void normal_quantize(int32_t c, const float *in, uint16_t *out)
{
    double v[3] = { finite_or_zero(in[0]), finite_or_zero(in[1]),
                    finite_or_zero(in[2]) };
    double size[3];
    for (int k = 0; k < 3; k++)
        size[k] = v[k] < 0.0 ? -v[k] : v[k];
    const double sum = size[0] + size[1] + size[2];
    if (!(sum > 0.0)) {
        out[0] = out[1] = (uint16_t)c;
        return;
    }
    for (int k = 0; k < 3; k++) {
        v[k] /= sum;
        size[k] /= sum;
    }

    double a = v[0], b = v[1];
    if (v[2] < 0.0) {
        a = v[0] < 0.0 ? size[1] - 1.0 : 1.0 - size[1];
        b = v[1] < 0.0 ? size[0] - 1.0 : 1.0 - size[0];
    }
    normalize(v);

    const int32_t left = lower_code((a + 1.0) * c, c) - c;
    const int32_t low = lower_code((b + 1.0) * c, c) - c;
    double least = DBL_MAX;
    for (int corner = 0; corner < 4; corner++) {
        int32_t i = left + (corner & 1), j = low + (corner >> 1);
        double w[3];
        octahedron_unfold(c, i, j, w);
        normalize(w);
        const double x = w[0] - v[0], y = w[1] - v[1], z = w[2] - v[2];
        const double error = x * x + y * y + z * z;
        if (error >= least)
            continue;
        least = error;
        if (magnitude(i) == c)
            j = magnitude(j);
        if (magnitude(j) == c)
            i = magnitude(i);
        out[0] = (uint16_t)(i + c);
        out[1] = (uint16_t)(j + c);
    }
}

uint32_t pmesh_coded_components(const pmesh_attribute *attribute)
{
    return attribute->kind == PMESH_NORMAL ? 2 : attribute->components;
}

void pmesh_attribute_quantize(const pmesh_attribute *attribute,
                              const float *in, uint16_t *out)
{
    assert(attribute->bits >= 4 && attribute->bits <= 16);
    if (attribute->kind == PMESH_NORMAL) {
        normal_quantize(half_side(attribute), in, out);
        return;
    }
    const int32_t last = ((int32_t)1 << attribute->bits) - 1;
    for (uint32_t k = 0; k < attribute->components; k++) {
        const double scale = attribute->scale[k];
        const double offset =
            finite_or_zero(in[k]) - (double)attribute->minimum[k];
        out[k] = scale > 0.0
            ? (uint16_t)round_within(offset / scale, last) : 0;
    }
}

void pmesh_attribute_dequantize(const pmesh_attribute *attribute,
                                const uint16_t *in, float *out)
{
    assert(attribute->bits >= 4 && attribute->bits <= 16);
    if (attribute->kind == PMESH_NORMAL) {
        normal_dequantize(half_side(attribute), in, out);
        return;
    }
    for (uint32_t k = 0; k < attribute->components; k++) {
        out[k] = pmesh_narrow((double)attribute->minimum[k] +
                              (double)in[k] * (double)attribute->scale[k]);
    }
}
