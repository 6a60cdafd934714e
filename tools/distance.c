/* SPDX-License-Identifier: MIT */
#include "tools/distance.h"

#include <math.h>

#include "tools/farthest.h"
#include "tools/surface.h"

#define DEGREES (180 / 3.14159265358979323846)

/* xorshift64* (Marsaglia, Vigna): the same numbers everywhere. */
typedef struct generator {
    uint64_t state;
} generator;

/* Uniform in [0, 1), 53 bits. */
static double draw(generator *g)
{
    g->state ^= g->state >> 12;
    g->state ^= g->state << 25;
    g->state ^= g->state >> 27;
    return (double)((g->state * 0x2545f4914f6cdd1du) >> 11) * 0x1p-53;
}

/* Twice the area; *normal is the unit normal or zero. */
static double face_normal(const surface *s, size_t face, double normal[3])
{
    const double *p[3];
    double ab[3], ac[3];
    for (size_t k = 0; k < 3; k++)
        p[k] = s->points + 3 * (size_t)s->corners[3 * face + k];
    for (size_t k = 0; k < 3; k++) {
        ab[k] = p[1][k] - p[0][k];
        ac[k] = p[2][k] - p[0][k];
    }
    normal[0] = ab[1] * ac[2] - ab[2] * ac[1];
    normal[1] = ab[2] * ac[0] - ab[0] * ac[2];
    normal[2] = ab[0] * ac[1] - ab[1] * ac[0];
    const double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] +
                               normal[2] * normal[2]);
    for (size_t k = 0; k < 3 && length > 0; k++)
        normal[k] /= length;
    return length;
}

/* A uniform point of a face: sqrt makes the density even. */
static void face_point(const surface *s, size_t face, generator *g, double p[3])
{
    const double r = sqrt(draw(g));
    const double u = draw(g);
    const double weight[3] = { 1 - r, r * (1 - u), r * u };
    for (size_t k = 0; k < 3; k++) {
        p[k] = 0;
        for (size_t c = 0; c < 3; c++) {
            const size_t v = s->corners[3 * face + c];
            p[k] += weight[c] * s->points[3 * v + k];
        }
    }
}

typedef struct sums {
    double distance, distance2, max2, angle2;
} sums;

static void add_sample(const surface *to, const double p[3],
                       const double normal[3], uint32_t *hint, sums *sum)
{
    const double d2 = surface_closest(to, p, hint);
    const double cosine = surface_alignment(to, p, normal, d2);
    const double angle = acos(fmax(-1, fmin(1, cosine)));
    sum->distance += sqrt(d2);
    sum->distance2 += d2;
    sum->max2 = fmax(sum->max2, d2);
    sum->angle2 += angle * angle;
}

/*
 * The area, laid out face by face, is cut into `samples` equal stretches, and
 * a point is drawn in each: big faces get many points, no face too many.
 */
static void project_area(const surface *from, const surface *to, size_t samples,
                         sums *sum)
{
    double normal[3];
    double total = 0;
    for (size_t f = 0; f < from->face_count; f++)
        total += face_normal(from, f, normal);

    generator g = { 0x9e3779b97f4a7c15u };
    uint32_t hint = 0;
    size_t face = 0;
    double end = face_normal(from, 0, normal);
    for (size_t i = 0; i < samples; i++) {
        const double at = ((double)i + draw(&g)) / (double)samples * total;
        while (end <= at && face + 1 < from->face_count)
            end += face_normal(from, ++face, normal);
        double p[3];
        face_point(from, face, &g, p);
        add_sample(to, p, normal, &hint, sum);
    }
}

static bool project(const surface *from, const surface *to, size_t samples,
                    int exponent, distance_stats *out)
{
    sums sum = { 0 };
    project_area(from, to, samples, &sum);
    if (!farthest_from(from, to, 2 * samples, &sum.max2))
        return false;

    const double n = samples > 0 ? (double)samples : 1;
    const double tiny = 1e-14 * to->diagonal;
    double lengths[3] = { sqrt(sum.distance2 / n), sum.distance / n,
                          sqrt(sum.max2) };
    for (size_t k = 0; k < 3; k++)
        lengths[k] = lengths[k] < tiny ? 0 : ldexp(lengths[k], exponent);
    out->rms = lengths[0];
    out->mean = lengths[1];
    out->max = lengths[2];
    out->normal_deg = sqrt(sum.angle2 / n) * DEGREES;
    if (out->normal_deg < 1e-5)
        out->normal_deg = 0;
    return true;
}

static double mean_square(double a, double b)
{
    /* hypot: the squares of large model units would overflow. */
    return hypot(a, b) * sqrt(0.5);
}

bool distance_has_faces(const asset *mesh)
{
    surface_frame frame;
    return surface_frame_of(&mesh, 1, &frame);
}

bool distance_measure(const asset *a, const asset *b, size_t samples,
                      distance_report *out)
{
    const asset *const pair[2] = { a, b };
    surface_frame frame = { 0 };
    surface_frame_of(pair, 2, &frame);

    surface sa = { 0 };
    surface sb = { 0 };
    const int exponent = frame.exponent;
    *out = (distance_report){ .samples = samples };
    const bool ok =
        surface_build(&sa, a, &frame) && surface_build(&sb, b, &frame) &&
        project(&sa, &sb, samples, exponent, &out->a_to_b) &&
        project(&sb, &sa, samples, exponent, &out->b_to_a);
    out->diagonal = ldexp(sa.diagonal, exponent);
    surface_free(&sa);
    surface_free(&sb);

    const distance_stats *ab = &out->a_to_b;
    const distance_stats *ba = &out->b_to_a;
    out->both.rms = mean_square(ab->rms, ba->rms);
    out->both.mean = (ab->mean + ba->mean) / 2;
    out->both.max = fmax(ab->max, ba->max);
    out->both.normal_deg = mean_square(ab->normal_deg, ba->normal_deg);
    return ok;
}
