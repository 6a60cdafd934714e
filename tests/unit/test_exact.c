/* SPDX-License-Identifier: MIT */
/* Lossless files: the input's floats come back, bit for bit. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/exact.h"
#include "format/layout.h"
#include "tests/unit/float_faces.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

static float float_of(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static uint32_t bits_of(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* Any float that is finite. */
static float any_float(uint32_t *seed)
{
    for (;;) {
        const uint32_t high = shape_random(seed, 65536);
        const float x = float_of(high << 16 | shape_random(seed, 65536));
        if (isfinite(x))
            return x;
    }
}

/* ---- numbers and their ordinals ------------------------------------------ */

static const pmesh_form forms[] = {
    { false, 1, 0 },  { false, 1, 22 }, { false, 6, 6 },   { false, 6, 9 },
    { false, 9, 0 },  { false, 9, 22 }, { true, 1, 0 },    { true, 1, 149 },
    { true, 11, 24 }, { true, 24, 0 },  { true, 24, 149 },
};
enum { FORMS = sizeof forms / sizeof forms[0] };

TEST(ordinals_count_numbers_upwards)
{
    for (int i = 0; i < FORMS; i++) {
        const pmesh_form *f = &forms[i];
        const int64_t end = pmesh_ordinal_to(f, FLT_MAX);
        CHECK(pmesh_form_legal(f));
        CHECK(pmesh_ordinal_from(f, 0) == -1 && pmesh_ordinal_to(f, 0) == 0);
        CHECK(pmesh_ordinal_from(f, -FLT_MAX) == -1 - end);
        CHECK(pmesh_ordinal_to(f, DBL_MAX) == end);
        uint32_t seed = 3;
        for (int k = 0; k < 3000; k++) {
            const int64_t part = shape_random(&seed, 32768);
            const int64_t o = k < 1000 ? k : end / 32768 * part + k;
            int64_t back;
            if (o >= end)
                continue;
            const float x = pmesh_ordinal_value(f, o);
            CHECK(isfinite(x) && x <= pmesh_ordinal_value(f, o + 1));
            CHECK(pmesh_ordinal_value(f, -1 - o) == -x);
            CHECK(signbit(pmesh_ordinal_value(f, -1 - o)));
            if (pmesh_ordinal_of(f, x, &back)) /* unless finer than floats */
                CHECK(bits_of(pmesh_ordinal_value(f, back)) == bits_of(x));
            if (f->binary)
                CHECK(pmesh_ordinal_of(f, x, &back) && back == o);
        }
    }
}

TEST(bounds_enclose_what_lies_between)
{
    uint32_t seed = 5;
    for (int k = 0; k < 100000; k++) {
        const pmesh_form *f = &forms[k % FORMS];
        const double a = any_float(&seed), b = any_float(&seed);
        const double low = a < b ? a : b, high = a < b ? b : a;
        const int64_t from = pmesh_ordinal_from(f, low);
        const int64_t to = pmesh_ordinal_to(f, high);
        int64_t o;
        if (f->binary && pmesh_ordinal_of(f, (float)low, &o))
            CHECK(from == o);
        if (f->binary && pmesh_ordinal_of(f, (float)high, &o))
            CHECK(to == o);
        CHECK(from <= to + 1);
        CHECK(from == -1 - pmesh_ordinal_to(f, -low) || low == 0);
    }
}

TEST(binary_form_24_149_has_every_float)
{
    const pmesh_form f = { true, 24, 149 };
    static const uint32_t edges[] = { 0,          0x80000000, 1, 0x80000001,
                                      0x007fffff, 0x00800000, 0x7f7fffff,
                                      0xff7fffff };
    uint32_t seed = 1;
    for (uint32_t i = 0; i < 100000; i++) {
        const float x = i < 8 ? float_of(edges[i]) : any_float(&seed);
        int64_t o;
        CHECK(pmesh_ordinal_of(&f, x, &o));
        CHECK(bits_of(pmesh_ordinal_value(&f, o)) == bits_of(x));
    }
}

