/* SPDX-License-Identifier: MIT */
/* SPEC 6.6: values. */
#include "tests/reference/ref.h"

/* One attribute of wedge w. */
typedef struct subject {
    uint32_t w;
    int attribute, first, count; /* its components */
    bool normal, tangent, mirrored;
    int map, map_normal; /* the attributes that a tangent goes by */
    bool shaped;
    int64_t c, shape[3];
} subject;

typedef struct neighbours {
    int n;
    uint32_t wedge[48];
    int64_t close[48], affine[48];
} neighbours;

static int64_t absolute(int64_t a)
{
    return a < 0 ? -a : a;
}

static int64_t largest(const ref *r, int component)
{
    return (1 << r->header.value_bits[component]) - 1;
}

/* The i-th lower wedge of w's vertex, or NONE. */
static uint32_t lower_wedge(const ref *r, uint32_t w, int i)
{
    for (uint32_t x = w; x-- > 0;)
        if (r->wedge[x].vertex == r->wedge[w].vertex && i-- == 0)
            return x;
    return REF_NONE;
}

/* ---- neighbours --------------------------------------------------------- */

static void list(neighbours *a, uint32_t w, uint32_t x)
{
    if (x >= w || a->n == 48)
        return;
    if (a->n > 0 && (x == a->wedge[0] || x == a->wedge[a->n - 1]))
        return;
    a->wedge[a->n++] = x;
}

static void list_all(const ref *r, uint32_t w, neighbours *a)
{
    const uint32_t first = r->wedge[w].corner;
    uint32_t h = first;
    a->n = 0;
    do {
        list(a, w, r->edge[ref_next(h)].wedge);
        list(a, w, r->edge[ref_prev(h)].wedge);
        h = ref_left(r, h);
        if (a->n == 48)
            REF_SEEN(values_48);
    } while (h != REF_NONE && h != first && r->edge[h].wedge == w &&
             a->n < 48);
}

/* z = cofactors(M) mean x 256 / ((det(M) >> 8) + 1) */
static ref_vec solved(const ref_vec m[3], ref_vec mean)
{
    const ref_vec row[3] = { ref_cross(m[1], m[2]), ref_cross(m[2], m[0]),
                             ref_cross(m[0], m[1]) };
    const int64_t det = ref_dot(m[0], row[0]);
    ref_vec z;
    for (int k = 0; k < 3; k++)
        z.c[k] = ref_dot(row[k], mean) * 256 / (ref_shift(det, 8) + 1);
    return z;
}

static int64_t trace(const ref_vec m[3])
{
    return m[0].c[0] + m[1].c[1] + m[2].c[2];
}

static void weigh(const ref *r, uint32_t w, neighbours *a)
{
    const ref_vec p = r->vertex[r->wedge[w].vertex].at;
    ref_vec e[48], sum = { 0 }, m[3] = { 0 };
    uint64_t o = 1;
    int64_t shares = 0;
    for (int i = 0; i < a->n; i++) {
        e[i] = ref_sub(r->vertex[r->wedge[a->wedge[i]].vertex].at, p);
        o |= ref_or(e[i]);
    }
    for (int i = 0; i < a->n; i++) {
        e[i] = ref_vscale(e[i], 12 - ref_bits(o));
        sum = ref_add(sum, e[i]);
        shares += (1 << 20) / (ref_len(e[i]) + 64);
    }
    const ref_vec mean = ref_over(sum, a->n);
    for (int i = 0; i < a->n; i++) {
        const ref_vec d = ref_sub(e[i], mean);
        a->close[i] = (1 << 20) / (ref_len(e[i]) + 64) * 65536 / shares;
        for (int k = 0; k < 3; k++)
            m[k] = ref_add(m[k], ref_times(d, d.c[k]));
    }
    const int g = 18 - ref_bits((uint64_t)trace(m) | 1);
    for (int k = 0; k < 3; k++)
        m[k] = ref_vscale(m[k], g);
    const int64_t slack = ref_shift(trace(m), 4) + 1;
    for (int k = 0; k < 3; k++)
        m[k].c[k] += slack;
    const ref_vec z = solved(m, mean);
    for (int i = 0; i < a->n; i++) {
        const int64_t by =
            ref_scale(ref_dot(z, ref_sub(e[i], mean)), g);
        a->affine[i] = 65536 / a->n - ref_within(by, 1 << 18);
    }
}

/* ---- normals ------------------------------------------------------------ */

static void mirror(int64_t c, int64_t v[2])
{
    const int64_t a = v[0] - c, b = v[1] - c;
    v[0] = a >= 0 ? c + (c - absolute(b)) : c - (c - absolute(b));
    v[1] = b >= 0 ? c + (c - absolute(a)) : c - (c - absolute(a));
}

