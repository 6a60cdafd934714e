/* SPDX-License-Identifier: MIT */
#include "format/predict.h"

#include "format/tables.h"

enum {
    FRACTION = 16,
    NORMAL_ONE = 16384,
    WEIGHT_ONE = 65536,
    LEARN_RATE = WEIGHT_ONE / 32,
    LARGEST_WEIGHT = 8 * WEIGHT_ONE
};

uint32_t pmesh_isqrt(uint64_t value)
{
    uint64_t root = 0;
    for (uint64_t bit = (uint64_t)1 << 62; bit; bit >>= 2) {
        if (value >= root + bit) {
            value -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
    }
    return (uint32_t)root;
}

/* The ring of x relative to a base point, in 1/16 steps: |coordinates| below
 * 2^28 for 24-bit grids. */
typedef struct star {
    uint32_t count, face_count;
    bool open;
    int64_t mean[3];
    int64_t point[PMESH_MAX_RING][3];
    /* Relative to the mean and divided by `divisor`, a power of two, so that
     * coordinates are below 2^26; and the cross product of spoke i and i + 1,
     * below 2^54: 48 of them can be added. */
    int64_t divisor;
    int64_t spoke[PMESH_MAX_RING][3];
    int64_t face[PMESH_MAX_RING][3];
} star;

static void star_make(star *s, const pmesh_codec *c, const pmesh_ring *ring,
                      const int32_t base[3])
{
    int64_t sum[3] = { 0, 0, 0 }, largest = 0;
    s->count = ring->count;
    s->face_count = ring->face_count;
    s->open = ring->open;
    for (uint32_t i = 0; i < s->count; i++) {
        const int32_t *p = c->mesh.position[ring->vertex[i]];
        for (int k = 0; k < 3; k++) {
            s->point[i][k] = (int64_t)(p[k] - base[k]) * FRACTION;
            sum[k] += s->point[i][k];
        }
    }
    for (int k = 0; k < 3; k++)
        s->mean[k] = sum[k] / s->count;
    for (uint32_t i = 0; i < s->count; i++)
        for (int k = 0; k < 3; k++) {
            const int64_t d = s->point[i][k] - s->mean[k];
            s->spoke[i][k] = d;
            largest |= d < 0 ? -d : d;
        }
    s->divisor = 1;
    while (largest / s->divisor >= (int64_t)1 << 26)
        s->divisor *= 2;
    for (uint32_t i = 0; i < s->count && s->divisor > 1; i++)
        for (int k = 0; k < 3; k++)
            s->spoke[i][k] /= s->divisor;
}

static void star_faces(star *s)
{
    for (uint32_t i = 0; i < s->face_count; i++) {
        const int64_t *a = s->spoke[i];
        const int64_t *b = s->spoke[i + 1 < s->count ? i + 1 : 0];
        for (int k = 0; k < 3; k++) {
            const int y = k == 2 ? 0 : k + 1, z = k == 0 ? 2 : k - 1;
            s->face[i][k] = a[y] * b[z] - a[z] * b[y];
        }
    }
}

/* Sum of the face normals, scaled to length 16384. */
static void star_normal(const star *s, int32_t normal[3])
{
    int64_t largest = 0, sum[3] = { 0, 0, 0 };
    for (uint32_t i = 0; i < s->face_count; i++)
        for (int k = 0; k < 3; k++)
            sum[k] += s->face[i][k];
    for (int k = 0; k < 3; k++)
        largest |= sum[k] < 0 ? -sum[k] : sum[k];
    int64_t divisor = 1;
    while (largest / divisor >= (int64_t)1 << 30)
        divisor *= 2;
    uint64_t square = 0;
    for (int k = 0; k < 3; k++) {
        sum[k] /= divisor;
        square += (uint64_t)(sum[k] * sum[k]);
    }
    const int64_t length = pmesh_isqrt(square);
    for (int k = 0; k < 3; k++)
        normal[k] = length ? (int32_t)(sum[k] * NORMAL_ONE / length) : 0;
}

/* About the length of v: the largest coordinate and 3/8 of the others. */
static int64_t rough_length(const int64_t v[3])
{
    int64_t largest = 0, sum = 0;
    for (int k = 0; k < 3; k++) {
        const int64_t size = v[k] < 0 ? -v[k] : v[k];
        sum += size;
        if (size > largest)
            largest = size;
    }
    return largest + (sum - largest) * 3 / 8;
}

/* A weighted mean of points: weights below 2^28, coordinates below 2^27. */
typedef struct centroid {
    int64_t sum[3], weight;
} centroid;

static void centroid_add(centroid *c, int64_t weight, const int64_t a[3],
                         const int64_t b[3])
{
    for (int k = 0; k < 3; k++)
        c->sum[k] += weight * (a[k] + b[k]);
    c->weight += weight;
}

/* In 1/16 steps from the ring's mean. */
static void centroid_point(const centroid *c, int64_t part, const star *s,
                           int64_t out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = c->weight ? c->sum[k] / c->weight * s->divisor / part : 0;
}

/* Centres of the ring as polygon, as polyline, and of its spokes by length. */
static void star_centres(const star *s, int64_t area[3], int64_t outline[3],
                         int64_t spokes[3])
{
    static const int64_t zero[3] = { 0, 0, 0 };
    centroid by_area = { { 0 }, 0 }, by_edge = { { 0 }, 0 },
             by_spoke = { { 0 }, 0 };
    int64_t largest = 0, divisor = 1;
    for (uint32_t i = 0; i < s->face_count; i++)
        largest |= rough_length(s->face[i]);
    while (largest / divisor >= (int64_t)1 << 28)
        divisor *= 2;
    for (uint32_t i = 0; i < s->count; i++) {
        const int64_t *a = s->spoke[i];
        centroid_add(&by_spoke, rough_length(a), a, zero);
        if (i >= s->face_count)
            continue;
        const int64_t *b = s->spoke[i + 1 < s->count ? i + 1 : 0];
        const int64_t edge[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };
        centroid_add(&by_area, rough_length(s->face[i]) / divisor, a, b);
        centroid_add(&by_edge, rough_length(edge), a, b);
    }
    centroid_point(&by_area, 3, s, area);
    centroid_point(&by_edge, 2, s, outline);
    centroid_point(&by_spoke, 1, s, spokes);
}

static void star_size(const star *s, const int32_t normal[3],
                      pmesh_prediction *out)
{
    uint64_t square = 0, height = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        int64_t h = 0;
        for (int k = 0; k < 3; k++) {
            const int64_t d = s->point[i][k] - s->mean[k];
            square += (uint64_t)(d * d);
            h += d / FRACTION * normal[k];
        }
        height += (uint64_t)(h < 0 ? -h : h) / (NORMAL_ONE / FRACTION);
    }
    out->size = pmesh_isqrt(square / s->count);
    if (out->size < FRACTION)
        out->size = FRACTION;

    /* Mean height over the mean plane against the size: 2 classes an octave
     * from 1/256 on. */
    const uint64_t mean_height = height / s->count;
    uint8_t rough = 0;
    uint64_t limit = (uint64_t)out->size;
    while (rough < PMESH_ROUGH - 1 && mean_height * 256 >= limit) {
        limit = rough & 1 ? limit / 3 * 4 + 1 : limit * 3 / 2;
        rough++;
    }
    out->rough = rough;
}

