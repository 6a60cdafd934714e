/* SPDX-License-Identifier: MIT */
/*
 * enc_lod_channels.h - attributes of a caller as rows of numbers: first the
 * weighted components, scaled by their weights, then those without weight.
 */
#ifndef ENC_LOD_CHANNELS_H
#define ENC_LOD_CHANNELS_H

#include <stdbool.h>

#include "encoder/pmesh_simplify.h"

typedef struct enc_lod_channel {
    pmesh_attribute_kind kind;
    unsigned components;
    unsigned slot[PMESH_MAX_COMPONENTS]; /* in a row */
    double scale[PMESH_MAX_COMPONENTS];  /* value in the row / own value */
    double low[PMESH_MAX_COMPONENTS];    /* of the values in the row */
    double high[PMESH_MAX_COMPONENTS];
} enc_lod_channel;

typedef struct enc_lod_channels {
    unsigned count;
    unsigned active, passive;
    enc_lod_channel channel[PMESH_MAX_ATTRIBUTES];
} enc_lod_channels;

/* Lays out the rows; E_ARGUMENT if a weight is negative or not finite or a
 * number is out of range. */
pmesh_status enc_lod_channels_plan(const pmesh_simplify_input *in,
                                   enc_lod_channels *out);

/* Fills a row for every vertex and takes note of the ranges. */
void enc_lod_channels_load(enc_lod_channels *channels,
                           const pmesh_simplify_input *in, double *rows);

/* Makes a row proper: unit normals, colours and others in range. */
void enc_lod_channels_tidy(const enc_lod_channels *channels, double *row);

/* The value of a component of attribute `i` in the caller's terms. */
static inline float enc_lod_channels_value(const enc_lod_channels *channels,
                                           const double *row, unsigned i,
                                           unsigned component)
{
    const enc_lod_channel *c = &channels->channel[i];

    return (float)(row[c->slot[component]] / c->scale[component]);
}

/* True if the triangle of texture coordinates turns over, in any channel. */
bool enc_lod_channels_flip(const enc_lod_channels *channels,
                           const double *const before[3],
                           const double *const after[3]);

#endif