static ref_vec corner_normal(const ref *r, uint32_t h)
{
    const ref_vec p = r->vertex[r->edge[h].vertex].at;
    const ref_vec next = r->vertex[r->edge[ref_next(h)].vertex].at;
    const ref_vec prev = r->vertex[r->edge[ref_prev(h)].vertex].at;
    return ref_cross(ref_sub(next, p), ref_sub(prev, p));
}

static ref_vec surface_normal(const ref *r, uint32_t first)
{
    ref_vec sum = { 0 };
    uint32_t h = first;
    int count = 0;
    do {
        sum = ref_add(sum, corner_normal(r, h));
        h = ref_left(r, h);
        count++;
    } while (h != REF_NONE && h != first && count < 48);
    if (h != REF_NONE)
        return sum;
    REF_SEEN(normal_at_boundary);
    for (h = first; r->edge[h].twin != REF_NONE && count < 48; count++) {
        h = ref_next(r->edge[h].twin);
        sum = ref_add(sum, corner_normal(r, h));
    }
    return sum;
}

static void find_shape(const ref *r, subject *s)
{
    const ref_vec N = surface_normal(r, r->wedge[s->w].corner);
    const int64_t one = 16 * s->c;
    const int over = ref_bits(ref_or(N)) - 30;
    const int drop = over > 0 ? over : 0;
    int64_t size[3], sum = 0;
    for (int k = 0; k < 3; k++) {
        size[k] = ref_shift(absolute(N.c[k]), drop);
        sum += size[k];
    }
    s->shape[0] = s->shape[1] = one;
    if (sum == 0) {
        REF_SEEN(shape_0);
        return;
    }
    int64_t a = size[0] * one / sum, b = size[1] * one / sum;
    if (N.c[2] != 0 && (N.c[2] < 0) != s->mirrored) {
        const int64_t t = one - b;
        b = one - a;
        a = t;
    }
    s->shape[0] += N.c[0] < 0 ? -a : a;
    s->shape[1] += N.c[1] < 0 ? -b : b;
}

static void look(const ref *r, subject *s, const neighbours *a)
{
    int64_t below = 0;
    for (int i = 0; i < a->n; i++) {
        const uint16_t *v = r->wedge[a->wedge[i]].value + s->first;
        below += absolute(v[0] - s->c) + absolute(v[1] - s->c) - s->c;
    }
    s->mirrored = below > 0;
    if (s->mirrored)
        REF_SEEN(mirrored);
    s->shaped = true;
    find_shape(r, s);
}

/* ---- tangents ----------------------------------------------------------- */

static int first_component(const ref *r, int attribute)
{
    int first = 0;
    for (int i = 0; i < attribute; i++)
        first += r->header.attribute[i].coded;
    return first;
}

/* Finds what a tangent goes by; false if it is none. */
static bool is_tangent(const ref *r, subject *s, int attribute)
{
    const ref_attribute *a = &r->header.attribute[attribute];
    s->map = s->map_normal = -1;
    for (int i = attribute; i-- > 0;) {
        if (r->header.attribute[i].kind == 0)
            s->map_normal = i;
        if (r->header.attribute[i].kind == 1)
            s->map = i;
    }
    return a->kind == 3 && a->components == 4 && a->minimum[0] < 0 &&
           a->minimum[1] < 0 && a->minimum[2] < 0 && s->map >= 0 &&
           s->map_normal >= 0;
}

static ref_vec position_of(const ref *r, uint32_t h)
{
    return r->vertex[r->edge[h].vertex].at;
}

static ref_vec face_tangent(const ref *r, const subject *s, uint32_t h)
{
    const uint32_t wn = r->edge[ref_next(h)].wedge;
    const uint32_t wp = r->edge[ref_prev(h)].wedge;
    if (wn >= s->w || wp >= s->w)
        return (ref_vec){ { 0 } };
    const int first = first_component(r, s->map);
    const uint16_t *at = r->wedge[s->w].value + first;
    const uint16_t *next = r->wedge[wn].value + first;
    const uint16_t *prev = r->wedge[wp].value + first;
    const int64_t a = next[0] - at[0], b = next[1] - at[1];
    const int64_t e = prev[0] - at[0], d = prev[1] - at[1];
    const ref_vec p = ref_sub(position_of(r, ref_next(h)), position_of(r, h));
    const ref_vec q = ref_sub(position_of(r, ref_prev(h)), position_of(r, h));
    const ref_vec t = ref_sub(ref_times(p, d), ref_times(q, b));
    return a * d < b * e ? ref_times(t, -1) : t;
}

