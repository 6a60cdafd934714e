/* SPDX-License-Identifier: MIT */
/*
 * level.c - codes a level of vertex splits, block by block (SPEC 6.3 to 6.6).
 */
#include <string.h>

#include "format/codec.h"
#include "format/cut.h"
#include "format/predict.h"
#include "format/rank.h"
#include "format/residual.h"
#include "format/wedge.h"

static pmesh_status corrupt(pmesh_codec *c, const char *rule)
{
    c->rule = rule;
    return PMESH_E_CORRUPT;
}

/* Breadth first over the rings, from vertex 0 and again from the lowest vertex
 * not seen. */
void pmesh_level_begin(pmesh_codec *c)
{
    const pmesh_mesh *m = &c->mesh;
    const uint32_t n = m->vertex_count;
    uint32_t count = 0, next = 0;

    memset(c->state, PMESH_UNVISITED, n);
    for (uint32_t seed = 0; seed < n; seed++) {
        if (c->state[seed] != PMESH_UNVISITED)
            continue;
        c->state[seed] = PMESH_KEPT;
        c->order[count++] = seed;
        while (next < count) {
            const uint32_t start = m->first[c->order[next++]];
            uint32_t h = start, last;
            do {
                const uint32_t x = m->vertex[pmesh_next(h)];
                if (c->state[x] == PMESH_UNVISITED) {
                    c->state[x] = PMESH_KEPT;
                    c->order[count++] = x;
                }
                last = pmesh_prev(h);
                h = m->twin[last];
            } while (h != PMESH_NONE && h != start);
            const uint32_t x = m->vertex[last];
            if (h == PMESH_NONE && c->state[x] == PMESH_UNVISITED) {
                c->state[x] = PMESH_KEPT;
                c->order[count++] = x;
            }
        }
    }
    memset(c->state, PMESH_UNVISITED, n);
    c->level_vertex_count = n;
    c->level_next = 0;
}

static uint32_t at_most(uint32_t value, uint32_t limit)
{
    return value < limit ? value : limit;
}

/* Whether v splits is likely told by which of its neighbours did. */
static uint32_t flag_context(const pmesh_codec *c, const pmesh_ring *ring)
{
    uint32_t seen[PMESH_GHOST + 1] = { 0 };
    for (uint32_t i = 0; i < ring->count; i++)
        seen[c->state[ring->vertex[i]]]++;
    const uint32_t size = ring->count + ring->open;
    const uint32_t valence = size < 4 ? 0 : at_most(size - 3, 7);
    const uint32_t split =
        at_most(seen[PMESH_PARENT] + seen[PMESH_NEWBORN], 5);
    const uint32_t kept = at_most(seen[PMESH_KEPT], 4);
    const uint32_t unvisited = at_most(seen[PMESH_UNVISITED], 6);
    return ((valence * 6 + split) * 5 + kept) * 7 + unvisited;
}

/* The mean of u's ring: of the members that the cut gives it, and v. */
static void place_provisionally(pmesh_mesh *m, uint32_t u, uint32_t v,
                                const pmesh_ring *ring, pmesh_cut cut)
{
    uint32_t i = cut.first == PMESH_NONE ? 0 : cut.first;
    const uint32_t last = cut.end == PMESH_NONE ? ring->count - 1 : cut.end;
    int64_t sum[3], count = 1;
    for (int k = 0; k < 3; k++)
        sum[k] = m->position[v][k];
    for (;;) {
        for (int k = 0; k < 3; k++)
            sum[k] += m->position[ring->vertex[i]][k];
        count++;
        if (i == last)
            break;
        i = i + 1 == ring->count ? 0 : i + 1;
    }
    for (int k = 0; k < 3; k++)
        m->position[u][k] = (int32_t)(sum[k] / count);
}

