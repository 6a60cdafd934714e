/* SPDX-License-Identifier: MIT */
/* trig.h - sine and cosine that give the same bits on every machine, which the
 * C library's do not promise. */
#ifndef TRIG_H
#define TRIG_H

/* Of an angle in turns (1: all the way round); error below 1e-12. */
double trig_sin(double turns);
double trig_cos(double turns);

#endif
