/* SPDX-License-Identifier: MIT */
/*
 * enc_guide_pull.h - constraint quadrics.
 *
 *   contour   I - tt'        distance from the line with direction t
 *   plane     nn'            distance from the plane that fits best
 *   point     I              distance from the place
 *
 * each times weight: the importance and the area of the faces around.
 */
#ifndef ENC_GUIDE_PULL_H
#define ENC_GUIDE_PULL_H

#include "encoder/enc_guide.h"

/* Of one constraint at importance 1, beside the surface's own quadric. */
#define ENC_PULL 1000.0

/* The line through the centre; any two planes through it at right angles. A
 * direction without length gives a point. */
void enc_pull_line(enc_quadric *q, const double direction[3], double weight);

void enc_pull_point(enc_quadric *q, double weight);

/* The plane through `through`, relative to the centre, with unit normal n. */
void enc_pull_plane(enc_quadric *q, const double n[3], const double through[3],
                    double weight);

/* The unit normal of the plane that fits points best, from the sums of their
 * products about their mean: xx xy xz yy yz zz. */
void enc_pull_fit(const double covariance[6], double n[3]);

/* Adds what the guide asks for to guide->pull; `first` is the number that each
 * vertex had before cutting, `number` the one of each input vertex. */
pmesh_status enc_pull_all(enc_mesh *mesh, const pmesh_guide *guide,
                          const uint32_t *number, const uint32_t *first);

#endif
