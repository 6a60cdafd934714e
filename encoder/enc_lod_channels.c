/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_channels.h"

#include <math.h>
#include <string.h>

/* Weights below are none: the scale has to be undone. */
#define LEAST_WEIGHT 1e-9f

pmesh_status enc_lod_channels_plan(const pmesh_simplify_input *in,
                                   enc_lod_channels *out)
{
    *out = (enc_lod_channels){ .count = (unsigned)in->attribute_count };
    if (in->attribute_count > PMESH_MAX_ATTRIBUTES)
        return PMESH_E_ARGUMENT;
    for (int passive = 0; passive < 2; passive++) {
        for (unsigned i = 0; i < out->count; i++) {
            const pmesh_simplify_attribute *a = &in->attributes[i];
            enc_lod_channel *c = &out->channel[i];
            if (!a->values || a->components < 1 ||
                a->components > PMESH_MAX_COMPONENTS)
                return PMESH_E_ARGUMENT;
            c->kind = a->kind;
            c->components = a->components;
            for (unsigned k = 0; k < c->components; k++) {
                if (!(a->weight[k] >= 0 && a->weight[k] < INFINITY))
                    return PMESH_E_ARGUMENT;
                if ((a->weight[k] < LEAST_WEIGHT) != passive)
                    continue;
                c->slot[k] = out->active + out->passive;
                c->scale[k] = passive ? 1 : (double)a->weight[k];
                out->passive += passive != 0;
                out->active += passive == 0;
            }
        }
    }
    return PMESH_OK;
}

static double load(const pmesh_simplify_attribute *a, size_t vertex, unsigned k)
{
    const size_t stride = a->stride ? a->stride : a->components * sizeof(float);
    float value;

    memcpy(&value,
           (const unsigned char *)a->values + vertex * stride +
               k * sizeof value,
           sizeof value);
    return isfinite(value) ? (double)value : 0;
}

void enc_lod_channels_load(enc_lod_channels *channels,
                           const pmesh_simplify_input *in, double *rows)
{
    const size_t width = channels->active + channels->passive;

    for (unsigned i = 0; i < channels->count; i++) {
        enc_lod_channel *c = &channels->channel[i];
        for (unsigned k = 0; k < c->components; k++) {
            double low = INFINITY, high = -INFINITY;
            for (size_t v = 0; v < in->vertex_count; v++) {
                const double value =
                    load(&in->attributes[i], v, k) * c->scale[k];
                rows[v * width + c->slot[k]] = value;
                low = value < low ? value : low;
                high = value > high ? value : high;
            }
            c->low[k] = c->kind == PMESH_COLOR ? 0 : low;
            c->high[k] = c->kind == PMESH_COLOR ? c->scale[k] : high;
        }
    }
}

static void renormalise(const enc_lod_channel *c, double *row)
{
    double square = 0;

    for (unsigned k = 0; k < c->components; k++) {
        const double value = row[c->slot[k]] / c->scale[k];
        square += value * value;
    }
    if (!(square > 0))
        return;
    for (unsigned k = 0; k < c->components; k++)
        row[c->slot[k]] /= sqrt(square);
}

void enc_lod_channels_tidy(const enc_lod_channels *channels, double *row)
{
    for (unsigned i = 0; i < channels->count; i++) {
        const enc_lod_channel *c = &channels->channel[i];
        if (c->kind == PMESH_NORMAL) {
            renormalise(c, row);
            continue;
        }
        for (unsigned k = 0; k < c->components; k++) {
            double *value = &row[c->slot[k]];
            if (!(*value > c->low[k]))
                *value = c->low[k];
            else if (*value > c->high[k])
                *value = c->high[k];
        }
    }
}

static double area(const enc_lod_channel *c, const double *const row[3])
{
    const unsigned x = c->slot[0], y = c->slot[1];

    return (row[1][x] - row[0][x]) * (row[2][y] - row[0][y]) -
           (row[1][y] - row[0][y]) * (row[2][x] - row[0][x]);
}

bool enc_lod_channels_flip(const enc_lod_channels *channels,
                           const double *const before[3],
                           const double *const after[3])
{
    for (unsigned i = 0; i < channels->count; i++) {
        const enc_lod_channel *c = &channels->channel[i];
        if (c->kind != PMESH_TEXCOORD || c->components < 2)
            continue;
        const double old = area(c, before), now = area(c, after);
        if ((old > 0 && now <= 0) || (old < 0 && now >= 0))
            return true;
    }
    return false;
}
