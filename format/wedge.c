/* SPDX-License-Identifier: MIT */
#include "format/wedge.h"

/* One corner's wedge, as written or as read. `key` is PMESH_NONE when
 * decoding. */
typedef struct corner {
    uint32_t half_edge, key, wedge;
} corner;

static corner ask(const pmesh_oracle *oracle, uint32_t h)
{
    corner a = { h, PMESH_NONE, PMESH_NONE };
    if (oracle) {
        a.key = oracle->key(oracle->user, h);
        a.wedge = oracle->number(oracle->user, a.key);
    }
    return a;
}

static pmesh_status corrupt(pmesh_codec *c, const char *rule)
{
    c->rule = rule;
    return PMESH_E_CORRUPT;
}

static pmesh_status make_wedge(pmesh_codec *c, const pmesh_oracle *oracle,
                               corner a, uint32_t parent)
{
    pmesh_mesh *m = &c->mesh;
    if (m->wedge_count == m->wedge_capacity ||
        m->wedge_count - c->block.wedge == c->wedge_limit)
        return corrupt(c, "SPEC 6.6: more wedges than the header declares");
    const uint32_t w = m->wedge_count++;
    m->wedge[a.half_edge] = w;
    m->wedge_vertex[w] = m->vertex[a.half_edge];
    m->wedge_parent[w] = parent;
    c->wedge_corner[w] = a.half_edge;
    c->wedge_before[w] = c->wedge_last[m->wedge_vertex[w]];
    c->wedge_last[m->wedge_vertex[w]] = w;
    if (oracle)
        oracle->set_number(oracle->user, a.key, w);
    return PMESH_OK;
}

/* How many wedges of its vertex were made since that of this corner, which may
 * have left the ring; PMESH_NONE if there is none near (the wedge is then made
 * again). */
static uint32_t find_place(const pmesh_codec *c, corner a)
{
    uint32_t w = c->wedge_last[c->mesh.vertex[a.half_edge]];
    if (a.wedge == PMESH_NONE)
        return PMESH_NONE;
    for (uint32_t place = 0; w != PMESH_NONE && place < PMESH_MAX_PLACE;
         place++, w = c->wedge_before[w])
        if (w == a.wedge)
            return place;
    return PMESH_NONE;
}

static pmesh_status pick_wedge(pmesh_codec *c, pmesh_coder *coder, corner a,
                               uint32_t place)
{
    uint32_t w = c->wedge_last[c->mesh.vertex[a.half_edge]];

    place = pmesh_tell_number(coder, &c->models.wedge.pick, place);
    if (place >= PMESH_MAX_PLACE)
        return corrupt(c, "SPEC 6.6: a wedge's place is out of range");
    for (; place > 0 && w != PMESH_NONE; place--)
        w = c->wedge_before[w];
    if (w == PMESH_NONE)
        return corrupt(c, "SPEC 6.6: the vertex has no such wedge");
    c->mesh.wedge[a.half_edge] = w;
    return PMESH_OK;
}

/* A new wedge at a vertex that is there already takes, one level coarser, the
 * place that its neighbour in the ring takes. */
static uint32_t parent_like(const pmesh_mesh *m, uint32_t h, uint32_t guess)
{
    if (guess != PMESH_NONE)
        return m->wedge_parent[guess];
    uint32_t start = m->first[m->vertex[h]];
    for (uint32_t k = start; k != PMESH_NONE;
         k = pmesh_corner_next(m, &start, k))
        if (m->wedge[k] != PMESH_NONE)
            return m->wedge_parent[m->wedge[k]];
    return PMESH_NONE;
}

/* Whether vertex x has two wedges at the half-edge h, one on each side: 2 if
 * that is not known. */
static unsigned seam_at(const pmesh_mesh *m, uint32_t h, uint32_t x)
{
    const uint32_t t = h == PMESH_NONE ? PMESH_NONE : m->twin[h];
    if (t == PMESH_NONE)
        return 2;
    const bool starts = m->vertex[h] == x;
    const uint32_t here = m->wedge[starts ? h : pmesh_next(h)];
    const uint32_t there = m->wedge[starts ? pmesh_next(t) : t];
    return here == PMESH_NONE || there == PMESH_NONE ? 2 : here != there;
}

/* One corner: like the first guess, like the second, like some other corner
 * of the vertex, or new. */
