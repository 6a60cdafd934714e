/* SPDX-License-Identifier: MIT */
#include "encoder/enc_import.h"
#include "format/quantize.h"
#include "tests/unit/test.h"

#include <float.h>
#include <math.h>

static uint32_t next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static pmesh_attribute attribute_of(pmesh_attribute_kind kind,
                                    unsigned components, unsigned bits)
{
    return (pmesh_attribute){ .kind = kind,
                              .components = (uint8_t)components,
                              .bits = (uint8_t)bits };
}

/* A code that quantising has produced comes back from its float. */
static void check_normal_code(const pmesh_attribute *normal, unsigned u,
                              unsigned v)
{
    const uint16_t any[2] = { (uint16_t)u, (uint16_t)v };
    uint16_t code[2], again[2];
    float n[3], m[3];

    pmesh_attribute_dequantize(normal, any, n);
    CHECK(fabs((double)n[0] * n[0] + (double)n[1] * n[1] +
               (double)n[2] * n[2] - 1.0) < 1e-6);
    pmesh_attribute_quantize(normal, n, code);
    pmesh_attribute_dequantize(normal, code, m);
    if (u < (1u << normal->bits) - 1 && v < (1u << normal->bits) - 1)
        CHECK(memcmp(n, m, sizeof n) == 0);
    pmesh_attribute_quantize(normal, m, again);
    CHECK(memcmp(code, again, sizeof code) == 0);
}

TEST(normals_keep_every_code_up_to_8_bits)
{
    for (unsigned bits = 4; bits <= 8; bits++) {
        const pmesh_attribute normal = attribute_of(PMESH_NORMAL, 3, bits);
        for (unsigned u = 0; u < 1u << bits; u++)
            for (unsigned v = 0; v < 1u << bits; v++)
                check_normal_code(&normal, u, v);
    }
}

TEST(normals_keep_codes_of_9_to_16_bits)
{
    uint32_t random = 1;

    for (unsigned bits = 9; bits <= 16; bits++) {
        const pmesh_attribute normal = attribute_of(PMESH_NORMAL, 3, bits);
        const unsigned last = (1u << bits) - 1, centre = last / 2;
        for (unsigned i = 0; i < 20000; i++) {
            const unsigned u = next_random(&random) & last;
            const unsigned v = next_random(&random) & last;
            check_normal_code(&normal, u, v);
            check_normal_code(&normal, u, 0);
            check_normal_code(&normal, last - 1, v);
            check_normal_code(&normal, u, centre);
        }
    }
}

TEST(normals_along_the_axes_are_exact)
{
    for (unsigned bits = 4; bits <= 16; bits++) {
        const pmesh_attribute normal = attribute_of(PMESH_NORMAL, 3, bits);
        for (int i = 0; i < 6; i++) {
            float axis[3] = { 0 }, out[3];
            uint16_t code[2];
            axis[i / 2] = i % 2 ? -2.5f : 2.5f;
            pmesh_attribute_quantize(&normal, axis, code);
            pmesh_attribute_dequantize(&normal, code, out);
            for (int k = 0; k < 3; k++)
                CHECK(out[k] == axis[k] / 2.5f);
        }
    }
}

TEST(normals_turn_by_less_than_the_grid)
{
    uint32_t random = 7;

    for (unsigned bits = 4; bits <= 16; bits++) {
        const pmesh_attribute normal = attribute_of(PMESH_NORMAL, 3, bits);
        /* The octahedron's grid is coarsest amid its faces: half a diagonal,
         * stretched by the projection. */
        const double bound = 2.0 / (double)((1u << (bits - 1)) - 1);
        for (unsigned i = 0; i < 3000; i++) {
            float n[3], m[3];
            uint16_t code[2];
            double size = 0.0, distance = 0.0;
            for (int k = 0; k < 3; k++)
                n[k] = (float)next_random(&random) / 8388608.0f - 1.0f;
            for (int k = 0; k < 3; k++)
                size += (double)n[k] * n[k];
            pmesh_attribute_quantize(&normal, n, code);
            pmesh_attribute_dequantize(&normal, code, m);
            for (int k = 0; k < 3; k++) {
                const double d = (double)n[k] / sqrt(size) - (double)m[k];
                distance += d * d;
            }
            CHECK(sqrt(distance) < bound);
        }
    }
}

