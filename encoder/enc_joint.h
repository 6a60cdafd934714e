/* SPDX-License-Identifier: MIT */
/*
 * enc_joint.h - quadrics over position and attributes together (Garland and
 * Heckbert 1998), in n = 3 + m dimensions.
 *
 * A triangle spans a plane of two dimensions in n; its quadric is the squared
 * distance from there, times its area in space:
 *
 *     A = area (I - e1 e1' - e2 e2'),  e1, e2 orthonormal along the plane
 *
 *         | S  M'|   S: 3 x 3, the enc_quadric that is there without
 *     A = |      |      attributes, too
 *         | M  D |   M: m x 3, D: m x m; and b = (b of S, t)
 *
 * Like an enc_quadric it is kept about a centre: the position and attributes of
 * its wedge. For a given place x the best attributes are s = -1/D (M x + t);
 * putting that in leaves a quadric of x alone, which those of several wedges at
 * one vertex simply add up to. So placement never sees attributes.
 */
#ifndef ENC_JOINT_H
#define ENC_JOINT_H

#include <stddef.h>

#include "encoder/enc_quadric.h"
#include "format/pmesh.h"

/* Attribute dimensions at most. */
#define ENC_JOINT_MAX (PMESH_MAX_ATTRIBUTES * PMESH_MAX_COMPONENTS)

/* The tail of a quadric: M by rows, the lower triangle of D by rows, t. */
static inline size_t enc_joint_tail(unsigned m)
{
    return (size_t)m * (3 + 1) + (size_t)m * (m + 1) / 2;
}
#define ENC_JOINT_TAIL_MAX (ENC_JOINT_MAX * 4 + \
                            ENC_JOINT_MAX * (ENC_JOINT_MAX + 1) / 2)

/* Orthonormal e and f, of 3 + m each, along the plane of a triangle whose other
 * two corners are seen from the first at (p, s) and (q, t); false if it has no
 * two directions. */
bool enc_joint_frame(unsigned m, const double p[3], const double *s,
                     const double q[3], const double *t, double e[],
                     double f[]);

/* Adds the plane of a triangle through the centre, whose other two corners are
 * seen from there at (p, s) and (q, t). Without area it is nothing. */
void enc_joint_add_face(enc_quadric *sum, double *tail, unsigned m,
                        const double p[3], const double *s, const double q[3],
                        const double *t);

/* sum += q, whose centre lies at (x, s) as seen from the sum's. */
void enc_joint_add(enc_quadric *sum, double *sum_tail, const enc_quadric *q,
                   const double *tail, unsigned m, const double x[3],
                   const double *s);

/* The value at (x, s) as seen from the centre; never negative. */
double enc_joint_value(const enc_quadric *q, const double *tail, unsigned m,
                       const double x[3], const double *s);

/* What enc_joint_reduce() keeps to solve for s later. */
typedef struct enc_joint_solver {
    double factor[ENC_JOINT_MAX * (ENC_JOINT_MAX + 1) / 2]; /* of D, L L' */
    double mixed[ENC_JOINT_MAX][3]; /* 1/L M */
    double own[ENC_JOINT_MAX];      /* 1/L t */
} enc_joint_solver;

/*
 * Turns q into the least value over all s at each place x. A slight pull holds
 * s at the centre where D is flat. Only q changes; with m = 0 nothing does.
 */
void enc_joint_reduce(enc_quadric *q, const double *tail, unsigned m,
                      enc_joint_solver *out);

/* The attributes that belong to x. */
void enc_joint_attributes(const enc_joint_solver *solver, unsigned m,
                          const double x[3], double *s);

#endif
