/* SPDX-License-Identifier: MIT */
/*
 * base.c - codes the base mesh (SPEC 6.2): faces grow over gates, the open
 * half-edges of the faces before, first in first out; or a hook gives them all.
 */
#include <string.h>

#include "format/codec.h"
#include "format/value.h"
#include "format/wedge.h"

/* Rows of models.base. */
enum { BOUNDARY, KNOWN_VERTEX, NEIGHBOUR };

typedef struct base {
    pmesh_codec *c;
    pmesh_coder *coder;
    const pmesh_oracle *oracle;
    uint32_t vertices, faces; /* to come to; in a joined mesh, its fans */
    uint32_t points;          /* of a joined mesh: vertices so far; order[] has
                                 that of each fan, parent[] its first fan */
    uint32_t *table;          /* directed pairs -> half-edge, open addressing */
    uint64_t mask;
} base;

static pmesh_status corrupt(base *b, const char *rule)
{
    b->c->rule = rule;
    return PMESH_E_CORRUPT;
}

uint64_t pmesh_base_scratch(uint32_t faces)
{
    uint64_t size = 64;
    while (size < 6 * (uint64_t)faces + 1)
        size *= 2;
    return size;
}

static uint64_t slot_of(const base *b, uint32_t from, uint32_t to)
{
    const pmesh_mesh *m = &b->c->mesh;
    uint64_t slot = pmesh_edge_hash(from, to) & b->mask;
    for (;; slot = (slot + 1) & b->mask) {
        const uint32_t h = b->table[slot];
        if (h == PMESH_NONE ||
            (m->vertex[h] == from && m->vertex[pmesh_next(h)] == to))
            return slot;
    }
}

static uint32_t find_edge(const base *b, uint32_t from, uint32_t to)
{
    return b->table[slot_of(b, from, to)];
}

/* The next open half-edge from the end of gate g: the third vertex is often
 * where it ends, or where the one before g starts. The walk is bounded. */
static uint32_t neighbour_gate(const pmesh_mesh *m, uint32_t g, bool right)
{
    uint32_t h = right ? pmesh_next(g) : pmesh_prev(g);
    for (int steps = 0; steps < PMESH_MAX_RING; steps++) {
        if (m->twin[h] == PMESH_NONE)
            return h;
        h = right ? pmesh_next(m->twin[h]) : pmesh_prev(m->twin[h]);
    }
    return PMESH_NONE;
}

/* The vertex of fan v: one before, whose position it takes, or a new one. */
static pmesh_status join_fan(base *b, uint32_t original, uint32_t v,
                             bool *known)
{
    pmesh_codec *c = b->c;
    pmesh_mesh *m = &c->mesh;
    pmesh_join_models *models = &c->models.join;
    uint32_t *at = NULL, point = PMESH_NONE;
    if (b->oracle)
        at = &b->oracle->point_vertex
                  [b->oracle->base_point[b->oracle->base->vertex[original]]];
    if (at)
        point = *at;
    *known = b->points > 0 &&
             pmesh_code_bit(b->coder, &models->known, point != PMESH_NONE);
    if (!*known) {
        m->parent[b->points] = v;
        c->order[v] = b->points++;
        if (at)
            *at = c->order[v];
        return PMESH_OK;
    }
    const uint32_t back =
        pmesh_code_number(b->coder, &models->back, b->points - 1 - point);
    if (back >= b->points)
        return corrupt(b, "SPEC 6.2: no such base vertex");
    c->order[v] = b->points - 1 - back;
    memcpy(m->position[v], m->position[m->parent[c->order[v]]],
           sizeof *m->position);
    return PMESH_OK;
}

/* Appends the vertex at a half-edge of the oracle's base. */
static pmesh_status add_vertex(base *b, uint32_t original,
                               const int64_t guess[3])
{
    pmesh_codec *c = b->c;
    pmesh_mesh *m = &c->mesh;
    if (m->vertex_count == b->vertices)
        return corrupt(b, "SPEC 6.2: more base vertices than declared");
    const uint32_t v = m->vertex_count++;
    int32_t truth[3] = { 0, 0, 0 };
    if (b->oracle) {
        const uint32_t at = b->oracle->base->vertex[original];
        b->oracle->base_vertex[at] = v;
        for (int k = 0; k < 3; k++)
            truth[k] = b->oracle->base->position[at][k];
    }
    m->first[v] = PMESH_NONE;
    if (m->fan) {
        bool known;
        const pmesh_status status = join_fan(b, original, v, &known);
        if (status != PMESH_OK || known)
            return status;
    } else {
        m->parent[v] = PMESH_NONE;
    }
    for (int k = 0; k < 3; k++) {
        const int64_t r = truth[k] - guess[k];
        const uint32_t size = pmesh_code_number(
            b->coder, &c->models.base_position, (uint32_t)(r < 0 ? -r : r));
        const unsigned negative =
            size && pmesh_code_bit(b->coder, &c->models.base_sign, r < 0);
        const int64_t x = negative ? guess[k] - size : guess[k] + size;
        if (x < 0 || x > c->bounds[k])
            return corrupt(b, "SPEC 6.2: a base vertex is out of bounds");
        m->position[v][k] = (int32_t)x;
    }
    return PMESH_OK;
}

