/* SPDX-License-Identifier: MIT */
/*
 * enc_star.h - what the faces around a vertex say about it.
 *
 * The planes of a vertex are those of its faces, weighted by area, and upright
 * ones that hold boundaries, attribute seams and material borders in place.
 */
#ifndef ENC_STAR_H
#define ENC_STAR_H

#include "encoder/enc_quadric.h"
#include "encoder/enc_sign.h"
#include "encoder/enc_surface.h"

/* The part of a quadric that is not zero while its vertex has not moved. */
typedef struct enc_planes {
    double a[6];
    double weight;
} enc_planes;

/* The planes of v as it is now, about v. */
void enc_star_quadric(const enc_surface *s, uint32_t v, enc_quadric *q);

/* The same for all vertices at once, for a third of the work. */
void enc_star_all_planes(const enc_surface *s, enc_planes *planes);

/* What the rings of a vertex say. */
typedef struct enc_survey {
    double length;     /* sum of the squared edges that leave it */
    double unevenness; /* its squared distance from the mean of its neighbours */
    uint32_t edges;    /* whose lower half-edge leaves it */
    enc_sign sign;     /* of its neighbours */
} enc_survey;

void enc_star_survey(const enc_surface *s, uint32_t v, enc_survey *out);

/* Adds to the plane of constant volume the faces of v without those of
 * `other` (ENC_NONE: all); v lies at `offset`. */
void enc_star_volume(const enc_surface *s, uint32_t v, uint32_t other,
                     const double offset[3], enc_plane *keep);

#endif
