/* SPDX-License-Identifier: MIT */
#include "tools/font.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "tools/utf8.h"

/*
 * A glyph is a list of strokes, a stroke a list of points of two characters: x
 * as 0..9, A..C (10..12) and y as a..r (-4..13). Baseline e = 0, x-height m =
 * 8, capitals q = 12, descenders a = -4. A stroke that begins with ~ is curved:
 * its inner points are the controls of a quadratic B-spline, so that
 *
 *   0q +--.--+ 8q    "~0k 0q 8q 8e 0e 0k" is an O that touches the middles of
 *      | / \ |       the sides; a control given twice is a sharp corner.
 *   0k ( O   )
 *      | \ / |
 *   0e +--.--+ 8e
 */
static const char *const glyphs[] = {
    /*   */ "",
    /* ! */ "1q1i 1e1e",
    /* " */ "1q1n 4q4n",
    /* # */ "2e4q 5e7q 0i8i 1m9m",
    /* $ */ "~7o7q0q0l7j7e0e0g 4r4d",
    /* % */ "~0o0q4q4m0m0o ~6g6iAiAe6e6g 8q2e",
    /* & */ "~8j6e0e0j5l5q1q1m8e",
    /* ' */ "1q1n",
    /* ( */ "~3r0o0f3c",
    /* ) */ "~0r3o3f0c",
    /* * */ "3q3k 0p6l 6p0l",
    /* + */ "0j6j 3m3g",
    /* , */ "1f0c",
    /* - */ "0j4j",
    /* . */ "1e1e",
    /* / */ "0c5r",
    /* 0 */ "~0k0q7q7e0e0k",
    /* 1 */ "1n4q4e",
    /* 2 */ "~0n0q7q7k0e0e7e",
    /* 3 */ "~0o0q7q7k3k ~3k7k7e0e0g",
    /* 4 */ "5e5q0h7h",
    /* 5 */ "6q1q0k ~0k1m7m7e0e0g",
    /* 6 */ "~0i0m7m7e0e0i ~0i0o5q",
    /* 7 */ "0q7q2e",
    /* 8 */ "~1n1q6q6k1k1n ~0h0k7k7e0e0h",
    /* 9 */ "~7m7q0q0i7i7m ~7m7g2e",
    /* : */ "1l1l 1e1e",
    /* ; */ "1l1l 1f0c",
    /* < */ "6n0j6f",
    /* = */ "0l6l 0h6h",
    /* > */ "0n6j0f",
    /* ? */ "~0o0q6q6l3l3i3h 3e3e",
    /* @ */ "~9g7c0c0qAqAh7h7k ~7k7n3n3h7h7k",
    /* A */ "0e4q8e 1h7h",
    /* B */ "0e0q ~0q3q7q7k3k0k ~0k4k8k8e4e0e",
    /* C */ "~8o8q0q0e8e8g",
    /* D */ "0e0q ~0q4q9q9e4e0e",
    /* E */ "7q0q0e7e 0k6k",
    /* F */ "7q0q0e 0k6k",
    /* G */ "~8o8q0q0e8e8k8k5k",
    /* H */ "0e0q 8e8q 0k8k",
    /* I */ "1e1q",
    /* J */ "~5q5h5e0e0h",
    /* K */ "0e0q 7q0i 2k7e",
    /* L */ "0q0e6e",
    /* M */ "0e0q5hAqAe",
    /* N */ "0e0q8e8q",
    /* O */ "~0k0q9q9e0e0k",
    /* P */ "0e0q ~0q4q8q8j4j0j",
    /* Q */ "~0k0q9q9e0e0k 6h9d",
    /* R */ "0e0q ~0q4q8q8j4j0j 4j8e",
    /* S */ "~7o7q0q0l7j7e0e0g",
    /* T */ "0q8q 4q4e",
    /* U */ "~0q0i0e8e8i8q",
    /* V */ "0q4e8q",
    /* W */ "0q3e6q9eCq",
    /* X */ "0q8e 8q0e",
    /* Y */ "0q4k8q 4k4e",
    /* Z */ "0q7q0e7e",
    /* [ */ "3r0r0c3c",
    /* \ */ "0r5c",
    /* ] */ "0r3r3c0c",
    /* ^ */ "0m3q6m",
    /* _ */ "0c7c",
    /* ` */ "0q2o",
    /* a */ "6m6e ~6i6m0m0e6e6i",
    /* b */ "0q0e ~0i0m6m6e0e0i",
    /* c */ "~6k6m0m0e6e6g",
    /* d */ "6q6e ~6i6m0m0e6e6i",
    /* e */ "0i6i ~6i6m0m0e6e6g",
    /* f */ "~5q2q2m2e 0m5m",
    /* g */ "~6i6m0m0e6e6i ~6m6c6a0a0b",
    /* h */ "0q0e ~0i0m6m6i6e",
    /* i */ "1m1e 1p1p",
    /* j */ "~2m2c2a0a 2p2p",
    /* k */ "0q0e 6m0h 2j6e",
    /* l */ "1q1e",
    /* m */ "0m0e ~0i0m5m5i5e ~5i5mAmAiAe",
    /* n */ "0m0e ~0i0m6m6i6e",
    /* o */ "~0i0m7m7e0e0i",
    /* p */ "0m0a ~0i0m6m6e0e0i",
    /* q */ "6m6a ~6i6m0m0e6e6i",
    /* r */ "0m0e ~0i0m4m",
    /* s */ "~5k5m0m0j5i5e0e0g",
    /* t */ "~2q2i2e5e 0m5m",
    /* u */ "6m6e ~0m0i0e6e6i",
    /* v */ "0m3e6m",
    /* w */ "0m2e5m8eAm",
    /* x */ "0m6e 6m0e",
    /* y */ "0m3e 6m1a",
    /* z */ "0m6m0e6e",
    /* { */ "~3r1r1k1k0j ~0j1j1i1c3c",
    /* | */ "1r1c",
    /* } */ "~0r2r2k2k3j ~3j2j2i2c0c",
    /* ~ */ "~0j1m3l4j6j7m",
};
static const char *const box = "0e0q6q6e0e";