static pmesh_status code_corner(pmesh_codec *c, pmesh_coder *coder,
                                const pmesh_oracle *oracle, uint32_t h,
                                uint32_t guess, uint32_t second,
                                unsigned context)
{
    pmesh_wedge_models *models = &c->models.wedge;
    const corner a = ask(oracle, h);
    if (guess == PMESH_NONE) {
        guess = second;
        second = PMESH_NONE;
    }
    if (guess != PMESH_NONE) {
        const unsigned agree =
            second == PMESH_NONE ? 0 : second == guess ? 1 : 2;
        if (!pmesh_tell_bit(coder, &models->corner[agree][context], a.wedge != guess)) {
            c->mesh.wedge[h] = guess;
            return PMESH_OK;
        }
        if (agree == 2 &&
            !pmesh_tell_bit(coder, &models->corner[3][context], a.wedge != second)) {
            c->mesh.wedge[h] = second;
            return PMESH_OK;
        }
    }
    c->mesh.wedge[h] = PMESH_NONE;
    const uint32_t place = find_place(c, a);
    if (pmesh_tell_bit(coder, &models->choice[0], place != PMESH_NONE))
        return pick_wedge(c, coder, a, place);
    return make_wedge(c, oracle, a, parent_like(&c->mesh, h, guess));
}

pmesh_status pmesh_wedge_ring_code(pmesh_codec *c, pmesh_coder *coder,
                                   const pmesh_oracle *oracle, uint32_t x)
{
    pmesh_mesh *m = &c->mesh;
    if (!m->value_count)
        return PMESH_OK;
    uint32_t start = m->first[x], before = PMESH_NONE;
    c->wedge_last[x] = PMESH_NONE;
    for (uint32_t h = start; h != PMESH_NONE;
         h = pmesh_corner_next(m, &start, h))
        m->wedge[h] = PMESH_NONE;
    start = m->first[x];
    for (uint32_t h = start; h != PMESH_NONE;
         h = pmesh_corner_next(m, &start, h)) {
        const pmesh_status status =
            before == PMESH_NONE
                ? make_wedge(c, oracle, ask(oracle, h), PMESH_NONE)
                : code_corner(c, coder, oracle, h, before, PMESH_NONE,
                              8);
        if (status != PMESH_OK)
            return status;
        before = m->wedge[h];
    }
    return PMESH_OK;
}

/* What a split changed: the corners of u, those of v and the wings in the new
 * faces, and the best guesses for the latter. A vertex has no more corners than
 * ring members; each fan that is cut has two members at least and gives u two
 * corners more, and the others four; a pair of lone faces, as many. */
enum {
    MOST_NEW = PMESH_MAX_PARTS + PMESH_MAX_LONE,
    MOST_CORNERS = PMESH_MAX_RING + 2 * MOST_NEW,
    MOST_OTHERS = 4 * MOST_NEW
};
typedef struct change {
    uint32_t count; /* corners of u */
    uint32_t at_u[MOST_CORNERS];
    uint32_t coarse[MOST_CORNERS]; /* their wedges before, or PMESH_NONE */
    uint32_t others;
    uint32_t at[MOST_OTHERS], guess[MOST_OTHERS], second[MOST_OTHERS];
    /* Half-edges across which u's, and v's, wedge may differ, or NONE. */
    uint32_t child_edge[MOST_OTHERS], parent_edge[MOST_OTHERS];
} change;

static void add_other(change *d, uint32_t h, uint32_t guess, uint32_t second,
                      uint32_t child_edge, uint32_t parent_edge)
{
    d->child_edge[d->others] = child_edge;
    d->parent_edge[d->others] = parent_edge;
    d->at[d->others] = h;
    d->guess[d->others] = guess;
    d->second[d->others++] = second;
}

static uint32_t wedge_at(const pmesh_mesh *m, uint32_t h)
{
    return h == PMESH_NONE ? PMESH_NONE : m->wedge[h];
}

/* The wedge at the end of h in h's face. */
static uint32_t wedge_end(const pmesh_mesh *m, uint32_t h)
{
    return h == PMESH_NONE ? PMESH_NONE : m->wedge[pmesh_next(h)];
}

/* The first corner of x, from first[] on, in a face older than half-edge
 * `fresh`; PMESH_NONE if there is none. */
static uint32_t older_corner(const pmesh_mesh *m, uint32_t x, uint32_t fresh)
{
    uint32_t start = m->first[x], h = start;
    while (h != PMESH_NONE && h >= fresh)
        h = pmesh_corner_next(m, &start, h);
    return h;
}

static uint32_t first_fresh(const pmesh_fresh *f)
{
    if (f->count == 0)
        return f->lone;
    return f->face[0][0] != PMESH_NONE ? f->face[0][0] : f->face[0][1];
}

