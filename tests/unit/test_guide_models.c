/* SPDX-License-Identifier: MIT */
/*
 * What guide files promise, on real models: those of PMESH_MODELS, or
 * ../shared/models; no models, nothing to test.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_guide_pull.h"
#include "encoder/enc_schedule.h"
#include "encoder/enc_surface.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"
#include "tools/guide.h"
#include "tools/load.h"
#include "tools/surface.h"

typedef struct model {
    asset mesh;
    guide guide;
    pmesh_mesh_input input;
    pmesh_encoder_config config;
    double *area; /* around each vertex */
    double diagonal;
} model;

static void measure_mesh(model *m)
{
    double low[3] = { HUGE_VAL, HUGE_VAL, HUGE_VAL };
    double high[3] = { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL }, sum = 0;

    m->area = calloc(m->mesh.vertex_count, sizeof *m->area);
    for (size_t f = 0; f < m->mesh.face_count; f++) {
        const uint32_t *v = &m->mesh.indices[3 * f];
        const double *p = &m->mesh.positions[3 * (size_t)v[0]];
        const double *q = &m->mesh.positions[3 * (size_t)v[1]];
        const double *r = &m->mesh.positions[3 * (size_t)v[2]];
        double square = 0;
        for (int k = 0; k < 3; k++) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            const double n = (q[i] - p[i]) * (r[j] - p[j]) -
                             (q[j] - p[j]) * (r[i] - p[i]);
            square += n * n;
        }
        for (int k = 0; k < 3; k++)
            m->area[v[k]] += sqrt(square);
    }
    for (size_t i = 0; i < 3 * m->mesh.vertex_count; i++) {
        low[i % 3] = fmin(low[i % 3], m->mesh.positions[i]);
        high[i % 3] = fmax(high[i % 3], m->mesh.positions[i]);
    }
    for (int k = 0; k < 3; k++)
        sum += (high[k] - low[k]) * (high[k] - low[k]);
    m->diagonal = sqrt(sum);
}

/* False if the model is not there. `text`: NULL or the name of a guide file. */
static bool model_load(model *m, const char *name, const char *text)
{
    const char *folder = getenv("PMESH_MODELS");
    char path[4096];
    asset_error error;
    file_data data;

    snprintf(path, sizeof path, "%s/%s", folder ? folder : "../shared/models",
             name);
    if (load_mesh(path, &m->mesh, &error) != 0)
        return false;
    m->input = (pmesh_mesh_input){ .positions = m->mesh.positions,
                                   .vertex_count = m->mesh.vertex_count,
                                   .indices = m->mesh.indices,
                                   .face_count = m->mesh.face_count };
    m->config = pmesh_encoder_config_default();
    CHECK(guide_create(&m->guide));
    if (text) {
        CHECK(file_read(text, 1 << 20, &data, &error));
        CHECK(guide_read(&m->guide, data.bytes, data.size, &m->mesh, &error));
        file_free(&data);
    }
    measure_mesh(m);
    return true;
}

static void model_free(model *m)
{
    free(m->area);
    guide_free(&m->guide);
    asset_free(&m->mesh);
}

/* ---- error by region ----------------------------------------------------- */

/* The level with at most so many faces. */
static asset level_of(model *m, bool guided, uint32_t faces)
{
    const shape_mesh shape = { .input = m->input };
    const pmesh_target target = { .faces = faces };
    pmesh_encode_report report;
    pmesh_status status;
    shape_bytes bytes;
    asset_error error;
    asset level;

    m->config.guide = guided ? &m->guide.use : NULL;
    CHECK(shape_bake(&shape, &m->config, &bytes, &report) == PMESH_OK);
    pmesh_decoder *dec =
        shape_decode(bytes.data, bytes.size, bytes.size, &status);
    CHECK(status == PMESH_OK);
    pmesh_decoder_refine(dec, &target, NULL);
    CHECK(asset_from_decoder(dec, &level, &error));
    pmesh_decoder_destroy(dec);
    free(bytes.data);
    return level;
}

/* Mean distance of the surface around its vertices from the level; of all, and
 * of those that weigh more than 0.75. */
static void measure(const model *m, asset level, double mean[2])
{
    const asset *both[2] = { &m->mesh, &level };
    double sum[2] = { 0, 0 }, area[2] = { 0, 0 };
    surface_frame frame;
    surface s;
    uint32_t hint = 0;

    CHECK(surface_frame_of(both, 2, &frame));
    CHECK(surface_build(&s, &level, &frame));
    for (size_t v = 0; v < m->mesh.vertex_count; v++) {
        double p[3];
        for (size_t k = 0; k < 3; k++)
            p[k] = ldexp(m->mesh.positions[3 * v + k] - frame.center[k],
                         -frame.exponent);
        const double d = sqrt(surface_closest(&s, p, &hint));
        for (int r = 0; r < 1 + (m->guide.use.weights[v] > 0.75f); r++) {
            sum[r] += d * m->area[v];
            area[r] += m->area[v];
        }
    }
    for (int r = 0; r < 2; r++)
        mean[r] = sum[r] / area[r];
    surface_free(&s);
    asset_free(&level);
}