TEST(decimal_forms_have_what_is_printed)
{
    static const pmesh_form six = { false, 6, 6 }, wide = { false, 6, 22 };
    uint32_t seed = 2;
    int64_t o;
    for (int i = 0; i < 100000; i++) {
        const int m = (int)shape_random(&seed, 1000000);
        CHECK(pmesh_ordinal_of(&six, (float)(m / 1e6), &o) && o == m);
        const float x = (float)(-m / (i & 1 ? 1e19 : 1e-3));
        CHECK(pmesh_ordinal_of(&wide, x, &o));
    }
    CHECK(!pmesh_ordinal_of(&six, 1e-7f, &o));
    CHECK(!pmesh_ordinal_of(&six, 1.000001f, &o));
    CHECK(!pmesh_ordinal_of(&six, FLT_MAX, &o));
}

TEST(illegal_forms_are_known)
{
    static const pmesh_form illegal[] = {
        { false, 0, 3 }, { false, 10, 3 }, { false, 9, 23 },
        { true, 0, 3 },  { true, 25, 3 },  { true, 24, 150 },
    };
    for (int i = 0; i < 6; i++)
        CHECK(!pmesh_form_legal(&illegal[i]));
}

/* ---- whole files --------------------------------------------------------- */

typedef enum style {
    STYLE_DOUBLE,  /* as the shape is made: not even floats */
    STYLE_DECIMAL, /* four decimals, many zeros of both signs */
    STYLE_COARSE,  /* multiples of 1/8: several vertices at one place */
    STYLE_TINY,    /* denormal floats */
    STYLE_HUGE,    /* up to FLT_MAX */
    STYLE_WILD,    /* any bits at all */
    STYLE_COUNT
} style;

static double styled(style how, double x, uint32_t *seed)
{
    switch (how) {
    case STYLE_DECIMAL:
        x = shape_random(seed, 4) ? floor(x * 1e4) / 1e4 : 0.0;
        return x == 0 && shape_random(seed, 2) ? -0.0 : x;
    case STYLE_COARSE:
        return floor(x * 8) / 8;
    case STYLE_TINY:
        return x * 0x1p-140;
    case STYLE_HUGE:
        return x < -1 ? -FLT_MAX : x > 1 ? FLT_MAX : x * FLT_MAX;
    case STYLE_WILD:
        return any_float(seed);
    default:
        return x;
    }
}

static shape_mesh *make(shape_kind kind, style how)
{
    static const uint32_t sizes[SHAPE_COUNT] = { 8, 12, 10, 6, 40, 12 };
    shape_mesh *s = shape_make(kind, sizes[kind], 4);
    uint32_t seed = 9;
    for (size_t i = 0; i < 3 * s->input.vertex_count; i++)
        s->positions[i] = styled(how, s->positions[i], &seed);
    return s;
}

static pmesh_encoder_config lossless(uint8_t bits, pmesh_placement placement)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    config.position_bits = bits;
    config.placement = placement;
    config.base_faces = 12;
    config.lossless = 1;
    return config;
}

static size_t faces_of_input(const pmesh_mesh_input *in, float_face *out)
{
    return float_faces_of(in->positions, in->vertex_count, in->indices,
                          in->face_count, out);
}

static size_t faces_of_view(const pmesh_decoder *dec, float_face *out)
{
    pmesh_view v;
    CHECK(pmesh_decoder_mesh(dec, &v) == PMESH_OK);
    float *xyz = malloc(12 * (size_t)v.vertex_count);
    CHECK(pmesh_decoder_copy_positions(dec, xyz, 0) == PMESH_OK);
    const size_t count = float_faces(xyz, v.indices, v.face_count, out);
    free(xyz);
    return count;
}

