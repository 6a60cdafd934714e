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

static const unsigned char ramp[5][3] = {
    { 44, 62, 150 }, { 44, 150, 190 }, { 92, 182, 92 }, { 238, 206, 72 },
    { 206, 48, 40 }
};

static void warm(double t, double out[3])
{
    const double at = 4 * fmax(0, fmin(1, t));
    const unsigned low = at >= 3 ? 3 : (unsigned)at;

    for (unsigned k = 0; k < 3; k++)
        out[k] = ramp[low][k] + (at - low) * (ramp[low + 1][k] - ramp[low][k]);
}

uint32_t shade_heat(double t)
{
    double c[3];

    warm(t, c);
    return (uint32_t)(c[0] + 0.5) << 16 | (uint32_t)(c[1] + 0.5) << 8 |
           (uint32_t)(c[2] + 0.5);
}

/* Colours keep their hue in the shade, for they are read off a scale. */
uint32_t shade_warm(double light, double t, double wire)
{
    const double dim = 0.45 + 0.55 * fmax(0, fmin(1, light));
    uint32_t color = 0;
    double c[3];

    warm(t, c);
    for (unsigned k = 0; k < 3; k++) {
        const double lit = dim * c[k];
        color = color << 8 | (uint32_t)(lit + wire * (ink[k] - lit) + 0.5);
    }
    return color;
}