/* Kho and Garland, figure 6. */
TEST(guided_error_moves_out_of_the_painted_region)
{
    static const char *const cases[][2] = {
        { "cow.obj", "tests/guide/cow.guide.json" },
        { "spot.obj", "tests/guide/spot.guide.json" }
    };
    for (int i = 0; i < 2; i++) {
        double plain[2], guided[2];
        model m;
        if (!model_load(&m, cases[i][0], cases[i][1]))
            continue;
        measure(&m, level_of(&m, false, 1500), plain);
        measure(&m, level_of(&m, true, 1500), guided);
        if (getenv("PMESH_FIGURES"))
            printf("%s: mean %.3f, region %.3f of unguided\n", cases[i][0],
                   guided[0] / plain[0], guided[1] / plain[1]);
        CHECK(guided[0] <= 1.1 * plain[0]);
        CHECK(guided[1] <= 0.5 * plain[1]);
        model_free(&m);
    }
}

/* ---- constraints --------------------------------------------------------- */

typedef struct run {
    enc_mesh mesh;
    enc_schedule schedule;
    uint32_t count; /* of contractions in the level looked at */
} run;

/* The level with at most so many faces, counted by those that have ended. */
static void run_to(model *m, bool guided, uint32_t faces, run *r)
{
    pmesh_encode_report report = { 0 };
    uint32_t *ended;

    m->config.guide = guided ? &m->guide.use : NULL;
    CHECK(enc_mesh_import(&m->input, &m->config, NULL, &r->mesh, &report) ==
          PMESH_OK);
    CHECK(enc_schedule_build(&r->mesh, &m->config, 0, &r->schedule) ==
          PMESH_OK);
    ended = calloc(r->schedule.contraction_count + 1, sizeof *ended);
    for (uint32_t f = 0; f < r->mesh.face_count; f++)
        if (r->schedule.face_end[f] != ENC_NONE)
            ended[r->schedule.face_end[f]]++;
    uint32_t left = r->mesh.face_count;
    for (r->count = 0;
         left > faces && r->count < r->schedule.contraction_count;)
        left -= ended[r->count++];
    free(ended);
}

static void run_free(run *r)
{
    enc_schedule_destroy(&r->schedule);
    enc_mesh_destroy(&r->mesh);
}

/* Where the vertex is that input vertex v has become, in model units. The
 * models have neither unused nor welded vertices before it, but for the cow's
 * last ones. */
static void place_of(const run *r, uint32_t v, double out[3])
{
    const enc_schedule *s = &r->schedule;
    const int32_t *at;

    while (s->vertex_end[v] < r->count)
        v = s->contraction[s->vertex_end[v]].parent;
    at = s->position[v];
    for (uint32_t i = r->count; i < s->contraction_count; i++)
        if (s->contraction[i].parent == v) {
            at = s->contraction[i].before;
            break;
        }
    for (int k = 0; k < 3; k++)
        out[k] = r->mesh.grid.origin[k] + at[k] * r->mesh.grid.step;
}

/* The largest distance of what became of them from the plane that fits them. */
static double plane_distance(const model *m, const run *r,
                             const pmesh_constraint *c)
{
    double mean[3] = { 0 }, sum[6] = { 0 }, n[3], worst = 0;
    static const int row[] = { 0, 0, 0, 1, 1, 2 }, col[] = { 0, 1, 2, 1, 2, 2 };

    for (size_t i = 0; i < c->vertex_count; i++)
        for (size_t k = 0; k < 3; k++)
            mean[k] += m->mesh.positions[3 * (size_t)c->vertices[i] + k] /
                       (double)c->vertex_count;
    for (size_t i = 0; i < c->vertex_count; i++) {
        const double *p = &m->mesh.positions[3 * (size_t)c->vertices[i]];
        for (int k = 0; k < 6; k++)
            sum[k] += (p[row[k]] - mean[row[k]]) * (p[col[k]] - mean[col[k]]);
    }
    enc_pull_fit(sum, n);
    for (size_t i = 0; i < c->vertex_count; i++) {
        double p[3], d = 0;
        place_of(r, c->vertices[i], p);
        for (int k = 0; k < 3; k++)
            d += n[k] * (p[k] - mean[k]);
        worst = fmax(worst, fabs(d));
    }
    return worst;
}

