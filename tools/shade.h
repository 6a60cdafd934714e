/* SPDX-License-Identifier: MIT */
/* shade.h - light and colours of drawn surfaces. */
#ifndef SHADE_H
#define SHADE_H

#include <stdbool.h>
#include <stdint.h>

/* Brightness 0 .. 1 of a unit normal: x right, y up, z towards the viewer.
 * `inside`: the surface is seen from behind. */
double shade_light(const double normal[3], bool inside);

/* 0xRRGGBB of a number 0 .. 1: blue, cyan, green, yellow, red. */
uint32_t shade_heat(double t);

/* The same under a light; `wire` as below. */
uint32_t shade_warm(double light, double t, double wire);

/* 0xRRGGBB of a brightness; `wire` 0 .. 1 mixes in the colour of edges. */
uint32_t shade_color(double light, bool inside, double wire);

#endif
