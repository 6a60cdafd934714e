/* SPDX-License-Identifier: MIT */
/*
 * enc_candidate.h - what a contraction costs, and where the parent goes.
 *
 * Quadrics are weighted by area, so costs are in steps^4 (area times distance
 * squared), and so are the terms for regularity:
 *
 *     quadric * Q(place) + length * e^2 |child - parent|^2
 *                        + uneven * e^2 |child - mean of its ring|^2
 *
 * with e the mean edge of the mesh at the start of the batch. With another
 * pmesh_cost than PMESH_COST_QUADRIC they are what that says. Attributes with
 * weight are part of Q; see enc_looks.h.
 * Of a guided mesh quadrics are times their factors and the rest is times the
 * mean factor of the pair; constraints move the place, whatever it costs, but
 * only if the best one is not good enough for them.
 */
#ifndef ENC_CANDIDATE_H
#define ENC_CANDIDATE_H

#include "encoder/enc_cost.h"
#include "encoder/enc_guide.h"
#include "encoder/enc_looks.h"
#include "encoder/enc_star.h"

/* Weights of the three terms. */
typedef struct enc_taste {
    double quadric, length, uneven;
} enc_taste;

/* The part of a quadric that a move of its vertex brings about. */
typedef struct enc_moved {
    double b[3];
    double c;
} enc_moved;

/* Of ENC_BLOCK vertices, at the start of the batch. */
typedef struct enc_block {
    double length;         /* sum of the squared edges that leave them */
    uint32_t edges;        /* whose lower half-edge leaves them */
    uint32_t entry, count; /* of them in the queue's list: enc_collect.c */
} enc_block;

typedef struct enc_pricing {
    pmesh_metric metric;
    pmesh_placement placement;
    enc_taste taste;
    enc_cost_rule rule;
    enc_looks looks;
    double edge_square; /* e^2 */
    enc_planes *planes; /* per vertex: its quadric, about its position ... */
    enc_moved *moved;   /* ... NULL with PMESH_MEMORYLESS */
    enc_sign *sign;     /* per vertex: where enc_pricing_begin() shall leave the
                           signature of its rings; or NULL */
    float *unevenness;  /* per vertex: |v - mean of its ring|^2 */
    enc_block *block;   /* per enc_blocks() */
    float *factor;      /* per vertex, as in enc_guide; or NULL */
    enc_quadric *pull;  /* likewise, about its position */
    uint8_t *pulled;    /* whether there is any */
    const uint8_t *lock;
} enc_pricing;

/* Mean squared distances from constraints up to this are as good as none: a
 * quarter of a step. */
#define ENC_CONTENT (1.0 / 16)

typedef struct enc_offer {
    int32_t place[3]; /* where the parent will be */
    double cost;     /* infinite: forbidden */
    double quadric;  /* the part of it that is Q(place) */
    double distance; /* squared, in steps: the mean of Q without attributes */
} enc_offer;

pmesh_status enc_pricing_create(const enc_mesh *mesh,
                                const pmesh_encoder_config *config,
                                enc_pricing *out);
void enc_pricing_destroy(const enc_mesh *mesh, enc_pricing *pricing);

/* Brings the quadrics and the mean edge up to date for a new batch; those of
 * PMESH_ACCUMULATED are made the first time and summed from then on. */
void enc_pricing_begin(enc_pricing *pricing, const enc_surface *s,
                       enc_taste taste, bool first_time);

/* From the quadrics at the start of the batch; cheap. With PMESH_OPTIMAL the
 * place is not on the grid yet. Only cost and quadric are filled in. No pair
 * with the same child may be expected by the looks. */
enc_offer enc_pricing_estimate(const enc_pricing *pricing, const enc_surface *s,
                               const enc_pair *pair);

/* The same of both directions of a pair. */
void enc_pricing_estimate_both(const enc_pricing *pricing, const enc_surface *s,
                               const enc_pair ways[2], enc_offer out[2]);

/* From the surface as it is now; the final word. The pair must be expected by
 * the looks. */
enc_offer enc_pricing_offer(const enc_pricing *pricing, const enc_surface *s,
                            const enc_pair *pair);

/* Mean squared distance, in steps, from what the constraints of both ends ask
 * for: at the parent's place, and at the child's. */
void enc_pricing_ends(const enc_pricing *pricing, const enc_surface *s,
                      const enc_pair *pair, double pull[2]);

/* To be told of each contraction before it happens. */
void enc_pricing_contract(enc_pricing *pricing, const enc_surface *s,
                          const enc_pair *pair, const int32_t place[3]);

#endif