TEST(guided_hooves_stay_on_their_planes)
{
    model m;
    if (!model_load(&m, "cow.obj", "tests/guide/cow.guide.json"))
        return;
    m.config.placement = PMESH_OPTIMAL;
    m.guide.use.weights = NULL;
    CHECK(m.guide.use.constraint_count == 4);
    run plain, guided;
    run_to(&m, false, 500, &plain);
    run_to(&m, true, 500, &guided);
    for (int i = 0; i < 4; i++) {
        const pmesh_constraint *c = &m.guide.use.constraints[i];
        CHECK(c->vertex_count >= 8);
        const double before = plane_distance(&m, &plain, c);
        const double after = plane_distance(&m, &guided, c);
        if (getenv("PMESH_FIGURES"))
            printf("hoof %d: %.2e of the diagonal, unguided %.2e\n", i,
                   after / m.diagonal, before / m.diagonal);
        CHECK(after <= 0.1 * before);
    }
    run_free(&plain);
    run_free(&guided);
    model_free(&m);
}

static double segment_distance(const double p[3], const double a[3],
                               const double b[3])
{
    double dot = 0, square = 0, sum = 0;
    for (int k = 0; k < 3; k++) {
        dot += (b[k] - a[k]) * (p[k] - a[k]);
        square += (b[k] - a[k]) * (b[k] - a[k]);
    }
    const double s = square > 0 ? fmin(1, fmax(0, dot / square)) : 0;
    for (int k = 0; k < 3; k++) {
        const double d = p[k] - a[k] - s * (b[k] - a[k]);
        sum += d * d;
    }
    return sqrt(sum);
}

/* Edges that bend by more than 30 degrees: pairs of vertices. */
static size_t find_creases(const run *r, uint32_t (*out)[2])
{
    const enc_mesh *mesh = &r->mesh;
    enc_surface s;
    size_t count = 0;

    CHECK(enc_surface_create(mesh, &s) == PMESH_OK);
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++) {
        const uint32_t t = mesh->twin[h];
        double m[3], n[3], dot = 0, mm = 0, nn = 0;
        if (t == ENC_NONE || t < h)
            continue;
        enc_surface_normal(&s, h, s.position[s.vertex[h]], m);
        enc_surface_normal(&s, t, s.position[s.vertex[t]], n);
        for (int k = 0; k < 3; k++) {
            dot += m[k] * n[k];
            mm += m[k] * m[k];
            nn += n[k] * n[k];
        }
        if (dot < sqrt(mm * nn) * 0.8660254) {
            out[count][0] = mesh->vertex[h];
            out[count++][1] = mesh->vertex[h % 3 == 2 ? h - 2 : h + 1];
        }
    }
    enc_surface_destroy(&s);
    return count;
}

/* The largest and the mean distance from the creases, of what became of their
 * vertices, in diagonals. */
static void crease_drift(const model *m, const run *r, double out[2])
{
    uint32_t(*crease)[2] = calloc(3 * r->mesh.face_count, sizeof *crease);
    const size_t count = find_creases(r, crease);

    CHECK(count > 100);
    out[0] = out[1] = 0;
    for (size_t i = 0; i < count; i++) {
        double p[3], best = HUGE_VAL;
        place_of(r, crease[i][0], p);
        for (size_t j = 0; j < count; j++)
            best = fmin(best, segment_distance(
                p, &m->mesh.positions[3 * (size_t)crease[j][0]],
                &m->mesh.positions[3 * (size_t)crease[j][1]]));
        out[0] = fmax(out[0], best / m->diagonal);
        out[1] += best / m->diagonal / (double)count;
    }
    free(crease);
}

TEST(guided_creases_stay_on_their_lines_to_the_base)
{
    for (int placement = 0; placement < 2; placement++) {
        double plain[2], guided[2];
        run r;
        model m;
        if (!model_load(&m, "fandisk.obj", NULL))
            return;
        m.config.placement = (pmesh_placement)placement;
        run_to(&m, false, 0, &r);
        crease_drift(&m, &r, plain);
        run_free(&r);
        m.guide.use.crease = 30;
        run_to(&m, true, 0, &r);
        crease_drift(&m, &r, guided);
        run_free(&r);
        if (getenv("PMESH_FIGURES"))
            printf("creases, placement %d: at most %.2e of the diagonal, mean "
                   "%.2e; unguided %.2e, %.2e\n", placement, guided[0],
                   guided[1], plain[0], plain[1]);
        CHECK(guided[0] <= 1e-3);
        model_free(&m);
    }
}
