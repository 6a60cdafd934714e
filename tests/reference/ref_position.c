/* SPDX-License-Identifier: MIT */
/* SPEC 6.5: predictions of positions, and the weights that learn from them. */
#include "tests/reference/ref.h"

/* One vertex under prediction; names are those of SPEC 6.5. */
typedef struct frame {
    const ref *r;
    uint32_t x, y;
    const ref_ring *ring;
    int n, s;
    int64_t j; /* y's place */
    ref_vec q, mean, normal;
    ref_vec e[REF_MEMBERS], d[REF_MEMBERS], f[REF_MEMBERS];
    int64_t l[REF_MEMBERS];
} frame;

int64_t ref_share(int64_t v, int64_t k)
{
    return ref_shift(v * (((int64_t)1 << 32) / k + 1), 32);
}

ref_vec ref_vshare(ref_vec v, int64_t k)
{
    for (int i = 0; i < 3; i++)
        v.c[i] = ref_share(v.c[i], k);
    return v;
}

int64_t ref_len(ref_vec v)
{
    int64_t m = 0, sum = 0;
    for (int i = 0; i < 3; i++) {
        const int64_t a = v.c[i] < 0 ? -v.c[i] : v.c[i];
        m = a > m ? a : m;
        sum += a;
    }
    return m + ref_shift(sum - m, 2) + ref_shift(sum - m, 3);
}

int64_t ref_isqrt(int64_t v)
{
    int64_t root = 0;
    for (int64_t step = (int64_t)1 << 31; step > 0; step /= 2)
        if ((root + step) <= v / (root + step))
            root += step;
    return root;
}

static int64_t along_normal(ref_vec v, ref_vec normal)
{
    return ref_shift(ref_dot(v, normal), 14);
}

static int faces_of(const frame *m)
{
    return m->ring->open ? m->n - 1 : m->n;
}

/* ---- frame -------------------------------------------------------------- */

static void set_edges(frame *m)
{
    uint64_t all = 1;
    ref_vec sum = { 0 };
    for (int i = 0; i < m->n; i++) {
        m->e[i] = ref_sub(m->r->vertex[m->ring->vertex[i]].at, m->q);
        all |= ref_or(m->e[i]);
        if (m->ring->vertex[i] == m->y && m->j == m->n)
            m->j = i;
    }
    if (m->j == m->n) /* not there */
        m->j = m->n - 1;
    m->s = 12 - ref_bits(all);
    for (int i = 0; i < m->n; i++) {
        m->e[i] = ref_vscale(m->e[i], m->s);
        sum = ref_add(sum, m->e[i]);
    }
    m->mean = ref_vshare(sum, m->n);
    for (int i = 0; i < m->n; i++) {
        m->d[i] = ref_sub(m->e[i], m->mean);
        m->l[i] = ref_len(m->d[i]);
    }
}

static void set_normal(frame *m)
{
    ref_vec sum = { 0 };
    for (int i = 0; i < faces_of(m); i++) {
        m->f[i] = ref_cross(m->d[i], m->d[(i + 1) % m->n]);
        sum = ref_add(sum, m->f[i]);
    }
    const int drop = ref_bits(ref_or(sum)) - 15;
    if (drop > 0)
        sum = ref_vshift(sum, drop);
    const int64_t length = ref_isqrt(ref_dot(sum, sum));
    if (length == 0) {
        REF_SEEN(normal_0);
        return;
    }
    m->normal =
        ref_vshift(ref_times(sum, ((int64_t)1 << 29) / length), 15);
}

static void set_contexts(const frame *m, ref_prediction *p,
                         uint32_t provisional)
{
    int64_t lengths = 0, heights = 0;
    for (int i = 0; i < m->n; i++) {
        const uint32_t z = m->ring->vertex[i];
        const int64_t dot = ref_dot(m->d[i], m->normal);
        lengths += m->l[i];
        heights += ref_shift(dot < 0 ? -dot : dot, 14);
        p->unknown += z >= provisional && z != m->y;
        p->irregular += ref_degree(m->r, z) != 6;
    }
    const int64_t S = ref_share(lengths, m->n), H = ref_share(heights, m->n);
    const int64_t size = ref_scale(S, 4 - m->s), q = 256 * H / (S + 1);
    const int rough = ref_bits((uint64_t)q * (uint64_t)q);
    p->size = size > 16 ? size : 16;
    p->rough = rough < 13 ? rough : 13;
    p->class = m->ring->open ? 8
               : m->n >= 10  ? 7
               : m->n > 3    ? m->n - 3
                             : 0;
    p->unknown = p->unknown < 2 ? p->unknown : 2;
    p->irregular = p->irregular < 4 ? p->irregular : 4;
}

/* ---- terms -------------------------------------------------------------- */

