/* SPDX-License-Identifier: MIT */
/*
 * enc_cost.h - which contraction comes first: the policies of pmesh_cost, for
 * pmesh_simplify() and for pmesh_encode().
 */
#ifndef ENC_COST_H
#define ENC_COST_H

#include "encoder/pmesh_simplify.h"

/* Lengths are in a frame: model = origin + unit * x. */
typedef struct enc_cost_rule {
    pmesh_cost cost;
    double camera[3];     /* model units */
    pmesh_cost_hook hook; /* of PMESH_COST_CUSTOM */
    void *user;
    double origin[3], unit;
} enc_cost_rule;

/* A contraction, in the frame. */
typedef struct enc_cost_pair {
    uint32_t kept, gone;     /* an input vertex at either end */
    const double *ends[2];   /* where they are, in this order */
    double middle[3], half[3]; /* of the edge; half leads to the end that goes */
    double place[3];         /* of the vertex they become */
    double quadric;          /* area times squared distance, and attributes */
    double distance;         /* squared: its mean, of the distance alone */
} enc_cost_pair;

/* >= 0; infinite if the contraction is forbidden, or the quadric infinite. */
double enc_cost(const enc_cost_rule *rule, const enc_cost_pair *pair);

#endif