#define UNITS_PER_CAPITAL 12.0
#define LETTER_GAP 3.4
#define SPACE_WIDTH 3.0
#define CURVE_STEPS 8
#define MAX_SEGMENTS 128

typedef struct segment {
    double x0, y0, x1, y1;
} segment;

typedef struct outline {
    segment segments[MAX_SEGMENTS];
    size_t count;
    double width;
} outline;

typedef struct point {
    double x, y;
} point;

static point read_point(const char *p)
{
    const int x = p[0] <= '9' ? p[0] - '0' : p[0] - 'A' + 10;
    return (point){ x, p[1] - 'a' - 4 };
}

static void add_segment(outline *out, point a, point b)
{
    if (out->count < MAX_SEGMENTS)
        out->segments[out->count++] = (segment){ a.x, a.y, b.x, b.y };
    out->width = fmax(out->width, fmax(a.x, b.x));
}

static point between(point a, point b, double t)
{
    return (point){ a.x + t * (b.x - a.x), a.y + t * (b.y - a.y) };
}

/* From `from` to `to`, pulled towards `control`. */
static void add_arc(outline *out, point from, point control, point to)
{
    point last = from;
    for (int i = 1; i <= CURVE_STEPS; i++) {
        const double t = (double)i / CURVE_STEPS;
        const point next = between(between(from, control, t),
                                   between(control, to, t), t);
        add_segment(out, last, next);
        last = next;
    }
}

/* `count` points of two characters each. */
static void add_stroke(outline *out, const char *points, size_t count,
                       bool curved)
{
    point at = read_point(points);

    if (!curved) {
        for (size_t i = 1; i < count; i++) {
            const point next = read_point(points + 2 * i);
            add_segment(out, at, next);
            at = next;
        }
        return;
    }
    for (size_t i = 1; i + 1 < count; i++) {
        const point control = read_point(points + 2 * i);
        point next = read_point(points + 2 * i + 2);
        if (i + 2 < count)
            next = between(control, next, 0.5);
        add_arc(out, at, control, next);
        at = next;
    }
}