/* Mean over the ring of (mean of a member's other neighbours - member): how
 * the surface bends around here. */
static void bend(const pmesh_codec *c, const pmesh_ring *ring, uint32_t x,
                 int64_t out[3])
{
    const pmesh_mesh *m = &c->mesh;
    int64_t sum[3] = { 0, 0, 0 };
    int64_t used = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        const uint32_t y = ring->vertex[i];
        int64_t part[3] = { 0, 0, 0 };
        int64_t count = 0;
        uint32_t h = m->first[y];
        const uint32_t start = h;
        do {
            const uint32_t z = m->vertex[pmesh_next(h)];
            if (z != x) {
                for (int k = 0; k < 3; k++)
                    part[k] += m->position[z][k];
                count++;
            }
            h = pmesh_turn_left(m, h);
        } while (h != PMESH_NONE && h != start && count < PMESH_MAX_RING);
        if (count < 2 || h == PMESH_NONE)
            continue;
        for (int k = 0; k < 3; k++)
            sum[k] += part[k] * FRACTION / count -
                      (int64_t)m->position[y][k] * FRACTION;
        used++;
    }
    for (int k = 0; k < 3; k++)
        out[k] = used ? sum[k] / used : 0;
}

static uint32_t index_of(const pmesh_ring *ring, uint32_t vertex)
{
    uint32_t i = 0;
    while (i + 1 < ring->count && ring->vertex[i] != vertex)
        i++;
    return i;
}

/* The terms of the correction, relative to the ring's mean. */
static void make_terms(const pmesh_codec *c, const star *s,
                       const pmesh_ring *ring, uint32_t x, uint32_t partner,
                       int64_t term[PMESH_PREDICT_TERMS][3])
{
    const uint32_t n = s->count, at = index_of(ring, partner);
    uint32_t a = at + 1 < n ? at + 1 : 0, b = at > 0 ? at - 1 : n - 1;
    if (s->open) { /* the boundary says more than the wings */
        a = 0;
        b = n - 1;
    }
    for (int k = 0; k < 3; k++) {
        term[0][k] = -s->mean[k]; /* the partner is the base point */
        term[1][k] = (s->point[a][k] + s->point[b][k]) / 2 - s->mean[k];
    }
    bend(c, ring, x, term[2]);
    star_centres(s, term[3], term[4], term[5]);
}