TEST(normals_without_direction_point_up)
{
    const pmesh_attribute normal = attribute_of(PMESH_NORMAL, 3, 10);
    const float bad[][3] = { { 0, 0, 0 }, { NAN, 0, -0.0f },
                             { INFINITY, -INFINITY, NAN } };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        uint16_t code[2];
        float out[3];
        pmesh_attribute_quantize(&normal, bad[i], code);
        pmesh_attribute_dequantize(&normal, code, out);
        CHECK(out[0] == 0 && out[1] == 0 && out[2] == 1);
    }
    const float tiny[3] = { 0, -1e-45f, 0 }, huge[3] = { FLT_MAX, FLT_MAX, 0 };
    uint16_t code[2];
    float out[3];
    pmesh_attribute_quantize(&normal, tiny, code);
    pmesh_attribute_dequantize(&normal, code, out);
    CHECK(out[1] == -1);
    pmesh_attribute_quantize(&normal, huge, code);
    pmesh_attribute_dequantize(&normal, code, out);
    CHECK(fabsf(out[0] - out[1]) < 0.01f && out[2] < 0.01f);
}

/* All codes that floats of low .. high yield, by way of random ones. */
static void check_uniform(float low, float high, unsigned bits)
{
    pmesh_attribute a = attribute_of(PMESH_GENERIC, 1, bits);
    uint32_t random = 3;

    enc_attribute_fit(&a, 0, low, high);
    CHECK(a.scale[0] >= 0 && a.scale[0] <= FLT_MAX);
    for (unsigned i = 0; i < 2000; i++) {
        const double t = (double)next_random(&random) / 16777215.0;
        const float value = i == 0 ? low : i == 1 ? high
            : (float)((double)low + ((double)high - (double)low) * t);
        uint16_t code, again;
        float out;
        pmesh_attribute_quantize(&a, &value, &code);
        CHECK(code < 1u << bits);
        pmesh_attribute_dequantize(&a, &code, &out);
        pmesh_attribute_quantize(&a, &out, &again);
        CHECK(code == again);
        CHECK(fabs((double)out - (double)value) <=
              (double)a.scale[0] * 0.5 + fabs((double)value) * 0x1p-24);
    }
}

TEST(uniform_codes_survive_any_range)
{
    static const float ends[][2] = {
        { 0, 1 }, { -1, 1 }, { 0, 0 }, { 5.25f, 5.25f }, { 1000, 1000.001f },
        { 1000, 1000.0625f }, { 1023.9f, 1024.1f }, { -1024.01f, -1023.99f },
        { -FLT_MAX, FLT_MAX }, { 0, FLT_MAX }, { 0, 1e-45f },
        { -1e-40f, 1e-40f }, { 1e-38f, 1.3e-38f }, { 16777215, 16777218 },
        { 0.1f, 0.7f }, { -1e10f, 1e-10f }, { 1, 1.0000001f }
    };
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        for (unsigned bits = 4; bits <= 16; bits++)
            check_uniform(ends[i][0], ends[i][1], bits);
    uint32_t random = 11;
    for (unsigned i = 0; i < 500; i++) {
        const float centre = (float)next_random(&random) - 8e6f;
        const float size =
            ldexpf(1.3f, (int)(next_random(&random) % 50) - 25);
        check_uniform(centre, centre + size, 4 + i % 13);
    }
}

TEST(uniform_constants_are_exact)
{
    pmesh_attribute a = attribute_of(PMESH_GENERIC, 1, 12);
    const float value = 0.1f;
    uint16_t code;
    float out;

    enc_attribute_fit(&a, 0, value, value);
    pmesh_attribute_quantize(&a, &value, &code);
    pmesh_attribute_dequantize(&a, &code, &out);
    CHECK(code == 0 && out == value);
}

