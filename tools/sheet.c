/* SPDX-License-Identifier: MIT */
#include "tools/sheet.h"

#include "tools/font.h"
#include "tools/shade.h"

#define EDGE 28u      /* around everything */
#define GAP 18u       /* between panels */
#define HEADING 46u   /* height of the heading */
#define CAPTION 62u   /* height below the mesh */
#define INSET 18u     /* of captions within their panel */
#define PADDING 10u   /* of the mesh within its panel */
#define RADIUS 10u

#define PAPER 0xEFEEEAu
#define CARD 0xFBFAF7u

static const font_style heading_style = { 13.5, 2.0, 0x2A3042 };
static const font_style remark_style = { 10, 1.35, 0x6A7080 };
static const font_style main_style = { 10.5, 1.75, 0x2A3042 };
static const font_style detail_style = { 9, 1.25, 0x6A7080 };

/* Draws `left`, and `right` flush right if there is room for both. */
static void draw_line(picture *p, double x, double baseline, double width,
                      const char *left, const font_style *left_style,
                      const char *right, const font_style *right_style)
{
    const double used =
        font_draw_fitted(p, x, baseline, width, left, left_style);
    const double needed = font_width(right, right_style);
    if (used + needed + 2 * right_style->height <= width)
        font_draw(p, x + width - needed, baseline, right, right_style);
}

bool sheet_begin(sheet *out, uint32_t count, uint32_t columns, uint32_t panel,
                 const char *heading, const char *heading_right)
{
    const uint32_t rows = (count + columns - 1) / columns;
    const uint32_t width = 2 * EDGE + columns * panel + (columns - 1) * GAP;
    const uint32_t height = 2 * EDGE + HEADING + rows * (panel + CAPTION) +
                            (rows - 1) * GAP;

    *out = (sheet){ .panel = panel, .columns = columns };
    if (!picture_create(&out->picture, width, height, PAPER))
        return false;
    draw_line(&out->picture, EDGE, EDGE + 16, width - 2 * EDGE, heading,
              &heading_style, heading_right, &remark_style);
    return true;
}

/* A strip of the colours with what its ends stand for, in the upper left. */
static void draw_scale(picture *p, uint32_t x, uint32_t y,
                       const sheet_caption *caption)
{
    enum { LENGTH = 72, THICKNESS = 6 };

    for (uint32_t i = 0; i < LENGTH; i++)
        for (uint32_t j = 0; j < THICKNESS; j++)
            picture_blend(p, x + i, y + j,
                          shade_heat((i + 0.5) / LENGTH), 255);
    font_draw(p, x, y + THICKNESS + 14, caption->blue, &detail_style);
    font_draw(p, x + LENGTH - font_width(caption->red, &detail_style) / 2,
              y + THICKNESS + 14, caption->red, &detail_style);
}

bool sheet_draw(sheet *s, uint32_t index, const asset *mesh,
                const raster_camera *camera, const raster_style *style,
                const sheet_caption *caption)
{
    const uint32_t x = EDGE + index % s->columns * (s->panel + GAP);
    const uint32_t y =
        EDGE + HEADING + index / s->columns * (s->panel + CAPTION + GAP);
    const double text_width = s->panel - 2 * INSET;

    picture_card(&s->picture, x, y, s->panel, s->panel + CAPTION, RADIUS, CARD);
    draw_line(&s->picture, x + INSET, y + s->panel + 20, text_width,
              caption->left, &main_style, caption->right, &main_style);
    draw_line(&s->picture, x + INSET, y + s->panel + 42, text_width,
              caption->left_below, &detail_style, caption->right_below,
              &detail_style);
    const bool drawn = raster_draw(&s->picture, x + PADDING, y + PADDING,
                                   s->panel - 2 * PADDING, mesh, camera, style);
    if (caption->red[0])
        draw_scale(&s->picture, x + INSET, y + INSET, caption);
    return drawn;
}

void sheet_free(sheet *s)
{
    picture_free(&s->picture);
}