/* Face a is (v, a, u), face b is (v, u, b). Around v the neighbours of the new
 * faces lie across v-a and v-b, around the wings also across u-a and u-b. If v
 * kept no other face there, it had the wedge of what moved. */
static void gather_wings(change *d, const pmesh_mesh *m, uint32_t a, uint32_t b,
                         uint32_t start, uint32_t fresh)
{
    uint32_t at_v_a = PMESH_NONE, at_v_b = PMESH_NONE;
    if (a != PMESH_NONE)
        at_v_a = wedge_end(m, m->twin[a]);
    if (b != PMESH_NONE)
        at_v_b = wedge_at(m, m->twin[b + 2]);
    if (at_v_a == PMESH_NONE && at_v_b == PMESH_NONE) {
        while (start != PMESH_NONE && start >= fresh)
            start = pmesh_turn_left(m, start); /* some face has moved */
        at_v_a = wedge_at(m, start);
    }
    if (a != PMESH_NONE) {
        add_other(d, a, at_v_a, at_v_b, a + 1, PMESH_NONE);
        add_other(d, a + 1, wedge_end(m, m->twin[a + 1]),
                  wedge_at(m, m->twin[a]), a + 1, a);
    }
    if (b != PMESH_NONE) {
        add_other(d, b, at_v_b, at_v_a, b + 1, PMESH_NONE);
        add_other(d, b + 2, wedge_at(m, m->twin[b + 1]),
                  wedge_end(m, m->twin[b + 2]), b + 1, b + 2);
    }
}

/* A lone face has no neighbours: v and the third vertex are guessed as in
 * their first older face, v also as in what moved. */
static void gather_lone(change *d, const pmesh_mesh *m, uint32_t h, uint32_t u,
                        uint32_t fresh)
{
    const uint32_t at_v = m->vertex[h] == u ? h + 1 : h;
    uint32_t older = older_corner(m, m->vertex[at_v], fresh);
    if (older == PMESH_NONE)
        older = older_corner(m, u, fresh);
    add_other(d, at_v, wedge_at(m, older), PMESH_NONE, PMESH_NONE,
              PMESH_NONE);
    older = older_corner(m, m->vertex[h + 2], fresh);
    add_other(d, h + 2, wedge_at(m, older), PMESH_NONE, PMESH_NONE,
              PMESH_NONE);
}

static void change_gather(change *d, pmesh_mesh *m, uint32_t u,
                          const pmesh_fresh *f)
{
    const uint32_t fresh = first_fresh(f);
    uint32_t start = m->first[u];
    d->count = d->others = 0;
    for (uint32_t h = start; h != PMESH_NONE && d->count < MOST_CORNERS;
         h = pmesh_corner_next(m, &start, h)) {
        d->at_u[d->count] = h;
        d->coarse[d->count++] = h < fresh ? m->wedge[h] : PMESH_NONE;
    }
    for (uint32_t i = 0; i < f->count; i++)
        gather_wings(d, m, f->face[i][0], f->face[i][1], f->start[i], fresh);
    for (uint32_t h = f->lone; h < f->lone_end; h += 3)
        gather_lone(d, m, h, u, fresh);
    for (uint32_t i = 0; i < d->count; i++)
        m->wedge[d->at_u[i]] = PMESH_NONE;
    for (uint32_t i = 0; i < d->others; i++)
        m->wedge[d->at[i]] = PMESH_NONE;
}

static uint32_t first_guess(const change *d, uint32_t i)
{
    return d->guess[i] != PMESH_NONE ? d->guess[i] : d->second[i];
}

/* The ordinary case: u is one wedge, and everything else as first guessed. */
static bool is_ordinary(const change *d, const pmesh_oracle *oracle)
{
    const uint32_t key = oracle->key(oracle->user, d->at_u[0]);
    for (uint32_t i = 1; i < d->count; i++)
        if (oracle->key(oracle->user, d->at_u[i]) != key)
            return false;
    for (uint32_t i = 0; i < d->others; i++) {
        const uint32_t guess = first_guess(d, i);
        if (guess == PMESH_NONE || ask(oracle, d->at[i]).wedge != guess)
            return false;
    }
    return true;
}

/* Context: whether seams are near. */
static unsigned seam_class(const change *d)
{
    uint32_t coarse = PMESH_NONE;
    unsigned seams = 0;
    for (uint32_t i = 0; i < d->count; i++) {
        if (d->coarse[i] == PMESH_NONE)
            continue;
        if (coarse != PMESH_NONE && d->coarse[i] != coarse)
            seams |= 2;
        coarse = d->coarse[i];
    }
    for (uint32_t i = 0; i < d->others; i++)
        if (d->second[i] != PMESH_NONE && d->guess[i] != d->second[i])
            seams |= 1;
    return seams > 2 ? 2 : seams;
}

