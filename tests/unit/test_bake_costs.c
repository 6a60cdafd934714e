/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

/* A file, its report, and a decoder with all of it. */
typedef struct baked {
    shape_bytes bytes;
    pmesh_encode_report report;
    pmesh_decoder *dec;
} baked;

static baked bake(const shape_mesh *shape, const pmesh_encoder_config *config)
{
    baked b;
    pmesh_status status;

    CHECK(shape_bake(shape, config, &b.bytes, &b.report) == PMESH_OK);
    b.dec = shape_decode(b.bytes.data, b.bytes.size, b.bytes.size, &status);
    CHECK(b.dec && status == PMESH_OK);
    return b;
}

static void drop(baked *b)
{
    pmesh_decoder_destroy(b->dec);
    free(b->bytes.data);
}

static bool same_bytes(const baked *a, const baked *b)
{
    return a->bytes.size == b->bytes.size &&
           memcmp(a->bytes.data, b->bytes.data, a->bytes.size) == 0;
}

static pmesh_view show(const baked *b, uint32_t faces)
{
    pmesh_view view;

    CHECK(pmesh_decoder_refine(b->dec, &(pmesh_target){ .faces = faces },
                               NULL) == PMESH_OK);
    CHECK(pmesh_decoder_mesh(b->dec, &view) == PMESH_OK);
    return view;
}

static const int32_t *place(const pmesh_view *view, uint32_t corner)
{
    const uint32_t v = view->indices[corner];
    return &view->positions[3 * (view->positions_of ? view->positions_of[v]
                                                    : v)];
}

/* ---- attributes ---------------------------------------------------------- */

enum { TERRAIN = 40 };

/* Colours in stripes across a field that is nearly flat. */
static shape_mesh *striped(void)
{
    shape_mesh *s = shape_make(SHAPE_TERRAIN, TERRAIN, 1);

    for (size_t v = 0; v < s->input.vertex_count; v++) {
        const double x = s->positions[3 * v];
        s->positions[3 * v + 2] *= 0.2;
        for (int k = 0; k < 3; k++)
            s->values[0][4 * v + (size_t)k] = (int)(x * 5) % 2 ? 1.0f : 0.0f;
    }
    return s;
}

/* The weight of corner k at (x, y), seen from above, times `area`. */
static double share(const pmesh_view *view, uint32_t face, uint32_t k,
                    double x, double y)
{
    const int32_t *p = place(view, 3 * face + (k + 1) % 3);
    const int32_t *q = place(view, 3 * face + (k + 2) % 3);
    return (p[0] - x) * (q[1] - y) - (q[0] - x) * (p[1] - y);
}

/* Root mean square of the difference in red, over vertices of the full mesh
 * that are under a face. */
static double red_error(const baked *b, uint32_t faces)
{
    pmesh_view full = show(b, 0);
    const uint32_t count = full.vertex_count, stride = full.value_stride;
    double *x = malloc(3 * count * sizeof *x), sum = 0;
    size_t found = 0;

    for (uint32_t v = 0; v < count; v++) {
        x[3 * v] = full.positions[3 * v] + 0.25;
        x[3 * v + 1] = full.positions[3 * v + 1] + 0.125;
        x[3 * v + 2] = full.values[v * stride];
    }
    const pmesh_view view = show(b, faces);
    for (uint32_t v = 0; v < count; v++)
        for (uint32_t f = 0; f < view.face_count; f++) {
            double w[3], red = 0;
            for (uint32_t k = 0; k < 3; k++)
                w[k] = share(&view, f, k, x[3 * v], x[3 * v + 1]);
            if (w[0] < 0 || w[1] < 0 || w[2] < 0 || w[0] + w[1] + w[2] <= 0)
                continue;
            for (uint32_t k = 0; k < 3; k++)
                red += w[k] / (w[0] + w[1] + w[2]) *
                       view.values[view.indices[3 * f + k] * stride];
            sum += (red - x[3 * v + 2]) * (red - x[3 * v + 2]);
            found++;
            break;
        }
    free(x);
    CHECK(found > count / 2);
    return sqrt(sum / (double)found) / 255;
}

TEST(bake_keeps_colours_that_have_weight)
{
    shape_mesh *s = striped();
    pmesh_encoder_config config = pmesh_encoder_config_default();

    for (int moving = 0; moving < 2; moving++) {
        double error[2];
        config.placement = moving ? PMESH_OPTIMAL : PMESH_SUBSET;
        for (int k = 0; k < 2; k++) {
            config.color_weight = k ? 0.03 : 0;
            baked b = bake(s, &config);
            error[k] = red_error(&b, 500);
            drop(&b);
        }
CHECK(error[1] < 0.85 * error[0]);
    }
    shape_free(s);
}

