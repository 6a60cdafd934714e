/* SPDX-License-Identifier: MIT */
/*
 * font.h - captions for pictures, in a small stroke font of our own.
 *
 * ASCII is drawn; any other character shows as a box. The same pixels on every
 * machine.
 */
#ifndef FONT_H
#define FONT_H

#include "tools/picture.h"

typedef struct font_style {
    double height; /* of capitals, pixels */
    double weight; /* stroke width, pixels */
    picture_color color;
} font_style;

/* The width of one line in pixels. */
double font_width(const char *text, const font_style *style);

/* Draws one line from the left end of its baseline. Returns its width. */
double font_draw(picture *p, double x, double baseline, const char *text,
                 const font_style *style);

/* As above, but shortened to `width` pixels with dots in the middle. */
double font_draw_fitted(picture *p, double x, double baseline, double width,
                        const char *text, const font_style *style);

#endif