/* One wedge of u is one wedge of v one level coarser: so coarsening needs no
 * list of its own. */
static const char two_parents[] =
    "SPEC 6.6: a wedge comes from two wedges of the parent";

static bool set_coarse(pmesh_mesh *m, uint32_t wedge, uint32_t coarse)
{
    uint32_t *parent = &m->wedge_parent[wedge];
    if (coarse == PMESH_NONE || *parent == coarse)
        return true;
    if (*parent != PMESH_NONE)
        return false;
    *parent = coarse;
    return true;
}

/* Each corner of u against the one before it; a wedge of u is, one level
 * coarser, the wedge of v that its faces had. */
static pmesh_status code_child(pmesh_codec *c, pmesh_coder *coder,
                               const pmesh_oracle *oracle, const change *d,
                               uint32_t coarse)
{
    pmesh_mesh *m = &c->mesh;
    for (uint32_t i = 0; i < d->count; i++) {
        const uint32_t h = d->at_u[i];
        pmesh_status status = PMESH_OK;
        if (i == 0) {
            status = make_wedge(c, oracle, ask(oracle, h), PMESH_NONE);
        } else {
            const corner a = ask(oracle, h);
            const uint32_t before = m->wedge[d->at_u[i - 1]];
            const unsigned context =
                d->coarse[i] == PMESH_NONE || d->coarse[i - 1] == PMESH_NONE
                    ? 2
                    : d->coarse[i] != d->coarse[i - 1];
            const uint32_t place = find_place(c, a);
            if (!pmesh_tell_bit(coder, &c->models.wedge.seam[context][seam_at(m, h, m->vertex[pmesh_next(h)])],
                                a.wedge != before))
                m->wedge[h] = before;
            else if (pmesh_tell_bit(coder, &c->models.wedge.choice[1],
                                    place != PMESH_NONE))
                status = pick_wedge(c, coder, a, place);
            else
                status = make_wedge(c, oracle, a, PMESH_NONE);
        }
        if (status != PMESH_OK)
            return status;
        if (!set_coarse(m, m->wedge[h], d->coarse[i]))
            return corrupt(c, two_parents);
    }
    for (uint32_t i = 0; i < d->count; i++)
        if (m->wedge_parent[m->wedge[d->at_u[i]]] == PMESH_NONE)
            set_coarse(m, m->wedge[d->at_u[i]], coarse);
    return PMESH_OK;
}

static pmesh_status code_wedges(pmesh_codec *c, pmesh_coder *coder,
                                const pmesh_oracle *oracle, uint32_t u,
                                const pmesh_fresh *fresh)
{
    pmesh_mesh *m = &c->mesh;
    change d;
    change_gather(&d, m, u, fresh);
    c->wedge_last[u] = PMESH_NONE;
    /* What of v is one level coarser for wedges that no moved face has. */
    uint32_t coarse = d.others ? first_guess(&d, 0) : PMESH_NONE;
    for (uint32_t i = 0; i < d.count && coarse == PMESH_NONE; i++)
        coarse = d.coarse[i];

    pmesh_status status = PMESH_OK;
    const bool ordinary = coder->encoding && is_ordinary(&d, oracle);
    if (!pmesh_tell_bit(coder, &c->models.wedge.ordinary[seam_class(&d)],
                        !ordinary)) {
        status = make_wedge(c, oracle, ask(oracle, d.at_u[0]), PMESH_NONE);
        for (uint32_t i = 0; i < d.count && status == PMESH_OK; i++) {
            m->wedge[d.at_u[i]] = m->wedge[d.at_u[0]];
            if (!set_coarse(m, m->wedge[d.at_u[0]], d.coarse[i]))
                status = corrupt(c, two_parents);
        }
        if (status == PMESH_OK &&
            m->wedge_parent[m->wedge[d.at_u[0]]] == PMESH_NONE)
            set_coarse(m, m->wedge[d.at_u[0]], coarse);
        for (uint32_t i = 0; i < d.others && status == PMESH_OK; i++) {
            m->wedge[d.at[i]] = first_guess(&d, i);
            /* Never, by SPEC 6.6; but an index would follow from it. */
            if (first_guess(&d, i) == PMESH_NONE)
                status = corrupt(c, "SPEC 6.6: an ordinary split without a "
                                    "wedge to go on with");
        }
    } else {
        status = code_child(c, coder, oracle, &d, coarse);
        for (uint32_t i = 0; i < d.others && status == PMESH_OK; i++)
            status =
                code_corner(c, coder, oracle, d.at[i], d.guess[i], d.second[i],
                            3 * seam_at(m, d.child_edge[i], u) +
                                seam_at(m, d.parent_edge[i], m->parent[u]));
    }
    /* The decoder still shows the faces that were there before. */
    for (uint32_t i = 0; i < d.count && status != PMESH_OK; i++)
        if (d.coarse[i] != PMESH_NONE)
            m->wedge[d.at_u[i]] = d.coarse[i];
    return status;
}