static void count_neighbours(pmesh_codec *c, uint32_t v, uint32_t u,
                             const pmesh_ring *ring, pmesh_cut cut)
{
    const uint32_t n = ring->count;
    const uint32_t first = cut.first == PMESH_NONE ? 0 : cut.first;
    const uint32_t end = cut.end == PMESH_NONE ? n - 1 : cut.end;
    const uint32_t span = first <= end ? end - first : n - first + end;
    c->degree[u] = span + 2;
    c->degree[v] = n - span;
    if (cut.first != PMESH_NONE) {
        c->degree[v]++;
        c->degree[ring->vertex[cut.first]]++;
    }
    if (cut.end != PMESH_NONE) {
        c->degree[v]++;
        c->degree[ring->vertex[cut.end]]++;
    }
}

static pmesh_status split(pmesh_codec *c, pmesh_coder *coder,
                          const pmesh_oracle *oracle, uint32_t v,
                          const pmesh_ring *ring)
{
    pmesh_mesh *m = &c->mesh;
    pmesh_cut cut = { 0, 0 };
    if (oracle)
        oracle->cut(oracle->user, v, ring, &cut);
    pmesh_cut_code(c, coder, v, ring, &cut);

    const uint32_t faces =
        cut.first != PMESH_NONE && cut.end != PMESH_NONE ? 2 : 1;
    if (m->vertex_count == m->vertex_capacity ||
        m->face_capacity - m->face_count < faces)
        return corrupt(c, "SPEC 6.3: more splits than the header declares");

    const uint32_t u = m->vertex_count, index = u - c->block.vertex;
    c->child_face[index] = m->face_count;
    if (c->sizes.moves)
        memcpy(c->unsplit[index], m->position[v], sizeof *c->unsplit);
    place_provisionally(m, u, v, ring, cut);
    count_neighbours(c, v, u, ring, cut);
    pmesh_mesh_split(m, v, ring, cut);
    c->state[v] = PMESH_PARENT;
    c->state[u] = PMESH_NEWBORN;
    c->block.vertex_count++;
    c->block.face_count += faces;
    if (oracle)
        oracle->split_done(oracle->user, u, m->face_count - faces, faces);
    return pmesh_wedge_split_code(c, coder, oracle, u, cut);
}

static pmesh_status code_connectivity(pmesh_codec *c, pmesh_coder *coder,
                                      const pmesh_oracle *oracle,
                                      uint32_t split_count)
{
    pmesh_status status = PMESH_OK;
    while (c->block.vertex_count < split_count && status == PMESH_OK) {
        pmesh_ring ring;
        if (c->level_next == c->level_vertex_count)
            return corrupt(c, "SPEC 6.3: more splits than vertices");
        const uint32_t v = c->order[c->level_next++];
        c->state[v] = PMESH_KEPT;
        if (!pmesh_ring_gather(&c->mesh, v, &ring))
            continue;
        pmesh_bit *flag = &c->models.flag[flag_context(c, &ring)];
        if (pmesh_code_bit(coder, flag,
                           oracle && oracle->splits(oracle->user, v)))
            status = split(c, coder, oracle, v, &ring);
    }
    return status;
}

static int32_t clamp(int64_t value, int32_t limit)
{
    return value < 0 ? 0 : value > limit ? limit : (int32_t)value;
}

static pmesh_predict_kind child_kind(const pmesh_codec *c)
{
    return c->sizes.moves ? PMESH_PREDICT_MOVED_CHILD : PMESH_PREDICT_CHILD;
}

/* Connectivity is complete now: a better guess for every provisional one. */
static void sweep(pmesh_codec *c)
{
    pmesh_mesh *m = &c->mesh;
    const uint32_t begin = c->block.vertex;
    for (uint32_t u = begin; u < begin + c->block.vertex_count; u++) {
        pmesh_prediction p;
        pmesh_predict(c, child_kind(c), u, m->parent[u],
                      m->position[m->parent[u]], begin, &p);
        for (int k = 0; k < 3; k++)
            m->position[u][k] = (int32_t)(p.position[k] / 16);
    }
}

/* How far, in 1/16 steps, u lies above or below its parent: what the surface
 * loses without it. */