static void read_glyph(uint32_t code, outline *out)
{
    const char *p = code >= ' ' && code <= '~' ? glyphs[code - ' '] : box;

    out->count = 0;
    out->width = *p ? 0 : SPACE_WIDTH;
    if (code >= '0' && code <= '9')
        out->width = 7; /* figures stand below each other */
    while (*p) {
        const bool curved = *p == '~';
        p += curved;
        const size_t size = strcspn(p, " ");
        add_stroke(out, p, size / 2, curved);
        p += size + (p[size] == ' ');
    }
}

static double distance_to(const segment *s, double x, double y)
{
    const double dx = s->x1 - s->x0;
    const double dy = s->y1 - s->y0;
    const double length2 = dx * dx + dy * dy;
    double t = 0;
    if (length2 > 0)
        t = ((x - s->x0) * dx + (y - s->y0) * dy) / length2;
    t = fmax(0, fmin(1, t));
    const double ex = x - s->x0 - t * dx;
    const double ey = y - s->y0 - t * dy;
    return sqrt(ex * ex + ey * ey);
}

/* A round pen along all strokes; one pass, so that crossings are not darker. */
static void draw_glyph(picture *p, double x, double baseline,
                       const outline *glyph, const font_style *style)
{
    const double unit = style->height / UNITS_PER_CAPITAL;
    const double pen = style->weight / 2;
    const int64_t left = (int64_t)floor(x - pen - 1);
    const int64_t right = (int64_t)ceil(x + glyph->width * unit + pen + 1);
    const int64_t top = (int64_t)floor(baseline - 14 * unit - pen);
    const int64_t bottom = (int64_t)ceil(baseline + 5 * unit + pen);

    for (int64_t j = top; j < bottom; j++) {
        for (int64_t i = left; i < right; i++) {
            const double gx = ((double)i + 0.5 - x) / unit;
            const double gy = (baseline - (double)j - 0.5) / unit;
            double nearest = HUGE_VAL;
            for (size_t k = 0; k < glyph->count; k++)
                nearest =
                    fmin(nearest, distance_to(&glyph->segments[k], gx, gy));
            const double coverage =
                fmax(0, fmin(1, pen + 0.5 - nearest * unit));
            picture_blend(p, i, j, style->color,
                          (unsigned)(coverage * 255 + 0.5));
        }
    }
}

double font_draw(picture *p, double x, double baseline, const char *text,
                 const font_style *style)
{
    const double unit = style->height / UNITS_PER_CAPITAL;
    double at = 0;
    uint32_t code;
    size_t length;

    for (; (length = utf8_next(text, &code)) > 0; text += length) {
        outline glyph;
        if (at > 0)
            at += LETTER_GAP * unit;
        read_glyph(code, &glyph);
        if (p)
            draw_glyph(p, x + at, baseline, &glyph, style);
        at += glyph.width * unit;
    }
    return at;
}

double font_width(const char *text, const font_style *style)
{
    return font_draw(NULL, 0, 0, text, style);
}

double font_draw_fitted(picture *p, double x, double baseline, double width,
                        const char *text, const font_style *style)
{
    char shorter[256];
    const size_t size = strlen(text);
    size_t kept = size < 200 ? size : 200;

    if (size == kept && font_width(text, style) <= width)
        return font_draw(p, x, baseline, text, style);
    /* Both ends tell most: the begin of a name and its ending. */
    do {
        kept--;
        const size_t head = kept / 2;
        const size_t tail = kept - head;
        snprintf(shorter, sizeof shorter, "%.*s...%s", (int)head, text,
                 text + size - tail);
    } while (kept > 0 && font_width(shorter, style) > width);
    return font_draw(p, x, baseline, shorter, style);
}