static bool comes_back(const shape_mesh *s, pmesh_encoder_config config)
{
    shape_bytes bytes;
    pmesh_encode_report report;
    pmesh_status status = shape_bake(s, &config, &bytes, &report);
    CHECK(status == PMESH_OK);
    pmesh_decoder *dec = shape_decode(bytes.data, bytes.size, 1000, &status);
    CHECK(status == PMESH_OK);
    CHECK(report.bytes == bytes.size && report.bytes_lossless > 0);
    CHECK(pmesh_decoder_refine(dec, NULL, NULL) == PMESH_OK);
    float_face *a = calloc(s->input.face_count, sizeof *a);
    float_face *b = calloc(report.faces, sizeof *b);
    const size_t m = faces_of_input(&s->input, a);
    const size_t n = faces_of_view(dec, b);
    const bool same = m == n && memcmp(a, b, n * sizeof *a) == 0;
    pmesh_header h;
    pmesh_decoder_header(dec, &h);
    CHECK(h.bytes == bytes.size && h.exact_bytes == report.bytes_lossless);
    CHECK(pmesh_decoder_progress(dec).exact_vertices == h.mesh_vertices);
    pmesh_decoder_destroy(dec);
    free(a);
    free(b);
    free(bytes.data);
    return same;
}

TEST(every_bit_of_every_position_comes_back)
{
    static const uint8_t bits[] = { 4, 11, 16, 24 };
    for (int kind = 0; kind < SHAPE_COUNT; kind++)
        for (int how = 0; how < STYLE_COUNT; how++)
            for (int i = 0; i < 4; i++) {
                shape_mesh *s = make((shape_kind)kind, (style)how);
                CHECK(comes_back(s, lossless(bits[i], (pmesh_placement)
                                                          ((i ^ how) & 1))));
                shape_free(s);
            }
}

TEST(zeros_of_different_sign_are_kept_apart_or_welded)
{
    static const double xyz[] = { 0, 0, 0,  1, 0, 0,  0, 1, 0,
                                  -0.0, 0, 0,  1, -0.0, 0,  1, 1, 0 };
    static const uint32_t tri[] = { 0, 1, 2, 3, 2, 5 };
    const shape_mesh s = { .input = { .positions = xyz, .vertex_count = 6,
                                      .indices = tri, .face_count = 2 } };
    for (int weld = 0; weld < 2; weld++) {
        pmesh_encoder_config config = lossless(8, PMESH_SUBSET);
        shape_bytes bytes;
        pmesh_encode_report report;
        config.weld = weld ? 1e-30 : 0;
        CHECK(shape_bake(&s, &config, &bytes, &report) == PMESH_OK);
        CHECK(report.welded_vertices == (weld ? 1 : 0));
        CHECK(report.zero_twins == (weld ? 0 : 1));
        free(bytes.data);
        CHECK(weld || comes_back(&s, config));
    }
    pmesh_encoder_config config = lossless(8, PMESH_SUBSET);
    shape_bytes bytes;
    pmesh_encode_report report;
    config.lossless = 0;
    CHECK(shape_bake(&s, &config, &bytes, &report) == PMESH_OK);
    CHECK(report.vertices == 4 && report.zero_twins == 0);
    free(bytes.data);
}

TEST(doubles_that_no_float_reaches_are_not_finite)
{
    double xyz[] = { 0, 0, 0,  1, 0, 0,  0, 1, 0,  0, 0, 1e39 };
    static const uint32_t tri[] = { 0, 1, 2, 0, 1, 3 };
    const shape_mesh s = { .input = { .positions = xyz, .vertex_count = 4,
                                      .indices = tri, .face_count = 2 } };
    const pmesh_encoder_config config = lossless(8, PMESH_SUBSET);
    shape_bytes bytes;
    pmesh_encode_report report;
    CHECK(shape_bake(&s, &config, &bytes, &report) == PMESH_OK);
    CHECK(report.not_finite_faces == 1 && report.faces == 1);
    free(bytes.data);
}

/* ---- parts of files ------------------------------------------------------ */

typedef struct baked {
    shape_mesh *shape;
    shape_bytes bytes;
    pmesh_encode_report report;
    pmesh_decoder *whole;
} baked;