static ref_vec half_sum(const frame *m, int64_t a, int64_t b)
{
    return ref_sub(ref_vshift(ref_add(m->e[a], m->e[b]), 1), m->mean);
}

/* The sum of z's neighbours. */
static ref_vec neighbours(const ref *r, uint32_t z)
{
    ref_vec sum = { 0 };
    for (int fan = 0; ref_fan(r, z, fan) != REF_NONE; fan++) {
        const ref_ring ring = ref_ring_from(r, ref_fan(r, z, fan));
        for (int c = 0; c < ring.count; c++)
            sum = ref_add(sum, r->vertex[ring.vertex[c]].at);
    }
    return sum;
}

/* How z's other neighbours lie around z. */
static ref_vec bend_at(const frame *m, int i, int64_t k)
{
    ref_vec sum = neighbours(m->r, m->ring->vertex[i]);
    sum = ref_sub(sum, m->r->vertex[m->x].at);
    sum = ref_sub(sum, ref_times(m->q, k));
    sum = ref_vwithin(ref_vscale(sum, m->s), 1 << 22);
    return ref_sub(ref_vshare(sum, k), m->e[i]);
}

static ref_vec bend(const frame *m)
{
    ref_vec sum = { 0 };
    int64_t count = 0;
    for (int i = 0; i < m->n; i++) {
        const int64_t k =
            (int64_t)ref_degree(m->r, m->ring->vertex[i]) - 1;
        if (k < 2 || k >= 48) {
            REF_SEEN(bend_left_out);
            continue;
        }
        sum = ref_add(sum, bend_at(m, i, k));
        count++;
    }
    return count > 0 ? ref_vshare(sum, count) : sum;
}

static ref_vec centre(const int64_t *g, const ref_vec *v, int count,
                      int64_t k)
{
    ref_vec sum = { 0 };
    int64_t all = 0;
    for (int i = 0; i < count; i++) {
        sum = ref_add(sum, ref_times(v[i], g[i]));
        all += g[i];
    }
    if (all == 0) {
        REF_SEEN(centre_0);
        return (ref_vec){ 0 };
    }
    return ref_vshift(ref_times(sum, ((int64_t)1 << 31) / (k * all)), 31);
}

static ref_vec centre_of_faces(const frame *m)
{
    int64_t g[REF_MEMBERS];
    ref_vec v[REF_MEMBERS];
    uint64_t all = 0;
    for (int i = 0; i < faces_of(m); i++) {
        g[i] = ref_len(m->f[i]);
        v[i] = ref_add(m->d[i], m->d[(i + 1) % m->n]);
        all |= (uint64_t)g[i];
    }
    const int drop = ref_bits(all) - 11;
    for (int i = 0; i < faces_of(m) && drop > 0; i++)
        g[i] = ref_shift(g[i], drop);
    return centre(g, v, faces_of(m), 3);
}

static ref_vec centre_of_spokes(const frame *m)
{
    int64_t g[REF_MEMBERS];
    for (int i = 0; i < m->n; i++)
        g[i] = ref_shift(m->l[i], 3);
    return centre(g, m->d, m->n, 1);
}

/* Straight on through z, neighbour i. */
static ref_vec straight(const frame *m, int64_t i)
{
    const ref *r = m->r;
    const ref_vec zero = { 0 };
    const uint32_t z = m->ring->vertex[i];
    const int k = (int)ref_degree(r, z);
    if (k > 48 || (m->ring->open && i == m->n - 1))
        return zero;
    uint32_t h = r->edge[m->ring->edge[i]].twin, w = 0, w2 = 0;
    for (int turns = 0; h != REF_NONE; turns++, h = ref_left(r, h)) {
        if (turns == k / 2)
            w = ref_end_of(r, h);
        if (turns == (k + 1) / 2) {
            w2 = ref_end_of(r, h);
            break;
        }
    }
    if (h == REF_NONE) {
        REF_SEEN(straight_short);
        return zero;
    }
    ref_vec v = ref_times(r->vertex[z].at, 4);
    v = ref_sub(v, ref_add(r->vertex[w].at, r->vertex[w2].at));
    v = ref_sub(v, ref_times(m->q, 2));
    return ref_sub(ref_vshift(ref_vscale(v, m->s), 1), m->mean);
}

static void set_terms(const frame *m, ref_prediction *p)
{
    const int n = m->n;
    const int64_t c = (m->j + n / 2) % n, c2 = (m->j + (n + 1) / 2) % n;
    p->t[0] = ref_sub((ref_vec){ 0 }, m->mean);
    p->t[1] = m->ring->open ? half_sum(m, 0, n - 1) : half_sum(m, c, c2);
    p->t[2] = bend(m);
    p->t[3] = centre_of_faces(m);
    p->t[4] = centre_of_spokes(m);
    p->t[5] = straight(m, m->j);
    p->t[6] = straight(m, c);
    for (int t = 0; t < REF_TERMS; t++) {
        p->t[t] = ref_vwithin(p->t[t], 1 << 14);
        p->h[t] = along_normal(p->t[t], m->normal);
    }
}

