/* SPDX-License-Identifier: MIT */
/*
 * sheet.h - the layout of a contact sheet: a heading and a grid of panels, each
 * a mesh with a caption below.
 *
 *   heading                         heading_right
 *   +-----------------+  +-----------------+
 *   |      mesh       |  |                 |
 *   | left      right |  |                 |
 *   | below     below |  |                 |
 *   +-----------------+  +-----------------+
 */
#ifndef SHEET_H
#define SHEET_H

#include <stdbool.h>
#include <stdint.h>

#include "tools/picture.h"
#include "tools/raster.h"

typedef struct sheet {
    picture picture;
    uint32_t panel; /* width of a panel, pixels */
    uint32_t columns;
} sheet;

typedef struct sheet_caption {
    char left[64], right[64];             /* the first line, heavier */
    char left_below[64], right_below[64]; /* the second one */
    char blue[24], red[24]; /* the ends of the scale of heat; empty: none */
} sheet_caption;

/* A sheet for `count` panels; false when memory is out. */
bool sheet_begin(sheet *out, uint32_t count, uint32_t columns, uint32_t panel,
                 const char *heading, const char *heading_right);

/* Draws panel `index`, counted row by row. False when memory is out. */
bool sheet_draw(sheet *s, uint32_t index, const asset *mesh,
                const raster_camera *camera, const raster_style *style,
                const sheet_caption *caption);

void sheet_free(sheet *s);

#endif