TEST(bake_weight_zero_is_as_if_there_was_no_attribute)
{
    shape_mesh *s = striped();
    pmesh_encoder_config config = pmesh_encoder_config_default();

    baked normal = bake(s, &config);
    config.color_weight = 0;
    baked none = bake(s, &config);
    s->attributes[0].weight = 0.03f; /* its own goes before the config's */
    baked own = bake(s, &config);
    config.color_weight = 0.03;
    s->attributes[0].weight = -1;
    baked never = bake(s, &config);
    s->input.attribute_count = 0;
    baked bare = bake(s, &config);

    CHECK(same_bytes(&normal, &own) && same_bytes(&none, &never));
    CHECK(!same_bytes(&normal, &none));
    CHECK(bare.report.level_count == none.report.level_count);
    for (uint32_t k = 0; k < bare.report.level_count; k++)
        CHECK(bare.report.levels[k].faces == none.report.levels[k].faces &&
              bare.report.levels[k].error == none.report.levels[k].error);
    drop(&normal);
    drop(&none);
    drop(&own);
    drop(&never);
    drop(&bare);
    shape_free(s);
}

/* Faces whose texture coordinates, the third and fourth coded value, turn
 * right or have no area; all of the sphere's turn left. */
static uint32_t turned(const pmesh_view *view)
{
    uint32_t count = 0;

    for (uint32_t f = 0; f < view->face_count; f++) {
        int64_t u[3], v[3];
        for (uint32_t k = 0; k < 3; k++) {
            const uint16_t *value =
                &view->values[view->indices[3 * f + k] * view->value_stride];
            u[k] = value[2];
            v[k] = value[3];
        }
        count += (u[1] - u[0]) * (v[2] - v[0]) <=
                 (v[1] - v[0]) * (u[2] - u[0]);
    }
    return count;
}

/* Sides of faces that no other face has the other way round. */
static uint32_t open_edges(const pmesh_view *view)
{
    uint32_t count = 0;

    for (uint32_t c = 0; c < 3 * view->face_count; c++) {
        const uint32_t next = c % 3 == 2 ? c - 2 : c + 1;
        bool found = false;
        for (uint32_t d = 0; d < 3 * view->face_count && !found; d++) {
            const uint32_t after = d % 3 == 2 ? d - 2 : d + 1;
            found = memcmp(place(view, c), place(view, after), 12) == 0 &&
                    memcmp(place(view, next), place(view, d), 12) == 0;
        }
        count += !found;
    }
    return count;
}

TEST(bake_turns_no_texture_coordinates_over)
{
    shape_mesh *s = shape_make(SHAPE_SPHERE, 24, 5);
    pmesh_encoder_config config = pmesh_encoder_config_default();
    uint32_t sum[2] = { 0, 0 };
    uint32_t seed = 1;

    for (size_t i = 0; i < 2 * s->attributes[1].count; i++)
        s->values[1][i] += (float)shape_random(&seed, 100) * 1.2e-4f;
    for (int k = 0; k < 2; k++) {
        config.texcoord_weight = k ? 0.1 : 0;
        config.normal_weight = config.texcoord_weight;
        baked b = bake(s, &config);
        for (uint32_t i = 0; i < b.report.level_count; i++) {
            const pmesh_view view = show(&b, b.report.levels[i].faces);
            sum[k] += turned(&view);
        }
        CHECK(b.report.end == PMESH_END_FACES);
        drop(&b);
    }
CHECK(sum[0] > 0 && sum[1] == 0);
    shape_free(s);
}

TEST(bake_with_weights_opens_no_seam)
{
    shape_mesh *s = shape_make(SHAPE_SPHERE, 12, 2);
    const pmesh_encoder_config config = pmesh_encoder_config_default();

    baked b = bake(s, &config);
    pmesh_view view = show(&b, 0);
    uint32_t last = 0;
    CHECK(open_edges(&view) == 4 * 12); /* two rims */
    for (uint32_t faces = 1; faces < view.face_count; faces += 17) {
        view = show(&b, faces);
        const uint32_t open = open_edges(&view);
        CHECK(open >= 6 && open >= last && open <= 48);
        last = open;
    }
    drop(&b);
    shape_free(s);
}

/* ---- policies ------------------------------------------------------------ */

/* Mean edge of the half with z above the middle, by that below. */
static double high_by_low(const pmesh_view *view)
{
    double sum[2] = { 0, 0 };
    int32_t least = INT32_MAX, most = 0;
    uint32_t count[2] = { 0, 0 };

    for (uint32_t c = 0; c < 3 * view->face_count; c++) {
        const int32_t z = place(view, c)[2];
        least = z < least ? z : least;
        most = z > most ? z : most;
    }
    for (uint32_t c = 0; c < 3 * view->face_count; c++) {
        const int32_t *p = place(view, c);
        const int32_t *q = place(view, c % 3 == 2 ? c - 2 : c + 1);
        const int half = p[2] + q[2] > least + most;
        double square = 0;
        for (int k = 0; k < 3; k++)
            square += (double)(p[k] - q[k]) * (p[k] - q[k]);
        sum[half] += sqrt(square);
        count[half]++;
    }
    return sum[1] / count[1] / (sum[0] / count[0]);
}