/* ---- prediction --------------------------------------------------------- */

static ref_prediction predict_plain(ref_vec q, int kind)
{
    REF_SEEN(predict_large_ring);
    return (ref_prediction){ .plain = true,
                             .kind = kind,
                             .class = 7,
                             .unknown = 2,
                             .irregular = 4,
                             .rough = 13,
                             .size = 1024,
                             .q = q,
                             .position = ref_times(q, 16) };
}

static void combine(const ref *r, ref_prediction *p)
{
    const ref_fit *fit = &r->fit[p->kind][p->class][p->unknown];
    ref_vec a = { 0 };
    int64_t c = 0;
    for (int t = 0; t < REF_TERMS; t++) {
        a = ref_add(a, ref_times(p->t[t], fit->w[0][t]));
        c += (fit->w[1][t] - fit->w[0][t]) * p->h[t];
    }
    a = ref_add(a, ref_vshift(ref_times(p->normal, c), 14));
    p->predicted = ref_add(p->mean, ref_vshift(a, 16));
    p->position = ref_add(ref_times(p->q, 16),
                          ref_vscale(p->predicted, 4 - p->s));
    for (int i = 0; i < 3; i++)
        p->position.c[i] =
            ref_clamp(p->position.c[i], 0, 16 * r->header.bounds[i]);
}

ref_prediction ref_predict(const ref *r, uint32_t x, uint32_t y, ref_vec q,
                           int kind, uint32_t provisional)
{
    const ref_ring ring = ref_ring_of(r, x);
    if (ring.large)
        return predict_plain(q, kind);
    frame m = { .r = r, .x = x, .y = y, .ring = &ring,
                .n = ring.count, .j = ring.count,
                .q = q };
    ref_prediction p = { .kind = kind, .q = q };
    set_edges(&m);
    set_normal(&m);
    set_contexts(&m, &p, provisional);
    p.s = m.s;
    p.mean = m.mean;
    p.normal = m.normal;
    set_terms(&m, &p);
    combine(r, &p);
    return p;
}

/* ---- learning ----------------------------------------------------------- */

