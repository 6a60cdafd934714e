/* SPDX-License-Identifier: MIT */
/*
 * enc_distance.h - how far a point is from a triangle.
 */
#ifndef ENC_DISTANCE_H
#define ENC_DISTANCE_H

/* Squared; of any triangle, one without area too. */
double enc_distance_square(const double x[3], const double a[3],
                           const double b[3], const double c[3]);

#endif