static ref_vec normal_of(const ref *r, const subject *s)
{
    const uint16_t *code =
        r->wedge[s->w].value + first_component(r, s->map_normal);
    const int64_t c =
        (1 << (r->header.attribute[s->map_normal].bits - 1)) - 1;
    const int64_t a = code[0] - c, b = code[1] - c;
    const int64_t z = c - absolute(a) - absolute(b);
    int64_t xy[2] = { code[0], code[1] };
    if (z < 0) {
        REF_SEEN(tangent_below);
        mirror(c, xy);
    }
    return (ref_vec){ { xy[0] - c, xy[1] - c, z } };
}

static ref_vec scaled_to(ref_vec v, int bits)
{
    return ref_vscale(v, bits - ref_bits(1 | ref_or(v)));
}

static void find_tangent(const ref *r, subject *s)
{
    const uint32_t first = r->wedge[s->w].corner;
    const int64_t half = 8 * largest(r, s->first);
    ref_vec t = { 0 };
    uint32_t h = first;
    int count = 0;
    do {
        t = ref_add(t, face_tangent(r, s, h));
        h = ref_left(r, h);
        count++;
    } while (h != REF_NONE && h != first && r->edge[h].wedge == s->w &&
             count < 48);
    t = scaled_to(t, 20);
    const ref_vec N = normal_of(r, s);
    t = ref_sub(t, ref_over(ref_times(N, ref_dot(N, t)), ref_dot(N, N)));
    t = scaled_to(t, 15);
    const int64_t L = ref_isqrt(ref_dot(t, t));
    s->shaped = L != 0;
    if (!s->shaped) {
        REF_SEEN(tangent_0);
        return;
    }
    for (int k = 0; k < 3; k++)
        s->shape[k] = half + t.c[k] * 16384 / L * half / 16384;
}

/* ---- components --------------------------------------------------------- */

typedef struct prediction {
    int64_t mean, spread, predicted;
    ref_vec t[REF_TERMS]; /* numbers: the first coordinate */
} prediction;

/* Component k of wedge x, as it is seen. */
static int64_t seen(const ref *r, const subject *s, uint32_t x, int k)
{
    const uint16_t *v = r->wedge[x].value + s->first;
    int64_t code[2] = { v[0], v[1] };
    if (!s->mirrored)
        return v[k];
    mirror(s->c, code);
    return code[k];
}

static int64_t blind(const ref *r, const subject *s, int k)
{
    const uint32_t sibling = lower_wedge(r, s->w, 0);
    const uint32_t from = r->wedge[s->w].from;
    if (sibling != REF_NONE) {
        REF_SEEN(value_from_sibling);
        return 16 * r->wedge[sibling].value[s->first + k];
    }
    if (from < s->w) {
        REF_SEEN(value_from_parent);
        return 16 * r->wedge[from].value[s->first + k];
    }
    REF_SEEN(value_half);
    return 16 * largest(r, s->first + k) / 2;
}

static void find_terms(const ref *r, const subject *s, const neighbours *a,
                       int k, const int64_t off[2], prediction *p)
{
    int64_t sum = 0, affine = 0, close = 0;
    for (int i = 0; i < a->n; i++) {
        const int64_t v = seen(r, s, a->wedge[i], k);
        sum += v;
        affine += v * a->affine[i];
        close += v * a->close[i];
    }
    p->mean = (16 * sum + a->n / 2) / a->n;
    for (int i = 0; i < a->n; i++)
        p->spread += absolute(16 * seen(r, s, a->wedge[i], k) - p->mean);
    p->spread /= a->n;
    p->t[0].c[0] = ref_shift(affine, 12) - p->mean;
    p->t[1].c[0] = ref_shift(close, 12) - p->mean;
    if (s->shaped && k < 3)
        p->t[2].c[0] = s->shape[k] - p->mean;
    p->t[3].c[0] = off[0];
    p->t[4].c[0] = off[1];
}

static prediction predict(const ref *r, const subject *s, const neighbours *a,
                          int k, const int64_t off[2], const ref_fit *fit)
{
    prediction p = { 0 };
    int64_t sum = 0;
    if (a->n > 0)
        find_terms(r, s, a, k, off, &p);
    else
        p.mean = blind(r, s, k);
    for (int t = 0; t < REF_TERMS; t++)
        sum += fit->w[0][t] * p.t[t].c[0];
    p.predicted = ref_clamp(p.mean + ref_shift(sum, 16), 0,
                            16 * largest(r, s->first + k));
    return p;
}

static void learn(ref_expected *e, int64_t size)
{
    e->value += (size - e->value) * 2 / (2 * e->uses + 3);
    e->uses = e->uses < 60 ? e->uses + 1 : 60;
}

