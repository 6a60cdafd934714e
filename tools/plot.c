/* SPDX-License-Identifier: MIT */
#include "tools/plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define WIDTH 720
#define HEIGHT 440
#define LEFT 74
#define RIGHT 24
#define TOP 24
#define BOTTOM 54

static const char *const colors[] = { "#2f5d8c", "#c0562f", "#4f8a4b",
                                      "#8a5a9c", "#b08a2e", "#3f8f8f" };
enum { COLORS = sizeof colors / sizeof *colors };

/* Whole powers of ten around all points. */
typedef struct frame {
    int x0, x1, y0, y1;
} frame;

void plot_add(plot_curve *curve, double x, double y)
{
    if (curve->count == PLOT_POINTS || !(x > 0) || !(y > 0) ||
        !(x < HUGE_VAL) || !(y < HUGE_VAL))
        return;
    curve->x[curve->count] = x;
    curve->y[curve->count++] = y;
}

static frame find_frame(const plot_curve *curves, size_t count)
{
    frame f = { 400, -400, 400, -400 };

    for (size_t c = 0; c < count; c++)
        for (size_t i = 0; i < curves[c].count; i++) {
            const double x = log10(curves[c].x[i]), y = log10(curves[c].y[i]);
            f.x0 = (int)fmin(f.x0, floor(x));
            f.x1 = (int)fmax(f.x1, ceil(x));
            f.y0 = (int)fmin(f.y0, floor(y));
            f.y1 = (int)fmax(f.y1, ceil(y));
        }
    if (f.x0 > f.x1)
        return (frame){ 0, 1, 0, 1 };
    f.x1 += f.x0 == f.x1;
    f.y1 += f.y0 == f.y1;
    return f;
}

static double x_of(const frame *f, double power)
{
    return LEFT + (WIDTH - LEFT - RIGHT) * (power - f->x0) / (f->x1 - f->x0);
}

static double y_of(const frame *f, double power)
{
    return HEIGHT - BOTTOM -
           (HEIGHT - TOP - BOTTOM) * (power - f->y0) / (f->y1 - f->y0);
}

static void put_text(asset_bytes *out, const char *text)
{
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        const char plain[2] = { c < ' ' || c > '~' ? '?' : (char)c, '\0' };
        const char *shown = c == '&'   ? "&amp;"
                            : c == '<' ? "&lt;"
                            : c == '>' ? "&gt;"
                                       : plain;
        asset_put(out, shown, strlen(shown));
    }
}

/* A line at each power of ten with its number, fainter ones between. */
static void put_grid(asset_bytes *out, const frame *f)
{
    static const double faint[] = { 2, 5 };

    asset_printf(out, "<g stroke=\"#d9d6cf\" stroke-width=\"1\">\n");
    for (int p = f->x0; p <= f->x1; p++)
        for (int i = -1; i < (p < f->x1 ? 2 : 0); i++)
            asset_printf(out,
                         "<path d=\"M%.2f %dV%d\" stroke-opacity=\"%s\"/>\n",
                         x_of(f, p + (i < 0 ? 0 : log10(faint[i]))), TOP,
                         HEIGHT - BOTTOM, i < 0 ? "1" : "0.5");
    for (int p = f->y0; p <= f->y1; p++)
        for (int i = -1; i < (p < f->y1 ? 2 : 0); i++)
            asset_printf(out,
                         "<path d=\"M%d %.2fH%d\" stroke-opacity=\"%s\"/>\n",
                         LEFT, y_of(f, p + (i < 0 ? 0 : log10(faint[i]))),
                         WIDTH - RIGHT, i < 0 ? "1" : "0.5");
    asset_printf(out, "</g>\n<g fill=\"#5a6070\">\n");
    for (int p = f->x0; p <= f->x1; p++)
        asset_printf(out,
                     "<text x=\"%.2f\" y=\"%d\" text-anchor=\"middle\">"
                     "1e%d</text>\n",
                     x_of(f, p), HEIGHT - BOTTOM + 18, p);
    for (int p = f->y0; p <= f->y1; p++)
        asset_printf(out,
                     "<text x=\"%d\" y=\"%.2f\" text-anchor=\"end\">"
                     "1e%d</text>\n",
                     LEFT - 8, y_of(f, p) + 4, p);
    asset_printf(out, "</g>\n");
}

static void put_labels(asset_bytes *out, const char *x, const char *y)
{
    asset_printf(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">",
                 (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 12);
    put_text(out, x);
    asset_printf(out, "</text>\n<text transform=\"translate(18 %d) "
                      "rotate(-90)\" text-anchor=\"middle\">",
                 (TOP + HEIGHT - BOTTOM) / 2);
    put_text(out, y);
    asset_printf(out, "</text>\n");
}

static void put_curve(asset_bytes *out, const frame *f, const plot_curve *c,
                      size_t index)
{
    const char *color = colors[index % COLORS];
    const double y = TOP + 16 + 18 * (double)index;

    asset_printf(out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"2\" "
                      "d=\"", color);
    for (size_t i = 0; i < c->count; i++)
        asset_printf(out, "%s%.2f %.2f", i ? "L" : "M",
                     x_of(f, log10(c->x[i])), y_of(f, log10(c->y[i])));
    asset_printf(out, "\"/>\n<g fill=\"%s\">\n", color);
    for (size_t i = 0; i < c->count; i++)
        asset_printf(out, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"3\"/>\n",
                     x_of(f, log10(c->x[i])), y_of(f, log10(c->y[i])));
    asset_printf(out, "<rect x=\"%d\" y=\"%.2f\" width=\"12\" height=\"4\"/>\n"
                      "</g>\n<text x=\"%d\" y=\"%.2f\" text-anchor=\"end\">",
                 WIDTH - RIGHT - 22, y - 6, WIDTH - RIGHT - 30, y);
    put_text(out, c->name);
    asset_printf(out, "</text>\n");
}

bool plot_write(const plot_curve *curves, size_t count, const char *x_label,
                const char *y_label, asset_bytes *out)
{
    const frame f = find_frame(curves, count);

    asset_printf(out,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" "
                 "height=\"%d\" viewBox=\"0 0 %d %d\" font-family=\"sans-serif\""
                 " font-size=\"12\" fill=\"#2a3042\">\n"
                 "<rect width=\"100%%\" height=\"100%%\" fill=\"#fbfaf7\"/>\n",
                 WIDTH, HEIGHT, WIDTH, HEIGHT);
    put_grid(out, &f);
    put_labels(out, x_label, y_label);
    for (size_t i = 0; i < count; i++)
        put_curve(out, &f, &curves[i], i);
    asset_printf(out, "</svg>\n");
    return !out->failed;
}