static uint32_t importance_of(const pmesh_mesh *m, uint32_t u,
                              const int32_t parent[3],
                              const pmesh_prediction *p)
{
    int64_t height = 0;
    for (int k = 0; k < 3; k++)
        height += (int64_t)(m->position[u][k] - parent[k]) * p->normal[k];
    const uint64_t size = (uint64_t)(height < 0 ? -height : height) / 1024;
    return size > UINT32_MAX ? UINT32_MAX : (uint32_t)size;
}

static bool code_moved_parent(pmesh_codec *c, pmesh_coder *coder,
                              const pmesh_oracle *oracle, uint32_t u)
{
    pmesh_mesh *m = &c->mesh;
    const uint32_t v = m->parent[u];
    const int32_t *before = c->unsplit[u - c->block.vertex];
    int32_t mirrored[3];
    pmesh_prediction p;
    for (int k = 0; k < 3; k++) /* parent and child part about evenly */
        mirrored[k] = clamp(2 * (int64_t)before[k] - m->position[u][k],
                            c->bounds[k]);
    pmesh_predict(c, PMESH_PREDICT_MOVED_PARENT, v, u, mirrored, u + 1, &p);
    if (oracle)
        oracle->position(oracle->user, v, m->position[v]);
    if (!pmesh_residual_code(c, coder, 1, &p, m->position[v]))
        return false;
    pmesh_predict_learn(&p, m->position[v]);
    return true;
}

static pmesh_status code_positions(pmesh_codec *c, pmesh_coder *coder,
                                   const pmesh_oracle *oracle)
{
    pmesh_mesh *m = &c->mesh;
    const uint32_t begin = c->block.vertex;
    for (uint32_t u = begin; u < begin + c->block.vertex_count; u++) {
        const uint32_t v = m->parent[u];
        pmesh_prediction p;
        pmesh_predict(c, child_kind(c), u, v, m->position[v], u, &p);
        if (oracle)
            oracle->position(oracle->user, u, m->position[u]);
        if (!pmesh_residual_code(c, coder, 0, &p, m->position[u]))
            return corrupt(c, "SPEC 6.5: a vertex leaves the bounds");
        pmesh_predict_learn(&p, m->position[u]);
        c->importance[u - begin] =
            importance_of(m, u, m->position[v], &p);
        if (c->sizes.moves && !code_moved_parent(c, coder, oracle, u))
            return corrupt(c, "SPEC 6.5: a vertex leaves the bounds");
    }
    return PMESH_OK;
}

/* What was written since the last call counts as the given part. */
static void count_part(pmesh_codec *c, const pmesh_coder *coder, int part,
                       size_t *written)
{
    if (!coder->encoding)
        return;
    c->part_size[part] += coder->out->size - *written;
    *written = coder->out->size;
}

pmesh_status pmesh_block_code(pmesh_codec *c, pmesh_coder *coder,
                              const pmesh_oracle *oracle, uint32_t split_count)
{
    pmesh_mesh *m = &c->mesh;
    if (split_count > c->sizes.block_splits)
        return corrupt(c, "SPEC 6.3: a block larger than the header declares");
    c->block = (pmesh_block){ .vertex = m->vertex_count,
                              .face = m->face_count,
                              .wedge = m->wedge_count };
    c->wedge_limit = c->sizes.block_wedges;
    size_t written = coder->encoding ? coder->out->size : 0;

    pmesh_status status = code_connectivity(c, coder, oracle, split_count);
    if (status != PMESH_OK)
        return status;
    count_part(c, coder, 0, &written);
    sweep(c);
    status = code_positions(c, coder, oracle);
    if (status != PMESH_OK)
        return status;
    count_part(c, coder, 1, &written);
    if (!m->value_count)
        m->wedge_count = m->vertex_count;
    c->block.wedge_count = m->wedge_count - c->block.wedge;
    for (uint32_t i = 0; i < c->block.wedge_count && m->value_count; i++) {
        status = pmesh_wedge_values_code(c, coder, oracle, c->block.wedge + i);
        if (status != PMESH_OK)
            return status;
    }
    count_part(c, coder, 2, &written);
    pmesh_block_rank(c);
    return PMESH_OK;
}
