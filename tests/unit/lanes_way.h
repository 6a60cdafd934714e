/* SPDX-License-Identifier: MIT */
/* The body of one way: see lanes_ways.h. WAY names it. */
#ifndef PMESH_TEST_LANES_WAY_H
#define PMESH_TEST_LANES_WAY_H

#include "format/lanes.h"
#include "tests/unit/lanes_ways.h"

static int32_t *put_lanes(int32_t *out, lanes a)
{
    int16_t x[LANES];
    lanes_store(x, a);
    for (int i = 0; i < LANES; i++)
        *out++ = x[i];
    return out;
}

static int32_t *put_quads(int32_t *out, quads a)
{
    quads_store(out, a);
    return out + QUADS;
}

/* Of two lanes and two more. */
static int32_t *put_short(int32_t *out, const lanes in[4])
{
    const lanes a = in[0], b = in[1];
    out = put_lanes(out, lanes_add(a, b));
    out = put_lanes(out, lanes_sub(a, b));
    out = put_lanes(out, lanes_min(a, b));
    out = put_lanes(out, lanes_max(a, b));
    out = put_lanes(out, lanes_and(a, b));
    out = put_lanes(out, lanes_size(a));
    out = put_lanes(out, lanes_high(a, b));
    out = put_lanes(out, lanes_high_unsigned(a, b));
    out = put_lanes(out, lanes_half_unsigned(a));
    out = put_lanes(out, lanes_times(a, 44));
    out = put_lanes(out, lanes_times(a, -32767));
    for (int by = 0; by < 16; by += 5) {
        out = put_lanes(out, lanes_left(a, by));
        out = put_lanes(out, lanes_right(a, by));
    }
    out = put_lanes(out, lanes_less(a, b));
    *out++ = lanes_least(a);
    *out++ = lanes_total(a);
    return out;
}

/* Of four quads, and of products: quads_dot() says only the sum of its own. */
static int32_t *put_long(int32_t *out, const quads in[4], const lanes x[4])
{
    const quads a = in[0], b = in[1];
    out = put_quads(out, quads_add(a, b));
    out = put_quads(out, quads_sub(a, b));
    out = put_quads(out, quads_or(a, b));
    out = put_quads(out, quads_min(a, b));
    out = put_quads(out, quads_max(a, b));
    for (uint32_t by = 1; by < 48; by += 23) {
        out = put_quads(out, quads_times(a, by));
        out = put_quads(out, quads_high(a, UINT32_MAX / by));
    }
    out = put_quads(out, quads_size(a));
    out = put_quads(out, quads_first(x[0], x[1], x[2], x[3]));
    out = put_quads(out, quads_last(x[0], x[1], x[2], x[3]));
    for (int by = 0; by < 32; by += 10) {
        out = put_quads(out, quads_left(a, by));
        out = put_quads(out, quads_right(a, by));
    }
    out = put_lanes(out, lanes_within(a, quads_right(b, 14)));
    *out++ = quads_total(quads_dot(x[0], x[1]));
    *out++ = quads_total(a);
    *out++ = (int32_t)quads_any(a);
    return out;
}

static int32_t *put_columns(int32_t *out, const int32_t long_in[16])
{
    quads row[8];
    lanes column[3];
    for (int i = 0; i < 8; i++)
        row[i] = quads_right(quads_triple(long_in + i), 2 * i);
    lanes_columns(row, column);
    for (int k = 0; k < 3; k++)
        out = put_lanes(out, column[k]);
    return put_quads(out, row[0]);
}

uint32_t WAY(const int16_t in[LANES_IN], int32_t out[LANES_OUT])
{
    int32_t long_in[16], *at = out;
    lanes x[4];
    quads y[4];
    for (int i = 0; i < 16; i++)
        long_in[i] = in[i] * 65536 + in[i + 16];
    for (int i = 0; i < 4; i++) {
        x[i] = lanes_load(in + 8 * i);
        y[i] = quads_load(long_in + 4 * i);
    }
    at = put_short(at, x);
    at = put_long(at, y, x);
    return (uint32_t)(put_columns(at, long_in) - out);
}

#endif