TEST(bake_keeps_what_a_camera_is_close_to)
{
    static const pmesh_cost costs[] = { PMESH_COST_CAMERA,
                                        PMESH_COST_QUADRIC_CAMERA };
    shape_mesh *s = shape_make(SHAPE_TORUS, 40, 3);
    pmesh_encoder_config config = pmesh_encoder_config_default();

    for (int k = 0; k < 2; k++)
        for (int side = -1; side <= 1; side += 2) {
            config.cost = costs[k];
            config.camera[2] = 0.9 * side;
            baked b = bake(s, &config);
            const pmesh_view view = show(&b, 600);
            const double ratio = high_by_low(&view);
CHECK(side < 0 ? ratio > 1.1 : ratio < 1 / 1.1);
            drop(&b);
        }
    shape_free(s);
}

static double shortest(const pmesh_view *view)
{
    double least = HUGE_VAL;

    for (uint32_t c = 0; c < 3 * view->face_count; c++) {
        const int32_t *p = place(view, c);
        const int32_t *q = place(view, c % 3 == 2 ? c - 2 : c + 1);
        double square = 0;
        for (int k = 0; k < 3; k++)
            square += (double)(p[k] - q[k]) * (p[k] - q[k]);
        least = square < least ? square : least;
    }
    return sqrt(least);
}

TEST(bake_by_length_takes_short_edges)
{
    shape_mesh *s = shape_make(SHAPE_TORUS, 40, 3);
    pmesh_encoder_config config = pmesh_encoder_config_default();
    double length[2];

    for (int k = 0; k < 2; k++) {
        config.cost = k ? PMESH_COST_LENGTH : PMESH_COST_QUADRIC;
        baked b = bake(s, &config);
        const pmesh_view view = show(&b, 800);
        length[k] = shortest(&view);
        drop(&b);
    }
    CHECK(length[1] > 1.5 * length[0]);
    shape_free(s);
}

/* What the hook is told, against what it should be. */
typedef struct asked {
    const shape_mesh *shape;
    size_t calls;
    bool sound;
} asked;

static double spare_the_left(void *user, const pmesh_simplify_pair *pair)
{
    asked *a = user;

    a->calls++;
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) {
            const double from =
                a->shape->positions[3 * (size_t)pair->vertices[k] + (size_t)i];
            a->sound &= fabs(pair->positions[k][i] - from) < 1e-3;
        }
    a->sound &= pair->quadric >= 0 && pair->distance >= 0;
    return pair->positions[1][0] < 0 ? -1 : pair->quadric;
}

TEST(bake_asks_a_hook_for_costs)
{
    shape_mesh *s = shape_make(SHAPE_TORUS, 30, 4);
    pmesh_encoder_config config = pmesh_encoder_config_default();
    asked a = { s, 0, true };
    uint32_t left = 0, kept = 0;

    config.cost = PMESH_COST_CUSTOM;
    shape_bytes bytes;
    pmesh_encode_report report;
    CHECK(shape_bake(s, &config, &bytes, &report) == PMESH_E_ARGUMENT);
    config.cost_hook = spare_the_left;
    config.cost_user = &a;
    config.base_faces = 10;
    baked b = bake(s, &config);
    CHECK(a.calls > 100 && a.sound && b.report.end == PMESH_END_EXHAUSTED);
    for (size_t v = 0; v < s->input.vertex_count; v++)
        left += s->positions[3 * v] < -1e-3;
    const pmesh_view view = show(&b, 1);
    const double zero = -b.report.grid.origin[0] / b.report.grid.step;
    for (uint32_t v = 0; v < view.mesh_vertex_count; v++)
        kept += view.positions[3 * v] < zero - 1e-3 / b.report.grid.step;
    CHECK(kept == left && view.mesh_vertex_count < 3 * b.report.vertices / 4);
    drop(&b);
    shape_free(s);
}

/* ---- stops --------------------------------------------------------------- */

TEST(bake_says_which_stop_was_first)
{
    shape_mesh *s = shape_make(SHAPE_TORUS, 24, 6);
    pmesh_encoder_config config = pmesh_encoder_config_default();

    config.base_faces = 100;
    baked b = bake(s, &config);
    CHECK(b.report.end == PMESH_END_FACES && b.report.base_faces == 100);
    drop(&b);
    config.base_vertices = 200;
    b = bake(s, &config);
    CHECK(b.report.end == PMESH_END_VERTICES && b.report.base_vertices == 200);
    drop(&b);
    config.base_ratio = 0.5;
    b = bake(s, &config);
    CHECK(b.report.end == PMESH_END_FACES && b.report.base_faces == 24 * 24);
    drop(&b);
    config.base_error = 1e-3;
    b = bake(s, &config);
    CHECK(b.report.end == PMESH_END_ERROR && b.report.base_faces > 24 * 24);
    CHECK((double)b.report.levels[0].error <= 1e-3);
    drop(&b);
    shape_free(s);

    s = shape_make(SHAPE_PIECES, 20, 1);
    config = pmesh_encoder_config_default();
    config.base_faces = 10;
    config.topology = PMESH_TOPOLOGY_KEEP;
    b = bake(s, &config);
    CHECK(b.report.end == PMESH_END_EXHAUSTED && b.report.base_faces == 80);
    drop(&b);
    shape_free(s);
}