/* Appends face (x, y, z) and glues its edges to open ones; `original` is the
 * half-edge from x to y in the oracle's base. */
static pmesh_status add_face(base *b, uint32_t x, uint32_t y, uint32_t z,
                             uint32_t original)
{
    pmesh_mesh *m = &b->c->mesh;
    const uint32_t h = 3 * m->face_count;
    if (m->face_count == b->faces)
        return corrupt(b, "SPEC 6.2: more base faces than declared");
    m->vertex[h] = x;
    m->vertex[h + 1] = y;
    m->vertex[h + 2] = z;
    for (uint32_t k = h; k < h + 3; k++)
        m->twin[k] = PMESH_NONE;
    for (uint32_t k = h; k < h + 3; k++) {
        const uint32_t from = m->vertex[k], to = m->vertex[pmesh_next(k)];
        const uint64_t slot = slot_of(b, from, to);
        if (b->table[slot] != PMESH_NONE)
            return corrupt(b, "SPEC 6.2: two base faces run along an edge the "
                              "same way");
        const uint32_t t = find_edge(b, to, from);
        b->table[slot] = k;
        m->twin[k] = t;
        if (t != PMESH_NONE)
            m->twin[t] = k;
        if (m->first[from] == PMESH_NONE)
            m->first[from] = k;
    }
    for (uint32_t k = h; b->oracle && k < h + 3; k++) {
        b->oracle->base_edge[k] = original;
        original = pmesh_next(original);
    }
    m->face_count++;
    return PMESH_OK;
}

static pmesh_status add_seed(base *b, uint32_t original)
{
    const pmesh_mesh *m = &b->c->mesh;
    const uint32_t v = m->vertex_count;
    for (int i = 0; i < 3; i++) {
        int64_t guess[3] = { 0, 0, 0 };
        for (int k = 0; k < 3 && m->vertex_count > 0; k++)
            guess[k] = m->position[m->vertex_count - 1][k];
        const pmesh_status status = add_vertex(b, original, guess);
        if (status != PMESH_OK)
            return status;
        original = pmesh_next(original);
    }
    return add_face(b, v, v + 1, v + 2, original);
}

/* The third vertex z of the face beyond gate g: `known` to the codec by that
 * number, or new (PMESH_NONE) at the half-edge `original` of the base. */
static pmesh_status code_third(base *b, uint32_t g, uint32_t known,
                               uint32_t original, uint32_t *z)
{
    pmesh_codec *c = b->c;
    const pmesh_mesh *m = &c->mesh;
    const uint32_t x = m->vertex[g], y = m->vertex[pmesh_next(g)];

    if (!pmesh_code_bit(b->coder, &c->models.base[KNOWN_VERTEX][0],
                        known != PMESH_NONE)) {
        const int32_t *px = m->position[x], *py = m->position[y];
        const int32_t *pw = m->position[m->vertex[pmesh_prev(g)]];
        int64_t guess[3]; /* the parallelogram's fourth corner */
        for (int k = 0; k < 3; k++)
            guess[k] = (int64_t)px[k] + py[k] - pw[k];
        *z = m->vertex_count;
        return add_vertex(b, original, guess);
    }

    uint32_t candidate[2] = { PMESH_NONE, PMESH_NONE };
    const uint32_t right = neighbour_gate(m, g, true);
    const uint32_t left = neighbour_gate(m, g, false);
    if (right != PMESH_NONE)
        candidate[0] = m->vertex[pmesh_next(right)];
    if (left != PMESH_NONE)
        candidate[1] = m->vertex[left];
    for (int i = 0; i < 2; i++) {
        if (candidate[i] == PMESH_NONE || candidate[i] == x ||
            candidate[i] == y || (i == 1 && candidate[1] == candidate[0]))
            continue;
        if (!pmesh_code_bit(b->coder, &c->models.base[NEIGHBOUR][i],
                            known != candidate[i])) {
            *z = candidate[i];
            return PMESH_OK;
        }
    }
    /* Recent vertices are likelier. */
    const uint32_t back = pmesh_code_number(b->coder, &c->models.base_vertex,
                                            m->vertex_count - 1 - known);
    if (back >= m->vertex_count)
        return corrupt(b, "SPEC 6.2: no such base vertex");
    *z = m->vertex_count - 1 - back;
    return *z == x || *z == y
               ? corrupt(b, "SPEC 6.2: a base face names a vertex twice")
               : PMESH_OK;
}