static baked bake(shape_kind kind, pmesh_placement placement)
{
    baked b;
    const pmesh_encoder_config config = lossless(7, placement);
    pmesh_status status;
    b.shape = make(kind, STYLE_DOUBLE);
    CHECK(shape_bake(b.shape, &config, &b.bytes, &b.report) == PMESH_OK);
    b.whole = shape_decode(b.bytes.data, b.bytes.size, b.bytes.size, &status);
    CHECK(status == PMESH_OK);
    return b;
}

static void baked_free(baked *b)
{
    pmesh_decoder_destroy(b->whole);
    shape_free(b->shape);
    free(b->bytes.data);
}

/* The positions of all mesh vertices that are visible. */
static float *mesh_positions(const pmesh_decoder *dec, pmesh_view *v)
{
    CHECK(pmesh_decoder_mesh(dec, v) == PMESH_OK);
    float *of = calloc(v->mesh_vertex_count, 12);
    float *xyz = calloc(v->vertex_count, 12);
    pmesh_decoder_copy_positions(dec, xyz, 0);
    for (uint32_t i = 0; i < v->vertex_count; i++)
        memcpy(of + 3 * (v->positions_of ? v->positions_of[i] : i),
               xyz + 3 * i, 12);
    free(xyz);
    return of;
}

/* On the grid, or exact as far as that has come. */
static bool is_as_promised(const pmesh_decoder *dec, const float *exact,
                           const int32_t *rest)
{
    pmesh_header h;
    pmesh_view v;
    float *xyz = mesh_positions(dec, &v);
    const uint32_t known = pmesh_decoder_progress(dec).exact_vertices;
    bool good = true;
    pmesh_decoder_header(dec, &h);
    for (uint32_t i = 0; i < v.mesh_vertex_count; i++) {
        const int32_t *q = v.positions + 3 * i;
        const bool rests = memcmp(q, rest + 3 * i, 12) == 0;
        CHECK(rests || h.placement == PMESH_OPTIMAL);
        for (int k = 0; k < 3; k++) {
            const float grid = (float)(h.grid.origin[k] + h.grid.step * q[k]);
            const float want =
                i < known && rests ? exact[3 * i + (uint32_t)k] : grid;
            good = good && bits_of(xyz[3 * i + (uint32_t)k]) == bits_of(want);
        }
    }
    free(xyz);
    return good;
}

TEST(exact_positions_arrive_after_all_else_and_hold_at_every_budget)
{
    for (int placement = 0; placement < 2; placement++) {
        baked b = bake(SHAPE_SPHERE, (pmesh_placement)placement);
        pmesh_view v;
        pmesh_decoder_refine(b.whole, NULL, NULL);
        float *exact = mesh_positions(b.whole, &v);
        int32_t *rest = malloc(12 * (size_t)v.mesh_vertex_count);
        memcpy(rest, v.positions, 12 * (size_t)v.mesh_vertex_count);
        for (uint32_t faces = 1; faces < b.report.faces; faces += 7) {
            const pmesh_target target = { .faces = faces };
            pmesh_decoder_refine(b.whole, &target, NULL);
            CHECK(is_as_promised(b.whole, exact, rest));
        }
        uint32_t partly = 0;
        for (size_t size = b.bytes.size - b.report.bytes_lossless - 6;
             size < b.bytes.size; size++) {
            pmesh_status status;
            pmesh_decoder *dec =
                shape_decode(b.bytes.data, size, size, &status);
            const pmesh_progress_state p = pmesh_decoder_progress(dec);
            CHECK(status == PMESH_NEED_DATA && p.faces == b.report.faces);
            CHECK(p.exact_vertices >= partly);
            partly = p.exact_vertices;
            pmesh_decoder_refine(dec, NULL, NULL);
            CHECK(is_as_promised(dec, exact, rest));
            pmesh_decoder_destroy(dec);
        }
        CHECK(partly == b.report.vertices);
        free(rest);
        free(exact);
        baked_free(&b);
    }
}

