/* SPDX-License-Identifier: MIT */
#include "tools/shade.h"

#include <math.h>

/* A warm key light from the upper left, a soft sky, and edges that turn away
 * a little darker, as clay has them. */
static const double key[3] = { -0.45, 0.60, 0.6614 };

double shade_light(const double normal[3], bool inside)
{
    const double sign = inside ? -1 : 1;
    const double n[3] = { sign * normal[0], sign * normal[1],
                          sign * normal[2] };
    const double direct =
        fmax(0, n[0] * key[0] + n[1] * key[1] + n[2] * key[2]);
    const double sky = 0.5 + 0.5 * n[1];
    const double facing = fmax(0, n[2]);
    return 0.04 + 0.62 * direct + 0.16 * sky + 0.18 * facing;
}

/* Colours from dark to light. */
static const unsigned char clay[4][3] = {
    { 44, 52, 72 }, { 112, 122, 142 }, { 186, 190, 198 }, { 250, 246, 238 }
};
static const unsigned char lining[4][3] = {
    { 62, 36, 32 }, { 132, 86, 72 }, { 192, 148, 126 }, { 240, 212, 190 }
};
static const unsigned char ink[3] = { 30, 36, 56 };

uint32_t shade_color(double light, bool inside, double wire)
{
    const double at = 3 * fmax(0, fmin(1, light));
    const unsigned low = at >= 2 ? 2 : (unsigned)at;
    const unsigned char *a = (inside ? lining : clay)[low];
    const unsigned char *b = (inside ? lining : clay)[low + 1];
    uint32_t color = 0;

    for (unsigned k = 0; k < 3; k++) {
        double c = a[k] + (at - low) * (b[k] - a[k]);
        c += wire * (ink[k] - c);
        color = color << 8 | (uint32_t)(c + 0.5);
    }
    return color;
}