static pmesh_status code_gate(base *b, uint32_t g)
{
    const pmesh_mesh *m = &b->c->mesh;
    const pmesh_oracle *oracle = b->oracle;
    uint32_t twin = PMESH_NONE, known = PMESH_NONE, third = 0, z = 0;

    if (oracle)
        twin = oracle->base->twin[oracle->base_edge[g]];
    if (twin != PMESH_NONE) {
        third = pmesh_prev(twin);
        known = oracle->base_vertex[oracle->base->vertex[third]];
    }
    if (pmesh_code_bit(b->coder, &b->c->models.base[BOUNDARY][0],
                       twin == PMESH_NONE))
        return PMESH_OK;
    const pmesh_status status = code_third(b, g, known, third, &z);
    return status != PMESH_OK
               ? status
               : add_face(b, m->vertex[pmesh_next(g)], m->vertex[g], z, twin);
}

/* The lowest half-edge of the oracle's base whose face was not reached. */
static uint32_t next_seed(const base *b, uint32_t from)
{
    const pmesh_oracle *oracle = b->oracle;
    if (!oracle)
        return 0;
    while (oracle->base_vertex[oracle->base->vertex[from]] != PMESH_NONE)
        from += 3;
    return from;
}

static pmesh_status code_connectivity(base *b)
{
    const pmesh_mesh *m = &b->c->mesh;
    uint32_t gate = 0, seed = 0;
    pmesh_status status = PMESH_OK;
    while (status == PMESH_OK) {
        if (gate == 3 * m->face_count) {
            if (m->face_count == b->faces)
                break;
            seed = next_seed(b, seed);
            status = add_seed(b, seed);
        } else {
            if (m->twin[gate] == PMESH_NONE)
                status = code_gate(b, gate);
            gate++;
        }
    }
    if (status == PMESH_OK && m->vertex_count != b->vertices)
        status = corrupt(b, "SPEC 6.2: fewer base vertices than declared");
    return status;
}

static void add_neighbour(pmesh_codec *c, uint32_t v, uint32_t x)
{
    c->near[v].degree++;
    for (int k = 0; k < 3; k++)
        c->near[v].sum[k] += (uint32_t)c->mesh.position[x][k];
}

/* Neighbours: one per face, and one more at a boundary. */
static void count_neighbours(pmesh_codec *c)
{
    const pmesh_mesh *m = &c->mesh;
    memset(c->near, 0, m->vertex_count * sizeof *c->near);
    for (uint32_t h = 0; h < 3 * m->face_count; h++) {
        const uint32_t v = m->vertex[h], x = m->vertex[pmesh_next(h)];
        add_neighbour(c, v, x);
        if (m->twin[h] == PMESH_NONE)
            add_neighbour(c, x, v);
    }
}

/* Fans become those of their vertices. A vertex is never numbered above its
 * first fan, so all is done in place. */
static pmesh_status join_fans(base *b)
{
    pmesh_mesh *m = &b->c->mesh;
    const uint32_t *point = b->c->order;
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        const uint32_t p = point[v], start = m->first[v];
        if (m->parent[p] == v)
            m->first[p] = PMESH_NONE;
        if (!pmesh_fan_append(m, p, start))
            return corrupt(b, "SPEC 6.2: a vertex with too many fans");
    }
    for (uint32_t p = 0; p < b->points; p++) {
        memmove(m->position[p], m->position[m->parent[p]],
                sizeof *m->position);
        m->parent[p] = PMESH_NONE;
    }
    for (uint32_t h = 0; h < 3 * m->face_count; h++)
        m->vertex[h] = point[m->vertex[h]];
    for (uint32_t h = 0; h < 3 * m->face_count; h++)
        if (m->vertex[h] == m->vertex[pmesh_next(h)])
            return corrupt(b, "SPEC 6.2: a base face names a vertex twice");
    m->vertex_count = b->points;
    return PMESH_OK;
}

/* At a boundary first[] is the half-edge without a twin. */
static pmesh_status settle(base *b)
{
    pmesh_mesh *m = &b->c->mesh;
    pmesh_status status = PMESH_OK;
    for (uint32_t h = 0; h < 3 * m->face_count; h++)
        if (m->twin[h] == PMESH_NONE)
            m->first[m->vertex[h]] = h;
    for (uint32_t v = 0; m->fan && v < m->vertex_count; v++)
        m->fan[m->first[v]] = PMESH_NONE;
    if (pmesh_mesh_check(m, (uint8_t *)b->table))
        return corrupt(b, "SPEC 6.2: the base mesh is not a manifold");
    if (m->fan)
        status = join_fans(b);
    if (status != PMESH_OK)
        return status;
    count_neighbours(b->c);
    memset(b->c->made_faces, 0, m->vertex_count * sizeof *b->c->made_faces);
    for (uint32_t v = 0; v <= m->vertex_count; v += PMESH_FACE_MARK)
        b->c->faces_before[v / PMESH_FACE_MARK] = m->face_count;
    return PMESH_OK;
}