TEST(a_large_layer_comes_in_chunks_of_64_kib)
{
    shape_mesh *s = shape_make(SHAPE_TORUS, 110, 1);
    const pmesh_encoder_config config = lossless(7, PMESH_SUBSET);
    shape_bytes bytes;
    pmesh_encode_report report;
    CHECK(shape_bake(s, &config, &bytes, &report) == PMESH_OK);
    CHECK(report.bytes_lossless > 65536);
    pmesh_status status;
    const size_t before = bytes.size - (size_t)report.bytes_lossless;
    pmesh_decoder *dec =
        shape_decode(bytes.data, before + 65536 + 64, 999, &status);
    const uint32_t some = pmesh_decoder_progress(dec).exact_vertices;
    CHECK(status == PMESH_NEED_DATA && some > 0 && some < report.vertices);
    pmesh_decoder_destroy(dec);
    CHECK(comes_back(s, config));
    free(bytes.data);
    shape_free(s);
}

TEST(memory_grows_by_12_bytes_a_vertex_and_a_table)
{
    uint64_t memory[2];
    uint32_t vertices = 0;
    for (int i = 0; i < 2; i++) {
        shape_mesh *s = make(SHAPE_TORUS, STYLE_DECIMAL);
        pmesh_encoder_config config = lossless(10, PMESH_SUBSET);
        config.lossless = i;
        config.weld = 1e-9;
        shape_bytes bytes;
        pmesh_encode_report report;
        pmesh_status status;
        pmesh_header h;
        CHECK(shape_bake(s, &config, &bytes, &report) == PMESH_OK);
        pmesh_decoder *dec =
            shape_decode(bytes.data, bytes.size, bytes.size, &status);
        CHECK(pmesh_decoder_header(dec, &h) == PMESH_OK);
        memory[i] = h.memory - (h.memory & 15);
        vertices = h.mesh_vertices;
        pmesh_decoder_destroy(dec);
        free(bytes.data);
        shape_free(s);
    }
    const uint64_t layers = 12 * PMESH_EXACT_LAYERS;
    CHECK(memory[1] - memory[0] <= 12 * (uint64_t)vertices + layers + 4096);
}

/* Feeds the parts one after the other. */
static pmesh_status feed_parts(const shape_bytes *const file[],
                               const size_t (*part)[2], size_t count)
{
    pmesh_decoder *dec;
    pmesh_status status = PMESH_NEED_DATA;
    CHECK(pmesh_decoder_create(&dec, NULL) == PMESH_OK);
    for (size_t i = 0; i < count; i++)
        status = pmesh_decoder_feed(dec, file[i]->data + part[i][0],
                                    part[i][1] - part[i][0]);
    pmesh_decoder_destroy(dec);
    return status;
}

TEST(the_layer_is_there_once_and_only_where_it_is_declared)
{
    shape_mesh *s = make(SHAPE_TORUS, STYLE_DOUBLE);
    pmesh_encoder_config config = lossless(10, PMESH_SUBSET);
    shape_bytes exact, plain;
    pmesh_encode_report report;
    CHECK(shape_bake(s, &config, &exact, &report) == PMESH_OK);
    config.lossless = 0;
    const size_t end = exact.size - 6;
    const size_t layer = end - (size_t)report.bytes_lossless;
    CHECK(shape_bake(s, &config, &plain, &report) == PMESH_OK);
    const shape_bytes *const one[] = { &exact, &exact, &exact };
    const shape_bytes *const two[] = { &plain, &exact };
    CHECK(feed_parts(one, (const size_t[][2]){ { 0, end },
                                               { end, exact.size } },
                     2) == PMESH_OK);
    CHECK(feed_parts(one, (const size_t[][2]){ { 0, layer },
                                               { end, exact.size } },
                     2) == PMESH_E_CORRUPT);
    CHECK(feed_parts(one, (const size_t[][2]){ { 0, end }, { layer, end } },
                     2) == PMESH_E_CORRUPT);
    CHECK(feed_parts(two, (const size_t[][2]){ { 0, plain.size - 6 },
                                               { layer, end } },
                     2) == PMESH_E_CORRUPT);
    free(exact.data);
    free(plain.data);
    shape_free(s);
}