TEST(uniform_values_outside_go_to_the_ends)
{
    pmesh_attribute a = attribute_of(PMESH_GENERIC, 4, 8);
    const float values[4] = { -1e30f, 1e30f, INFINITY, NAN };
    uint16_t code[4];

    for (uint32_t k = 0; k < 4; k++)
        enc_attribute_fit(&a, k, -1, 1);
    pmesh_attribute_quantize(&a, values, code);
    CHECK(code[0] == 0 && code[1] == 255);
    CHECK(code[2] == code[3] && (code[2] | 1) == 127); /* as zero */
}

TEST(white_stays_white)
{
    for (unsigned bits = 4; bits <= 16; bits++) {
        pmesh_attribute a = attribute_of(PMESH_COLOR, 3, bits);
        const float white[3] = { 1, 0, 0.5f };
        uint16_t code[3];
        float out[3];
        for (uint32_t k = 0; k < 3; k++)
            enc_attribute_fit(&a, k, 0, 1);
        pmesh_attribute_quantize(&a, white, code);
        pmesh_attribute_dequantize(&a, code, out);
        CHECK(fabsf(out[0] - 1.0f) <= FLT_EPSILON / 2 && out[1] == 0);
        CHECK(bits == 5 || out[0] == 1.0f);
    }
}

TEST(grid_points_come_back)
{
    const double origins[] = { 0, -1, 1e6, -123.456, 1e-300, 1e300 };
    const double extents[] = { 1, 1e-3, 7e5, 1e-299, 1e301 };
    uint32_t random = 5;

    for (size_t i = 0; i < 6; i++) {
        for (size_t j = 0; j < 5; j++) {
            pmesh_grid grid = { .origin = { origins[i], 0, 0 } };
            grid.bits = (uint8_t)(4 + (i * 5 + j) % 21);
            const int32_t last = ((int32_t)1 << grid.bits) - 1;
            grid.step = extents[j] / last;
            for (int n = 0; n < 1000; n++) {
                const double x = origins[i] + extents[j] *
                    ((double)next_random(&random) / 16777215.0);
                const int32_t q = pmesh_grid_quantize(&grid, 0, x);
                CHECK(q >= 0 && q <= last);
                const double y = pmesh_grid_dequantize(&grid, 0, q);
                CHECK(pmesh_grid_quantize(&grid, 0, y) == q);
            }
            CHECK(pmesh_grid_quantize(&grid, 0, NAN) == 0);
            CHECK(pmesh_grid_quantize(&grid, 0, INFINITY) == last);
            CHECK(pmesh_grid_quantize(&grid, 0, -INFINITY) == 0);
        }
    }
}

TEST(narrowing_stays_finite)
{
    CHECK(pmesh_narrow(0.1) == 0.1f && pmesh_narrow(-0.1) == -0.1f);
    CHECK(pmesh_narrow(1e300) == FLT_MAX && pmesh_narrow(-1e39) == -FLT_MAX);
    CHECK(pmesh_narrow(HUGE_VAL) == FLT_MAX);
    CHECK(pmesh_narrow(HUGE_VAL - HUGE_VAL) == -FLT_MAX);
}

TEST(dequantising_hostile_codes_stays_finite)
{
    pmesh_attribute a = attribute_of(PMESH_GENERIC, 1, 4);
    pmesh_attribute normal = attribute_of(PMESH_NORMAL, 3, 4);
    const uint16_t codes[] = { 0, 14, 15, 16, 255, 32768, 65535 };
    float out[3];

    a.minimum[0] = -FLT_MAX;
    a.scale[0] = FLT_MAX;
    for (size_t i = 0; i < 7; i++) {
        pmesh_attribute_dequantize(&a, &codes[i], out);
        CHECK(out[0] >= -FLT_MAX && out[0] <= FLT_MAX);
        for (size_t j = 0; j < 7; j++) {
            const uint16_t pair[2] = { codes[i], codes[j] };
            pmesh_attribute_dequantize(&normal, pair, out);
            CHECK(fabsf(out[0] * out[0] + out[1] * out[1] +
                        out[2] * out[2] - 1.0f) < 1e-5f);
        }
    }
}