static base begin(pmesh_codec *c, uint32_t vertices, uint32_t faces)
{
    const base b = { .c = c, .vertices = vertices, .faces = faces,
                     .table = c->scratch,
                     .mask = pmesh_base_scratch(faces) - 1 };
    for (uint64_t i = 0; i <= b.mask; i++)
        b.table[i] = PMESH_NONE;
    c->block = (pmesh_block){ 0 };
    return b;
}

pmesh_status pmesh_base_code(pmesh_codec *c, pmesh_coder *coder,
                             const pmesh_oracle *oracle, uint32_t vertices,
                             uint32_t faces)
{
    base b = begin(c, c->sizes.joined ? c->sizes.base_fans : vertices, faces);
    b.coder = coder;
    b.oracle = oracle;
    const pmesh_status status = code_connectivity(&b);
    if (status == PMESH_OK && c->sizes.joined && b.points != vertices)
        return corrupt(&b, "SPEC 6.2: fewer base vertices than declared");
    return status == PMESH_OK ? settle(&b) : status;
}

static pmesh_status import_vertices(base *b)
{
    pmesh_mesh *m = &b->c->mesh;
    for (uint32_t v = 0; v < b->vertices; v++) {
        for (int k = 0; k < 3; k++)
            if (m->position[v][k] < 0 || m->position[v][k] > b->c->bounds[k])
                return corrupt(b, "SPEC 6.2: a base vertex is out of bounds");
        m->parent[v] = PMESH_NONE;
        m->first[v] = PMESH_NONE;
    }
    m->vertex_count = b->vertices;
    return PMESH_OK;
}

static pmesh_status import_faces(base *b)
{
    const uint32_t *corner = b->c->mesh.vertex;
    pmesh_status status = PMESH_OK;
    for (uint32_t h = 0; h < 3 * b->faces; h++)
        if (corner[h] >= b->vertices)
            return corrupt(b, "SPEC 6.2: no such base vertex");
    for (uint32_t f = 0; f < b->faces && status == PMESH_OK; f++, corner += 3)
        status = add_face(b, corner[0], corner[1], corner[2], PMESH_NONE);
    return status;
}

pmesh_status pmesh_base_import(pmesh_codec *c, const pmesh_base_source *source,
                               uint32_t vertices, uint32_t faces)
{
    base b = begin(c, vertices, faces);
    pmesh_mesh *m = &c->mesh;
    /* A hook that leaves something out shall not show old memory. */
    memset(m->position, 0, vertices * sizeof *m->position);
    memset(m->vertex, 0, 3 * (size_t)faces * sizeof *m->vertex);
    pmesh_status status =
        source->decode(source->user, source->data, source->size, vertices,
                       faces, &m->position[0][0], m->vertex);
    if (status != PMESH_OK) {
        c->rule = "SPEC 6.2: the Draco buffer does not hold the base mesh";
        status = status == PMESH_E_MEMORY ? status : PMESH_E_CORRUPT;
    }
    if (status == PMESH_OK)
        status = import_vertices(&b);
    if (status == PMESH_OK)
        status = import_faces(&b);
    if (status == PMESH_OK)
        status = settle(&b);
    if (status != PMESH_OK)
        m->vertex_count = m->face_count = 0;
    return status;
}

pmesh_status pmesh_base_attributes_code(pmesh_codec *c, pmesh_coder *coder,
                                        const pmesh_oracle *oracle,
                                        uint32_t wedges)
{
    pmesh_mesh *m = &c->mesh;
    pmesh_status status = PMESH_OK;
    c->wedge_limit = wedges;
    for (uint32_t f = 0; f < m->face_count && status == PMESH_OK; f++) {
        const uint32_t guess = f && m->material ? m->material[f - 1] : 0;
        status = pmesh_material_code(c, coder, oracle, f, guess, guess);
    }
    if (m->value_count) {
        for (uint32_t h = 0; h < 3 * m->face_count; h++)
            m->wedge[h] = PMESH_NONE;
        for (uint32_t v = 0; v < m->vertex_count && status == PMESH_OK; v++)
            status = pmesh_wedge_ring_code(c, coder, oracle, v);
        for (uint32_t w = 0; w < m->wedge_count && status == PMESH_OK; w++)
            status = pmesh_wedge_values_code(c, coder, oracle, w);
    } else {
        m->wedge_count = m->vertex_count;
    }
    if (status == PMESH_OK && !oracle && m->wedge_count != wedges) {
        c->rule = "SPEC 6.2: fewer base wedges than declared";
        status = PMESH_E_CORRUPT;
    }
    return status;
}
