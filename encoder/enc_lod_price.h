/* SPDX-License-Identifier: MIT */
/*
 * enc_lod_price.h - what a contraction of an enc_lod costs, and where the
 * vertex goes.
 */
#ifndef ENC_LOD_PRICE_H
#define ENC_LOD_PRICE_H

#include "encoder/enc_cost.h"
#include "encoder/enc_lod_wedges.h"
#include "encoder/pmesh_simplify.h"

/* From model units to the frame of the enc_lod, where the bounding box is a
 * unit cube about the origin, and back: model = origin + extent * p. */
typedef struct enc_lod_frame {
    double origin[3];
    double extent; /* > 0 */
} enc_lod_frame;

typedef struct enc_lod_pricer {
    enc_lod *lod;
    pmesh_place placement;
    enc_cost_rule rule;
    enc_lod_wedges wedges;
    /* Per vertex: planes of the original's faces, summed. Beside the quadrics
     * of the current surface, `recall` times as heavy, they keep thin limbs
     * from being forgotten; and they tell the distance to the original. */
    enc_quadric *memory;
    double recall;
    bool break_seams; /* PMESH_PLACE_ENDPOINT: a wedge may go where it does not
                         belong, on the other side of a seam */
} enc_lod_pricer;

typedef struct enc_lod_offer {
    uint32_t gone, kept;
    double place[3];
    double cost;     /* infinite: impossible */
    double quadric;  /* of the current surface and attributes, and of memory */
    double distance; /* squared, to the planes of the original */
} enc_lod_offer;

/* `value` is taken over, on failure as well. */
pmesh_status enc_lod_pricer_create(enc_lod *lod,
                                   const pmesh_simplify_options *options,
                                   const enc_lod_frame *frame,
                                   pmesh_place placement,
                                   const enc_lod_channels *channels,
                                   double *value, enc_lod_pricer *out);
void enc_lod_pricer_destroy(enc_lod_pricer *p);

/* Starts the memory of v with its faces as they are; after the renewal. */
void enc_lod_pricer_remember(enc_lod_pricer *p, uint32_t v);

/* The cost of contracting u and v, no more: cheap. With PMESH_PLACE_ENDPOINT,
 * `turn` asks for the worse direction. */
double enc_lod_pricer_cost(enc_lod_pricer *p, uint32_t u, uint32_t v,
                           bool turn);

/* All of it. */
enc_lod_offer enc_lod_pricer_offer(enc_lod_pricer *p, uint32_t u, uint32_t v,
                                   bool turn);

/* Moves the kept vertex; before enc_lod_contract(). */
void enc_lod_pricer_move(enc_lod_pricer *p, const enc_lod_offer *offer);

#endif