/* ---- hostile layers ------------------------------------------------------ */

/* Codes `value` as the only coordinate of a one-vertex mesh and reads it. */
static bool survives(float value, pmesh_form form, pmesh_grid grid, float *back)
{
    uint8_t bytes[64];
    int32_t q[1][3] = { { 1, 2, 3 } };
    const pmesh_mesh mesh = { .vertex_count = 1, .position = q };
    const pmesh_form all[3] = { form, form, form };
    const size_t size =
        (size_t)pmesh_exact_bind(NULL, &grid, all, 1, NULL);
    void *block = malloc(size);
    pmesh_exact e;
    pmesh_coder coder;
    pmesh_writer out = { bytes, 0, sizeof bytes, false };

    pmesh_exact_bind(&e, &grid, all, 1, block);
    for (int k = 0; k < 3; k++)
        e.position[0][k] = value;
    pmesh_coder_encode(&coder, &out);
    pmesh_exact_code(&e, &coder, &mesh);
    CHECK(pmesh_coder_finish(&coder));
    pmesh_exact_bind(&e, &grid, all, 1, block);
    pmesh_coder_decode(&coder, bytes, out.size);
    const bool good = pmesh_exact_code(&e, &coder, &mesh);
    *back = e.position[0][0];
    free(block);
    return good;
}

TEST(any_float_fits_any_form_and_grid_but_nan_and_infinity_do_not)
{
    static const pmesh_grid grids[] = {
        { { 0, 0, 0 }, 1, 8 },          { { -5, 1e3, 7 }, 0x1p-1022, 8 },
        { { 1e300, -1e300, 0 }, 1, 8 }, { { -1e308, 0, 1 }, 1e308, 24 },
        { { -2, -2, -2 }, 1e-3, 8 },
    };
    uint32_t seed = 8;
    float back;
    for (int i = 0; i < 20000; i++) {
        const pmesh_grid *grid = &grids[i % 5];
        const pmesh_form *form = &forms[i % FORMS];
        const float near = (float)shape_random(&seed, 5) - 2;
        const float x = i & 1 ? any_float(&seed) : near;
        CHECK(survives(x, *form, *grid, &back));
        CHECK(bits_of(back) == bits_of(x));
    }
    for (int i = 0; i < FORMS; i++) {
        CHECK(!survives(INFINITY, forms[i], grids[0], &back));
        CHECK(!survives(NAN, forms[i], grids[0], &back));
    }
}

TEST(random_bytes_never_decode_to_what_is_not_finite)
{
    const pmesh_grid grid = { { -1, -1, -1 }, 1e-3, 12 };
    int32_t q[64][3];
    const pmesh_mesh mesh = { .vertex_count = 64, .position = q };
    uint32_t seed = 6;
    for (int i = 0; i < 2000; i++) {
        const pmesh_form form = forms[i % FORMS];
        const pmesh_form all[3] = { form, form, form };
        uint8_t *bytes = malloc(200);
        void *block =
            malloc((size_t)pmesh_exact_bind(NULL, &grid, all, 64, NULL));
        pmesh_exact e;
        pmesh_coder coder;
        for (int k = 0; k < 200; k++)
            bytes[k] = (uint8_t)shape_random(&seed, 256);
        for (int k = 0; k < 192; k++)
            q[k / 3][k % 3] = (int32_t)shape_random(&seed, 1 << 12);
        pmesh_exact_bind(&e, &grid, all, 64, block);
        pmesh_coder_decode(&coder, bytes, 200);
        while (e.count < 64 && pmesh_exact_code(&e, &coder, &mesh))
            for (int k = 0; k < 3; k++)
                CHECK(isfinite(e.position[e.count - 1][k]));
        free(block);
        free(bytes);
    }
}