static int64_t smaller(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/* W anew, one after the other. */
static void weigh_again(ref_fit *fit, int which, int64_t pull)
{
    int64_t(*m)[REF_TERMS] = fit->m[which];
    const int64_t *b = fit->b[which], *start = fit->start[which];
    int64_t *w = fit->w[which];
    for (int t = 0; t < REF_TERMS; t++) {
        int64_t rest = b[t];
        for (int j = 0; j < REF_TERMS; j++)
            rest -= ref_shift(m[t][j], 16) * w[j];
        rest += ref_shift(pull, 16) * (start[t] - w[t]);
        w[t] = ref_within(
            w[t] + rest / (ref_shift(m[t][t] + pull, 16) + 1), 1 << 19);
    }
}

void ref_take_in(ref_fit *fit, int which, const ref_vec *f, ref_vec y,
                 int64_t weight, int64_t pull)
{
    const bool round = ++fit->samples[which] % 4 == 0;
    for (int t = 0; t < REF_TERMS; t++) {
        int64_t *b = &fit->b[which][t];
        *b += weight * ref_dot(f[t], y);
        *b -= round ? ref_shift(*b, 5) : 0;
        for (int j = 0; j < REF_TERMS; j++) {
            int64_t *m = &fit->m[which][t][j];
            *m += weight * ref_dot(f[t], f[j]);
            *m -= round ? ref_shift(*m, 5) : 0;
        }
    }
    if (round)
        weigh_again(fit, which, pull);
}

static int64_t squared(const ref_prediction *p, int64_t v)
{
    const int64_t x = ref_within(ref_scale(v, p->s - 5), 1 << 14);
    return x * x;
}

void ref_learn(ref *r, const ref_prediction *p, ref_vec final)
{
    if (p->plain)
        return;
    ref_fit *fit = &r->fit[p->kind][p->class][p->unknown];
    const ref_vec D = ref_vscale(ref_sub(final, p->q), p->s);
    const ref_vec E = ref_vwithin(ref_sub(D, p->predicted), 1 << 14);
    const ref_vec G = ref_vwithin(ref_sub(D, p->mean), 1 << 14);
    const int64_t eu = along_normal(E, p->normal);
    const int64_t up = along_normal(G, p->normal);
    const int64_t eh = ref_shift(eu * eu, 2);
    const int64_t ef =
        ref_clamp(ref_shift(ref_dot(E, E), 2) - eh, 0, INT32_MAX);
    ref_vec flat[REF_TERMS], high[REF_TERMS];
    for (int t = 0; t < REF_TERMS; t++) {
        const ref_vec part = ref_vshift(ref_times(p->normal, p->h[t]), 14);
        flat[t] = ref_vshift(ref_sub(p->t[t], part), 1);
        high[t] = (ref_vec){ { ref_shift(p->h[t], 1) } };
    }
    const ref_vec part = ref_vshift(ref_times(p->normal, up), 14);
    ref_take_in(fit, 0, flat, ref_vshift(ref_sub(G, part), 1),
                smaller((1 << 26) / (squared(p, p->along) + ef + 1), 1 << 18),
                1 << 24);
    ref_take_in(fit, 1, high, (ref_vec){ { ref_shift(up, 1) } },
                smaller((1 << 26) / (squared(p, p->across) / 2 + eh + 1),
                        1 << 18),
                1 << 27);
}

/* ---- a block ------------------------------------------------------------ */

static void set_key(ref_split *split, const ref_prediction *p, ref_vec u)
{
    const int64_t dot = ref_dot(ref_sub(u, split->before), p->normal);
    int64_t i = (dot < 0 ? -dot : dot) / 1024;
    int e = 0;
    split->key = i;
    if (i < 2048)
        return;
    for (; i >= 4096; i /= 2)
        e++;
    REF_SEEN(key_rounded);
    split->key = (e + 1) * 2048 + i - 2048;
}

static void read_child(ref *r, uint32_t u)
{
    ref_split *split = &r->split[u - r->base_vertices];
    const uint32_t v = split->parent;
    split->before = r->vertex[v].at;
    ref_prediction p =
        ref_predict(r, u, v, split->before, r->header.moving ? 1 : 0, u);
    const ref_vec at = ref_read_residual(r, &p);
    r->vertex[u].at = r->vertex[u].born = at;
    ref_learn(r, &p, at);
    set_key(split, &p, at);
}

static void read_parent(ref *r, uint32_t u)
{
    ref_split *split = &r->split[u - r->base_vertices];
    const uint32_t v = split->parent;
    ref_vec q =
        ref_sub(ref_times(split->before, 2), r->vertex[u].at);
    for (int i = 0; i < 3; i++) {
        if (q.c[i] < 0 || q.c[i] > r->header.bounds[i])
            REF_SEEN(parent_clamped);
        q.c[i] = ref_clamp(q.c[i], 0, r->header.bounds[i]);
    }
    ref_prediction p = ref_predict(r, v, u, q, 2, u + 1);
    r->vertex[v].at = ref_read_residual(r, &p);
    ref_learn(r, &p, r->vertex[v].at);
}

/* Axis k of a better provisional position for u. */
static int64_t guess(const ref *r, uint32_t u, const ref_ring *ring, int k)
{
    int64_t a = 0, d = 0, others = 0;
    for (int i = 0; i < ring->count; i++) {
        const uint32_t z = ring->vertex[i];
        const int64_t more = (int64_t)ref_degree(r, z) - 1;
        a += r->vertex[z].at.c[k];
        if (more >= 48) {
            REF_SEEN(guess_left_out);
            continue;
        }
        d += neighbours(r, z).c[k] - r->vertex[u].at.c[k] -
             more * r->vertex[z].at.c[k];
        others += more;
    }
    d = (int32_t)(uint32_t)d; /* modulo 2^32 */
    const int64_t by = others > 0 ? 5 * ((int64_t)1 << 29) / others : 0;
    const int64_t mean = a * (((int64_t)1 << 32) / ring->count + 1);
    const uint32_t parent = r->split[u - r->base_vertices].parent;
    const int64_t v = ((int64_t)1 << 32) * r->vertex[parent].at.c[k];
    const int64_t c = r->header.moving ? ref_shift(mean + 3 * v, 2)
                                       : mean - d * by;
    return ref_shift(c + ((int64_t)1 << 31), 32);
}

static void guess_child(ref *r, uint32_t u)
{
    const ref_ring ring = ref_ring_of(r, u);
    ref_vec at;
    if (ring.large) {
        REF_SEEN(guess_large_ring);
        return;
    }
    for (int k = 0; k < 3; k++)
        at.c[k] = ref_clamp(guess(r, u, &ring, k), 0, r->header.bounds[k]);
    r->vertex[u].at = at;
}

void ref_read_positions(ref *r)
{
    for (uint32_t u = r->block_vertex; u < r->vertex_count; u++)
        guess_child(r, u);
    for (uint32_t u = r->block_vertex; u < r->vertex_count; u++) {
        ref_split *split = &r->split[u - r->base_vertices];
        read_child(r, u);
        if (r->header.moving)
            read_parent(r, u);
        split->after = r->vertex[split->parent].at;
    }
}
