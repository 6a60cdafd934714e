/* SPDX-License-Identifier: MIT */
/* How attributes are coded: SPEC 6.6. */
#include <stdlib.h>
#include <string.h>

#include "format/octant.h"
#include "format/quantize.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

static pmesh_attribute normal_of(uint8_t bits)
{
    return (pmesh_attribute){ .kind = PMESH_NORMAL, .components = 3,
                              .bits = bits };
}

TEST(codes_of_normals_mirrored_twice_are_the_same)
{
    for (uint8_t bits = 4; bits <= 9; bits++) {
        const pmesh_attribute a = normal_of(bits);
        const int32_t centre = (1 << (bits - 1)) - 1;
        for (int i = 0; i < 20000; i++) {
            const float v[3] = { (float)(i % 27 - 13), (float)(i / 27 % 27 - 13),
                                 (float)(i / 729 - 13) };
            uint16_t code[2];
            float back[3], mirrored[3];
            pmesh_attribute_quantize(&a, v, code);
            int32_t seen[2] = { code[0], code[1] };
            pmesh_octant_mirror(centre, seen);
            const uint16_t other[2] = { (uint16_t)seen[0], (uint16_t)seen[1] };
            pmesh_attribute_dequantize(&a, code, back);
            pmesh_attribute_dequantize(&a, other, mirrored);
            CHECK(back[0] == mirrored[0] && back[1] == mirrored[1] &&
                  back[2] == -mirrored[2]);
            pmesh_octant_mirror(centre, seen);
            CHECK(seen[0] == code[0] && seen[1] == code[1]);
        }
    }
}

TEST(the_code_of_a_surface_is_that_of_its_normal)
{
    const pmesh_attribute a = normal_of(10);
    const int32_t centre = 511;
    uint32_t seed = 1;
    for (int i = 0; i < 20000; i++) {
        int64_t v[3];
        for (int k = 0; k < 3; k++)
            v[k] = ((int64_t)shape_random(&seed, 20001) - 10000) *
                   ((int64_t)1 << i % 40);
        const float f[3] = { (float)v[0], (float)v[1], (float)v[2] };
        for (int mirrored = 0; mirrored < 2; mirrored++) {
            uint16_t code[2];
            int64_t folded[2];
            pmesh_attribute_quantize(&a, f, code);
            int32_t seen[2] = { code[0], code[1] };
            if (mirrored)
                pmesh_octant_mirror(centre, seen);
            pmesh_octant_fold(v, centre, 16, mirrored, folded);
            /* Apart from the edges, which are two codes each. */
            for (int k = 0; k < 2; k++)
                CHECK(llabs(folded[k] - 16 * seen[k]) <= 18 ||
                      llabs(folded[0] - 16 * centre) > 15 * centre ||
                      llabs(folded[1] - 16 * centre) > 15 * centre);
        }
    }
    const int64_t nothing[3] = { 0, 0, 0 };
    int64_t folded[2];
    pmesh_octant_fold(nothing, centre, 16, true, folded);
    CHECK(folded[0] == 16 * centre && folded[1] == 16 * centre);
}

static uint64_t bytes_of(const pmesh_encode_report *r)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < r->attribute_count; i++)
        sum += r->attributes[i].bytes;
    return sum;
}

static void bake(const shape_mesh *shape, shape_bytes *bytes,
                 pmesh_encode_report *report)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    config.position_bits = 12;
    config.texcoord_bits = 10;
    config.base_faces = 100;
    CHECK(shape_bake(shape, &config, bytes, report) == PMESH_OK);
}

/* A terrain whose texture coordinates are a map of the ground. */
static void bake_map(float bend, pmesh_encode_report *report)
{
    shape_mesh *shape = shape_make(SHAPE_TERRAIN, 60, 7);
    const size_t n = shape->input.vertex_count;
    float *uv = malloc(2 * n * sizeof *uv);
    shape_bytes bytes;
    for (size_t i = 0; i < n; i++) {
        const float x = (float)shape->positions[3 * i];
        const float y = (float)shape->positions[3 * i + 1];
        uv[2 * i] = 0.5f * x - 0.2f * y + bend * x * x;
        uv[2 * i + 1] = 0.3f * x + 0.6f * y + bend * x * y;
    }
    const pmesh_attribute_input map = {
        .kind = PMESH_TEXCOORD, .components = 2, .values = uv, .count = n
    };
    shape->input.attributes = &map;
    shape->input.attribute_count = 1;
    bake(shape, &bytes, report);
    CHECK(report->attribute_count == 1 &&
          report->attributes[0].kind == PMESH_TEXCOORD);
    free(bytes.data);
    free(uv);
    shape_free(shape);
}

TEST(texture_coordinates_that_follow_positions_are_cheap)
{
    pmesh_encode_report flat, bent;
    bake_map(0, &flat);
    bake_map(0.2f, &bent);
    CHECK(8 * bytes_of(&flat) < 6 * (uint64_t)flat.wedges);
    CHECK(8 * bytes_of(&bent) < 6 * (uint64_t)bent.wedges);
}

TEST(the_report_says_what_each_attribute_takes)
{
    shape_mesh *shape = shape_make(SHAPE_SPHERE, 40, 2);
    pmesh_encode_report report;
    shape_bytes bytes;
    bake(shape, &bytes, &report);
    CHECK(report.attribute_count == shape->input.attribute_count);
    for (uint32_t i = 0; i < report.attribute_count; i++)
        CHECK(report.attributes[i].kind == shape->attributes[i].kind &&
              report.attributes[i].bytes > 0);
    /* What the blocks' values take, and a part of the base. */
    CHECK(bytes_of(&report) + 8 > report.bytes_attributes &&
          bytes_of(&report) < report.bytes_attributes + report.bytes_base);
    free(bytes.data);
    shape_free(shape);
}

typedef struct row {
    float value[16];
} row;

static int by_bytes(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(row));
}

/* Positions and attributes of all output vertices differ in something. */
static bool all_differ(const pmesh_decoder *dec, const pmesh_header *h)
{
    pmesh_view view;
    pmesh_decoder_mesh(dec, &view);
    row *rows = calloc(view.vertex_count, sizeof *rows);
    uint32_t at = 3;
    pmesh_decoder_copy_positions(dec, rows[0].value, sizeof *rows);
    for (uint32_t i = 0; i < h->attribute_count; i++) {
        pmesh_decoder_copy_attribute(dec, i, rows[0].value + at, sizeof *rows);
        at += h->attributes[i].components;
    }
    qsort(rows, view.vertex_count, sizeof *rows, by_bytes);
    bool differ = true;
    for (uint32_t i = 1; i < view.vertex_count; i++)
        differ = differ && by_bytes(rows + i - 1, rows + i) != 0;
    free(rows);
    return differ;
}

TEST(no_wedge_is_made_twice)
{
    static const shape_kind kinds[] = { SHAPE_SPHERE, SHAPE_FACETS };
    for (int i = 0; i < 2; i++) {
        shape_mesh *shape = shape_make(kinds[i], 30, 5);
        pmesh_encode_report report;
        pmesh_header header;
        pmesh_status status;
        shape_bytes bytes;
        bake(shape, &bytes, &report);
        pmesh_decoder *dec =
            shape_decode(bytes.data, bytes.size, bytes.size, &status);
        CHECK(status == PMESH_OK);
        pmesh_decoder_header(dec, &header);
        pmesh_decoder_refine(dec, NULL, NULL);
        CHECK(all_differ(dec, &header));
        pmesh_decoder_destroy(dec);
        free(bytes.data);
        shape_free(shape);
    }
}
