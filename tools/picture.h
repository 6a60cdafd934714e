/* SPDX-License-Identifier: MIT */
/*
 * picture.h - an RGB image to draw on. x runs right, y down.
 */
#ifndef PICTURE_H
#define PICTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tools/asset.h"

typedef struct picture {
    uint8_t *rgb; /* 3 bytes per pixel, row by row */
    uint32_t width, height;
} picture;

/* A colour as 0xRRGGBB. */
typedef uint32_t picture_color;

/* An image of one colour; false when memory is out. */
bool picture_create(picture *out, uint32_t width, uint32_t height,
                    picture_color color);
void picture_free(picture *p);

/* Mixes a colour into a pixel, coverage 0 .. 255; outside: nothing. */
void picture_blend(picture *p, int64_t x, int64_t y, picture_color color,
                   unsigned coverage);

/* A filled rectangle with round corners. */
void picture_card(picture *p, uint32_t x, uint32_t y, uint32_t width,
                  uint32_t height, uint32_t radius, picture_color color);

/* Appends the image as a PNG file; false when memory is out. */
bool picture_to_png(const picture *p, asset_bytes *out);

#endif
