/* SPDX-License-Identifier: MIT */
#include "tools/picture.h"

#include <math.h>
#include <stdlib.h>

bool picture_create(picture *out, uint32_t width, uint32_t height,
                    picture_color color)
{
    const uint64_t pixels = (uint64_t)width * height;

    *out = (picture){ .width = width, .height = height };
    if (pixels > SIZE_MAX / 4)
        return false;
    out->rgb = malloc((size_t)pixels * 3 + 1);
    if (!out->rgb)
        return false;
    for (size_t i = 0; i < pixels; i++) {
        out->rgb[3 * i] = (uint8_t)(color >> 16);
        out->rgb[3 * i + 1] = (uint8_t)(color >> 8);
        out->rgb[3 * i + 2] = (uint8_t)color;
    }
    return true;
}

void picture_free(picture *p)
{
    free(p->rgb);
    *p = (picture){ 0 };
}

void picture_blend(picture *p, int64_t x, int64_t y, picture_color color,
                   unsigned coverage)
{
    if (x < 0 || y < 0 || x >= p->width || y >= p->height)
        return;
    uint8_t *pixel = p->rgb + 3 * ((size_t)y * p->width + (size_t)x);
    for (unsigned k = 0; k < 3; k++) {
        const unsigned to = color >> (16 - 8 * k) & 0xFF;
        pixel[k] = (uint8_t)((pixel[k] * (255 - coverage) + to * coverage +
                              127) / 255);
    }
}

void picture_card(picture *p, uint32_t x, uint32_t y, uint32_t width,
                  uint32_t height, uint32_t radius, picture_color color)
{
    for (uint32_t j = 0; j < height; j++) {
        for (uint32_t i = 0; i < width; i++) {
            /* How far the pixel's centre is beyond the corner's centre. */
            const double dx = fmax(radius - (i + 0.5),
                                   i + 0.5 - ((double)width - radius));
            const double dy = fmax(radius - (j + 0.5),
                                   j + 0.5 - ((double)height - radius));
            double inside = 1;
            if (dx > 0 && dy > 0)
                inside = radius - sqrt(dx * dx + dy * dy) + 0.5;
            inside = fmin(1, fmax(0, inside));
            picture_blend(p, (int64_t)x + i, (int64_t)y + j, color,
                          (unsigned)(inside * 255 + 0.5));
        }
    }
}