pmesh_status pmesh_material_code(pmesh_codec *c, pmesh_coder *coder,
                                 const pmesh_oracle *oracle, uint32_t face,
                                 uint32_t guess, uint32_t second)
{
    pmesh_mesh *m = &c->mesh;
    pmesh_wedge_models *models = &c->models.wedge;
    if (!m->material)
        return PMESH_OK;
    const uint32_t truth =
        oracle ? oracle->material(oracle->user, face) : PMESH_NONE;
    const unsigned differ = guess != second;
    uint32_t result = guess;
    if (pmesh_tell_bit(coder, &models->material[differ], truth != guess)) {
        result = second;
        if (!differ ||
            pmesh_tell_bit(coder, &models->material[2], truth != second))
            result = pmesh_tell_number(coder, &models->pick, truth);
    }
    if (result >= m->material_count)
        return corrupt(c, "SPEC 6.6: no such material");
    m->material[face] = result;
    return PMESH_OK;
}

/* The material across half-edge h; `fallback` beyond a boundary. */
static uint32_t material_across(const pmesh_mesh *m, uint32_t h,
                                uint32_t fallback)
{
    const uint32_t t = m->twin[h];
    return t == PMESH_NONE ? fallback : m->material[t / 3];
}

static pmesh_status code_materials(pmesh_codec *c, pmesh_coder *coder,
                                   const pmesh_oracle *oracle, uint32_t a,
                                   uint32_t b)
{
    const pmesh_mesh *m = &c->mesh;
    const uint32_t far_from_v[2] = { a + 1, b + 1 };
    const uint32_t near_v[2] = { a, b + 2 };
    for (int i = 0; i < 2; i++) {
        const uint32_t h = i == 0 ? a : b;
        if (h == PMESH_NONE)
            continue;
        uint32_t guess = material_across(m, near_v[i], PMESH_NONE);
        const uint32_t second = material_across(m, far_from_v[i], guess);
        if (guess == PMESH_NONE)
            guess = second == PMESH_NONE ? 0 : second;
        const pmesh_status status = pmesh_material_code(
            c, coder, oracle, h / 3, guess,
            second == PMESH_NONE ? guess : second);
        if (status != PMESH_OK)
            return status;
    }
    return PMESH_OK;
}

/* Lone faces: like the face that v's wedge is guessed from. */
static pmesh_status code_lone_materials(pmesh_codec *c, pmesh_coder *coder,
                                        const pmesh_oracle *oracle, uint32_t u,
                                        const pmesh_fresh *f)
{
    const pmesh_mesh *m = &c->mesh;
    const uint32_t fresh = first_fresh(f);
    for (uint32_t h = f->lone; h < f->lone_end; h += 3) {
        uint32_t older = older_corner(m, m->parent[u], fresh);
        if (older == PMESH_NONE)
            older = older_corner(m, u, fresh);
        const uint32_t guess = m->material[older / 3];
        const pmesh_status status =
            pmesh_material_code(c, coder, oracle, h / 3, guess, guess);
        if (status != PMESH_OK)
            return status;
    }
    return PMESH_OK;
}

pmesh_status pmesh_wedge_split_code(pmesh_codec *c, pmesh_coder *coder,
                                    const pmesh_oracle *oracle, uint32_t u,
                                    const pmesh_fresh *f)
{
    const pmesh_mesh *m = &c->mesh;
    pmesh_status status = PMESH_OK;
    if (m->material) {
        for (uint32_t i = 0; i < f->count && status == PMESH_OK; i++)
            status = code_materials(c, coder, oracle, f->face[i][0],
                                    f->face[i][1]);
        if (status == PMESH_OK)
            status = code_lone_materials(c, coder, oracle, u, f);
        if (status != PMESH_OK)
            return status;
    }
    return m->value_count ? code_wedges(c, coder, oracle, u, f) : PMESH_OK;
}
