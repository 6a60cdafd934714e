/* SPDX-License-Identifier: MIT */
/* plot.h - curves on logarithmic axes, as SVG text. */
#ifndef PLOT_H
#define PLOT_H

#include <stdbool.h>
#include <stddef.h>

#include "tools/asset.h"

enum { PLOT_CURVES = 12, PLOT_POINTS = 256 };

typedef struct plot_curve {
    char name[64];
    size_t count;
    double x[PLOT_POINTS], y[PLOT_POINTS];
} plot_curve;

/* Points that a logarithm cannot show are left out. */
void plot_add(plot_curve *curve, double x, double y);

/* False when memory is out. */
bool plot_write(const plot_curve *curves, size_t count, const char *x_label,
                const char *y_label, asset_bytes *out);

#endif