/* A ring beyond the bound: splits of its neighbours made it so large. */
static void predict_blindly(const int32_t at[3], pmesh_prediction *out)
{
    *out = (pmesh_prediction){ .size = 64 * FRACTION, .ring_class = 7,
                               .unknown = 2,
                               .irregular = PMESH_IRREGULAR - 1,
                               .rough = PMESH_ROUGH - 1 };
    for (int k = 0; k < 3; k++)
        out->position[k] = (int64_t)at[k] * FRACTION;
}

static uint8_t ring_class(const pmesh_ring *ring)
{
    if (ring->open)
        return PMESH_PREDICT_CLASSES - 1;
    const uint32_t n = ring->count < 3 ? 3 : ring->count;
    return (uint8_t)(n < 10 ? n - 3 : 7);
}

/* The ring's mean and the weighted terms, each weighed along the surface and
 * across it; within the bounds, as every vertex is. */
static void add_terms(pmesh_prediction *p, const int32_t base[3],
                      const int64_t mean[3], const int32_t bounds[3])
{
    int64_t along[3] = { 0, 0, 0 }, across = 0;
    for (int t = 0; t < PMESH_PREDICT_TERMS; t++) {
        const int32_t *w = p->weight[t];
        int64_t height = 0;
        for (int k = 0; k < 3; k++) {
            along[k] += w[0] * p->term[t][k];
            height += p->term[t][k] * p->normal[k];
        }
        p->height[t] = height / NORMAL_ONE;
        across += (w[1] - w[0]) * p->height[t];
    }
    across /= WEIGHT_ONE;
    for (int k = 0; k < 3; k++) {
        const int64_t x = (int64_t)base[k] * FRACTION + mean[k] +
                          along[k] / WEIGHT_ONE +
                          across * p->normal[k] / NORMAL_ONE;
        const int64_t limit = (int64_t)bounds[k] * FRACTION;
        p->position[k] = x < 0 ? 0 : x > limit ? limit : x;
    }
}

/* The contexts: what is known of the ring's members. */
static void classify(const pmesh_codec *c, const pmesh_ring *ring,
                     uint32_t partner, uint32_t provisional,
                     pmesh_prediction *p)
{
    uint32_t unknown = 0, irregular = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        const uint32_t y = ring->vertex[i];
        irregular += c->degree[y] != 6;
        unknown += y >= provisional && y != partner;
    }
    p->ring_class = ring_class(ring);
    p->unknown = (uint8_t)(unknown < 2 ? unknown : 2);
    p->irregular = (uint8_t)(irregular < PMESH_IRREGULAR ? irregular
                                                         : PMESH_IRREGULAR - 1);
}

void pmesh_predict(pmesh_codec *c, pmesh_predict_kind kind, uint32_t x,
                   uint32_t partner, const int32_t partner_position[3],
                   uint32_t provisional, pmesh_prediction *out)
{
    pmesh_ring ring;
    star s;

    if (!pmesh_ring_gather(&c->mesh, x, &ring)) {
        predict_blindly(partner_position, out);
        return;
    }
    star_make(&s, c, &ring, partner_position);
    star_faces(&s);
    star_normal(&s, out->normal);
    star_size(&s, out->normal, out);
    make_terms(c, &s, &ring, x, partner, out->term);

    classify(c, &ring, partner, provisional, out);
    out->weight = c->models.predict[kind][out->ring_class][out->unknown];
    add_terms(out, partner_position, s.mean, c->bounds);
}

static int64_t limited(int64_t value, int64_t limit)
{
    return value < -limit ? -limit : value > limit ? limit : value;
}

/* gain / norm <= 2 in size, as errors are limited to 2 sizes and the norm has
 * at least the size's square: after scaling, products stay below 2^54. */
static void adjust(int32_t *weight, int64_t gain, int64_t norm)
{
    while (norm >= (int64_t)1 << 40) {
        norm /= 4;
        gain /= 4;
    }
    *weight = (int32_t)limited(*weight + gain * LEARN_RATE / norm,
                               LARGEST_WEIGHT);
}

void pmesh_predict_learn(pmesh_prediction *p, const int32_t position[3])
{
    const int64_t size = p->size, square = size * size;
    int64_t error[3], height = 0, norm[2] = { 4 * square, square / 4 };
    if (!p->weight)
        return;
    for (int k = 0; k < 3; k++) {
        error[k] = limited((int64_t)position[k] * FRACTION - p->position[k],
                           2 * size);
        height += error[k] * p->normal[k];
    }
    height /= NORMAL_ONE;
    for (int t = 0; t < PMESH_PREDICT_TERMS; t++) {
        const int64_t h = p->height[t] * p->height[t];
        for (int k = 0; k < 3; k++)
            norm[0] += p->term[t][k] * p->term[t][k];
        norm[0] -= h;
        norm[1] += h;
    }
    for (int t = 0; t < PMESH_PREDICT_TERMS; t++) {
        const int64_t up = height * p->height[t];
        int64_t all = 0;
        for (int k = 0; k < 3; k++)
            all += error[k] * p->term[t][k];
        adjust(&p->weight[t][0], all - up, norm[0]);
        adjust(&p->weight[t][1], up, norm[1]);
    }
}