static void learn_fit(ref_fit *fit, const prediction *p, int64_t value,
                      int64_t expected)
{
    const int64_t target = 16 * value - p->mean;
    uint64_t o = 1 | (uint64_t)absolute(target);
    for (int t = 0; t < REF_TERMS; t++)
        o |= (uint64_t)absolute(p->t[t].c[0]);
    const int s = 13 - ref_bits(o);
    const int64_t E = ref_within(ref_scale(expected, s), 1 << 14);
    const int64_t O =
        ref_within(ref_scale(16 * value - p->predicted, s), 1 << 14);
    const int64_t weight = (1 << 26) / (E * E + O * O + 1);
    ref_vec f[REF_TERMS];
    for (int t = 0; t < REF_TERMS; t++)
        f[t] = ref_vscale(p->t[t], s);
    ref_take_in(fit, 0, f, (ref_vec){ { ref_scale(target, s) } },
                weight < 1 << 18 ? weight : 1 << 18, 1 << 26);
}

static int smaller(int a, int b)
{
    return a < b ? a : b;
}

static int64_t read_component(ref *r, const subject *s, const neighbours *a,
                              int k, int64_t off[2], int *far)
{
    const int n = a->n, class = n < 3 ? n : n < 5 ? 3 : 4;
    ref_value_models *m = &r->value_models[s->first + k];
    ref_channel_models *all = &r->channel_models[s->attribute];
    ref_fit *fit = &m->fit[n < 3 ? 0 : n < 5 ? 1 : 2];
    const prediction p = predict(r, s, a, k, off, fit);
    ref_expected *y = &m->by_spread[class][smaller(
        ref_bits((uint64_t)(p.spread * p.spread)), 31)];
    ref_expected *z = &m->by_far[class][*far];
    const int64_t expected =
        y->uses < 2 ? z->value : (y->value + z->value) / 2;
    const int scale =
        expected ? smaller(ref_bits((uint64_t)(expected * expected)) - 1, 39)
                 : 0;
    const ref_near near = { &all->any[scale], &m->here[scale],
                            all->low[scale], &all->escape, scale,
                            p.predicted };
    const int64_t value = ref_read_near(r, &near);
    ref_check(r, value >= 0 && value <= largest(r, s->first + k),
              "6.6: a value out of range");
    off[1] = off[0];
    off[0] = 16 * value - p.predicted;
    learn(y, absolute(off[0]));
    learn(z, absolute(off[0]));
    if (n > 0)
        learn_fit(fit, &p, value, expected);
    *far = 1 + ref_how_far(value, &near);
    return value;
}

/* ---- attributes --------------------------------------------------------- */

static bool read_copy(ref *r, const subject *s, int before)
{
    for (int i = 0; i < 3; i++) {
        const uint32_t x = lower_wedge(r, s->w, i);
        if (x == REF_NONE)
            return false;
        if (ref_bit(&r->in,
                    &r->channel_models[s->attribute].differs[before][i]))
            continue;
        REF_SEEN(value_copied);
        for (int k = s->first; k < s->first + s->count; k++)
            r->wedge[s->w].value[k] = r->wedge[x].value[k];
        return true;
    }
    return false;
}

static void read_attribute(ref *r, subject *s, const neighbours *a)
{
    int64_t value[REF_COMPONENTS], off[2] = { 0, 0 };
    int far = 0;
    s->mirrored = s->shaped = false;
    if (s->normal)
        look(r, s, a);
    if (s->tangent && a->n > 0) {
        REF_SEEN(tangent);
        find_tangent(r, s);
    }
    for (int k = 0; k < s->count; k++)
        value[k] = read_component(r, s, a, k, off, &far);
    if (s->mirrored) {
        ref_check(r, value[0] <= 2 * s->c && value[1] <= 2 * s->c,
                  "6.6: a mirrored value out of range");
        mirror(s->c, value);
    }
    for (int k = 0; k < s->count; k++)
        r->wedge[s->w].value[s->first + k] = (uint16_t)value[k];
}

static void read_wedge(ref *r, uint32_t w)
{
    subject s = { .w = w };
    neighbours a;
    int before = 0;
    list_all(r, w, &a);
    if (a.n > 0)
        weigh(r, w, &a);
    for (int i = 0; i < r->header.attribute_count; i++) {
        s.attribute = i;
        s.first += s.count;
        s.count = r->header.attribute[i].coded;
        s.normal = r->header.attribute[i].kind == 0;
        s.tangent = is_tangent(r, &s, i);
        s.c = (1 << (r->header.attribute[i].bits - 1)) - 1;
        const bool copied = read_copy(r, &s, before);
        if (!copied)
            read_attribute(r, &s, &a);
        before = copied ? 2 : 1;
    }
}

void ref_read_values(ref *r)
{
    const uint32_t first = r->has_base ? r->block_wedge : 0;
    for (uint32_t w = first; w < r->wedge_count; w++)
        read_wedge(r, w);
}
