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

/* A share in the plane of constant volume: what the faces of a vertex add to it,
 * without those of another one. */
typedef struct enc_star_keep {
    uint32_t other;   /* or ENC_NONE */
    double offset[3]; /* of the vertex from the plane's centre */
    enc_plane *plane;
} enc_star_keep;

/* The planes of v as it is now, about v; and its share, unless `keep` is NULL. */
void enc_star_quadric(const enc_surface *s, uint32_t v, enc_quadric *q,
                      const enc_star_keep *keep);

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

/* The share alone. */
void enc_star_volume(const enc_surface *s, uint32_t v,
                     const enc_star_keep *keep);

#endif
