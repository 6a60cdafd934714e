/* SPDX-License-Identifier: MIT */
/* Coarse levels, swollen to the volume of the full mesh. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

typedef struct shown {
    pmesh_view view;
    float *plain, *inflated; /* per output vertex */
} shown;

/* At a number of faces; 0: all. */
static shown show(pmesh_decoder *dec, uint32_t faces)
{
    shown s;
    CHECK(pmesh_decoder_refine(dec, &(pmesh_target){ .faces = faces }, NULL) ==
          PMESH_OK);
    CHECK(pmesh_decoder_mesh(dec, &s.view) == PMESH_OK);
    const size_t size = 3 * (size_t)s.view.vertex_count * sizeof(float);
    void *room = malloc(pmesh_decoder_inflate_room(dec)); /* exact, for ASan */
    s.plain = malloc(size);
    s.inflated = malloc(size);
    CHECK(room && s.plain && s.inflated);
    CHECK(pmesh_decoder_copy_positions(dec, s.plain, 0) == PMESH_OK);
    CHECK(pmesh_decoder_copy_inflated(dec, s.inflated, 0, NULL) ==
          PMESH_E_ARGUMENT);
    CHECK(pmesh_decoder_copy_inflated(dec, s.inflated, 0, room) == PMESH_OK);
    free(room);
    return s;
}

static void shown_free(shown *s)
{
    free(s->plain);
    free(s->inflated);
}

static double volume(const shown *s, const float *xyz)
{
    double sum = 0;
    for (uint32_t f = 0; f < s->view.face_count; f++) {
        const float *p[3];
        for (int i = 0; i < 3; i++)
            p[i] = xyz + 3 * (size_t)s->view.indices[3 * f + (uint32_t)i];
        for (int k = 0; k < 3; k++) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            sum += (double)p[0][k] *
                   ((double)p[1][a] * (double)p[2][b] -
                    (double)p[1][b] * (double)p[2][a]) / 6;
        }
    }
    return sum;
}

static pmesh_decoder *baked(shape_mesh *shape, pmesh_header *header)
{
    const pmesh_encoder_config config = pmesh_encoder_config_default();
    shape_bytes file = { 0 };
    pmesh_encode_report report;
    pmesh_status status;
    CHECK(shape_bake(shape, &config, &file, &report) == PMESH_OK);
    pmesh_decoder *dec = shape_decode(file.data, file.size, 1000, &status);
    CHECK(dec && status == PMESH_OK);
    CHECK(pmesh_decoder_header(dec, header) == PMESH_OK);
    free(file.data);
    shape_free(shape);
    return dec;
}

TEST(inflated_levels_come_closer_to_the_volume)
{
    static const shape_kind kinds[] = { SHAPE_SPHERE, SHAPE_FACETS };
    for (int i = 0; i < 2; i++) {
        pmesh_header header;
        pmesh_decoder *dec = baked(shape_make(kinds[i], 40, 3), &header);
        shown full = show(dec, 0);
        const double whole = volume(&full, full.plain);
        CHECK(header.levels[0].inflation > 0);
        for (uint32_t share = 2; share <= 8; share *= 2) {
            shown s = show(dec, header.faces / share);
            const double missing = whole - volume(&s, s.plain);
            const double left = whole - volume(&s, s.inflated);
            CHECK(missing * whole > 0);
            CHECK(fabs(left) < 0.5 * fabs(missing));
            shown_free(&s);
        }
        shown_free(&full);
        pmesh_decoder_destroy(dec);
    }
}

TEST(full_detail_is_not_inflated)
{
    pmesh_header header;
    pmesh_decoder *dec = baked(shape_make(SHAPE_FACETS, 20, 3), &header);
    CHECK(header.levels[header.level_count - 1].inflation == 0);
    shown s = show(dec, 0);
    CHECK(!memcmp(s.plain, s.inflated,
                  3 * (size_t)s.view.vertex_count * sizeof *s.plain));
    shown_free(&s);
    pmesh_decoder_destroy(dec);
}

/* Vertices of one place move as one, and those of edges with one face stay. */
TEST(inflation_opens_no_seam_and_moves_no_boundary)
{
    pmesh_header header;
    pmesh_decoder *dec = baked(shape_make(SHAPE_TERRAIN, 40, 3), &header);
    shown s = show(dec, header.faces / 6);
    const uint32_t *of = s.view.positions_of;
    uint32_t moved = 0;
    for (uint32_t i = 0; i < s.view.vertex_count; i++) {
        const uint32_t v = of ? of[i] : i;
        const int32_t *q = s.view.positions + 3 * (size_t)v;
        const bool same = !memcmp(&s.plain[3 * (size_t)i],
                                  &s.inflated[3 * (size_t)i], 12);
        moved += !same;
        CHECK(same || (q[0] > 0 && q[0] < header.bounds[0] && q[1] > 0 &&
                       q[1] < header.bounds[1]));
    }
    for (uint32_t i = 0; of && i < s.view.vertex_count; i++)
        for (uint32_t k = 0; k < i; k++)
            CHECK(of[i] != of[k] || !memcmp(&s.inflated[3 * (size_t)i],
                                            &s.inflated[3 * (size_t)k], 12));
    CHECK(header.levels[0].inflation == 0 || moved > 0);
    shown_free(&s);
    pmesh_decoder_destroy(dec);
}
