/* SPDX-License-Identifier: MIT */
#include "format/mesh.h"

#include <string.h>

bool pmesh_ring_gather(const pmesh_mesh *m, uint32_t v, pmesh_ring *ring)
{
    return pmesh_ring_gather_fan(m, m->first[v], ring);
}

bool pmesh_ring_gather_fan(const pmesh_mesh *m, uint32_t start,
                           pmesh_ring *ring)
{
    uint32_t h = start, n = 0;

    do {
        if (n == PMESH_MAX_RING)
            return false;
        ring->edge[n] = h;
        ring->vertex[n++] = m->vertex[pmesh_next(h)];
        const uint32_t last = pmesh_prev(h);
        h = m->twin[last];
        if (h == PMESH_NONE) {
            if (n + 2 > PMESH_MAX_RING)
                return false;
            ring->face_count = n;
            ring->vertex[n] = m->vertex[last];
            ring->count = n + 1;
            ring->open = true;
            return true;
        }
    } while (h != start);

    ring->count = ring->face_count = n;
    ring->open = false;
    return true;
}

/* Of a closed ring: from the first one to the left and to the right. */
static bool list_closed(const pmesh_mesh *m, pmesh_ring *ring)
{
    const uint32_t n = ring->count;
    uint32_t left = ring->edge[0], right = left;
    for (uint32_t i = 1; i <= n / 2; i++) {
        right = m->twin[right];
        left = m->twin[pmesh_prev(left)];
        if (left == PMESH_NONE || right == PMESH_NONE)
            return false;
        right = pmesh_next(right);
        ring->edge[n - i] = right;
        ring->edge[i] = left;
    }
    return true;
}

static bool list_open(const pmesh_mesh *m, pmesh_ring *ring)
{
    uint32_t h = ring->edge[0];
    for (uint32_t i = 1; i < ring->face_count; i++) {
        h = m->twin[pmesh_prev(h)];
        if (h == PMESH_NONE)
            return false;
        ring->edge[i] = h;
    }
    ring->vertex[ring->face_count] = m->vertex[pmesh_prev(h)];
    return true;
}

bool pmesh_ring_list_edges(const pmesh_mesh *m, uint32_t v, uint32_t count,
                           pmesh_ring *ring)
{
    const uint32_t start = m->first[v];
    ring->open = m->twin[start] == PMESH_NONE;
    ring->count = count;
    ring->face_count = count - ring->open;
    ring->edge[0] = start;
    return count + ring->open <= PMESH_MAX_RING &&
           (ring->open ? list_open(m, ring) : list_closed(m, ring));
}

bool pmesh_ring_gather_known(const pmesh_mesh *m, uint32_t v, uint32_t count,
                             pmesh_ring *ring)
{
    if (!pmesh_ring_list_edges(m, v, count, ring))
        return false;
    for (uint32_t i = 0; i < ring->face_count; i++)
        ring->vertex[i] = m->vertex[pmesh_next(ring->edge[i])];
    return true;
}

bool pmesh_cut_legal(const pmesh_ring *ring, pmesh_cut cut)
{
    const uint32_t n = ring->count;
    if (!ring->open)
        return cut.first < n && cut.end < n && cut.first != cut.end;
    if (cut.first == PMESH_NONE)
        return cut.end < n;
    if (cut.end == PMESH_NONE)
        return cut.first < n;
    return cut.first < cut.end && cut.end < n;
}

static void pair(pmesh_mesh *m, uint32_t a, uint32_t b)
{
    m->twin[a] = b;
    if (b != PMESH_NONE)
        m->twin[b] = a;
}

uint32_t pmesh_mesh_add_face(pmesh_mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t h = 3 * m->face_count++;
    m->vertex[h] = a;
    m->vertex[h + 1] = b;
    m->vertex[h + 2] = c;
    return h;
}

/* The half-edge x -> v in the face before neighbour i (clockwise of it), and
 * v -> x in the face behind it; PMESH_NONE beyond a boundary. */
static uint32_t edge_before(const pmesh_ring *ring, uint32_t i)
{
    if (ring->open && i == 0)
        return PMESH_NONE;
    return pmesh_prev(ring->edge[i == 0 ? ring->count - 1 : i - 1]);
}

static uint32_t edge_behind(const pmesh_ring *ring, uint32_t i)
{
    return i < ring->face_count ? ring->edge[i] : PMESH_NONE;
}

bool pmesh_fan_append(pmesh_mesh *m, uint32_t v, uint32_t h)
{
    uint32_t *end = &m->first[v], count = 0;
    for (; *end != PMESH_NONE; end = &m->fan[*end])
        if (++count == PMESH_MAX_FANS)
            return false;
    *end = h;
    m->fan[h] = PMESH_NONE;
    return true;
}

/* The fan of x that started at `old` starts at `now`. */
static void restart(pmesh_mesh *m, uint32_t x, uint32_t old, uint32_t now)
{
    uint32_t *at = &m->first[x];
    if (m->fan) {
        while (*at != old)
            at = &m->fan[*at];
        m->fan[now] = m->fan[old];
    }
    *at = now;
}

void pmesh_mesh_cut(pmesh_mesh *m, uint32_t v, uint32_t u,
                    const pmesh_ring *ring, pmesh_cut cut, uint32_t *start_v,
                    uint32_t *start_u)
{
    const uint32_t n = ring->face_count;

    /* Faces first .. end - 1 move to u; a ghost stands at either end. */
    uint32_t face = cut.first == PMESH_NONE ? 0 : cut.first;
    const uint32_t end = cut.end == PMESH_NONE ? n : cut.end;
    const uint32_t moved = face <= end ? end - face : n - face + end;
    for (uint32_t k = 0; k < moved; k++, face = face + 1 == n ? 0 : face + 1)
        m->vertex[ring->edge[face]] = u;

    /* Wing a: face (v, a, u) between the edge a -> v of the face before a and
     * the edge u -> a of the face behind it. */
    uint32_t at_a = PMESH_NONE, at_b = PMESH_NONE;
    if (cut.first != PMESH_NONE) {
        const uint32_t before = edge_before(ring, cut.first);
        const uint32_t behind = edge_behind(ring, cut.first);
        at_a = pmesh_mesh_add_face(m, v, ring->vertex[cut.first], u);
        pair(m, at_a, before);
        pair(m, at_a + 1, behind);
        m->twin[at_a + 2] = PMESH_NONE;
        if (behind == PMESH_NONE) /* a's boundary now starts at u */
            restart(m, ring->vertex[cut.first], before, at_a + 1);
    }
    /* Wing b: face (v, u, b) between b -> u before and v -> b behind it. */
    if (cut.end != PMESH_NONE) {
        const uint32_t before = edge_before(ring, cut.end);
        const uint32_t behind = edge_behind(ring, cut.end);
        at_b = pmesh_mesh_add_face(m, v, u, ring->vertex[cut.end]);
        pair(m, at_b + 1, before);
        pair(m, at_b + 2, behind);
        m->twin[at_b] = PMESH_NONE;
        if (behind == PMESH_NONE)
            restart(m, ring->vertex[cut.end], before, at_b + 2);
    }
    if (at_a != PMESH_NONE && at_b != PMESH_NONE)
        pair(m, at_a + 2, at_b);

    /* A boundary vertex keeps the boundary's start, unless that face went to u
     * or a new face came before it. Along the boundary u takes the part at the
     * ghost: with wing a the last faces, so u's first edge is u -> v; with wing
     * b the first faces, so u starts where v did, or at its only face. */
    *start_v = ring->edge[0];
    *start_u = at_a + 2;
    if (cut.first == PMESH_NONE) {
        *start_u = cut.end == 0 ? at_b + 1 : ring->edge[0];
        *start_v = at_b;
    } else if (!ring->open || cut.first == 0) {
        *start_v = at_a;
    }
}

void pmesh_mesh_split(pmesh_mesh *m, uint32_t v, const pmesh_ring *ring,
                      pmesh_cut cut)
{
    const uint32_t u = m->vertex_count++;
    m->parent[u] = v;
    pmesh_mesh_cut(m, v, u, ring, cut, &m->first[v], &m->first[u]);
}

static const char *check_fan(const pmesh_mesh *m, uint32_t v, uint32_t start,
                             uint8_t *seen, uint32_t *reached)
{
    if (start >= 3 * m->face_count || m->vertex[start] != v)
        return "first[] does not start at its vertex";
    uint32_t h = start;
    do {
        if (seen[h])
            return "a fan runs into itself";
        seen[h] = 1;
        ++*reached;
        h = pmesh_turn_left(m, h);
    } while (h != PMESH_NONE && h != start);
    return h == PMESH_NONE && m->twin[start] != PMESH_NONE
               ? "first[] is not at the boundary"
               : NULL;
}

const char *pmesh_mesh_check(const pmesh_mesh *m, uint8_t *seen)
{
    const uint32_t edge_count = 3 * m->face_count;
    memset(seen, 0, edge_count);

    for (uint32_t h = 0; h < edge_count; h++) {
        const uint32_t t = m->twin[h];
        if (m->vertex[h] >= m->vertex_count)
            return "a corner's vertex is out of range";
        if (m->vertex[h] == m->vertex[pmesh_next(h)])
            return "a face names a vertex twice";
        if (t == PMESH_NONE)
            continue;
        if (t >= edge_count || m->twin[t] != h)
            return "twins are not mutual";
        if (m->vertex[t] != m->vertex[pmesh_next(h)] ||
            m->vertex[h] != m->vertex[pmesh_next(t)])
            return "twins do not run opposite ways";
    }
    uint32_t reached = 0;
    for (uint32_t v = 0; v < m->vertex_count; v++) {
        uint32_t start = m->first[v], fans = 0;
        do {
            const char *broken = check_fan(m, v, start, seen, &reached);
            if (broken)
                return broken;
            if (++fans > PMESH_MAX_FANS)
                return "a vertex has too many fans";
            start = m->fan ? m->fan[start] : PMESH_NONE;
        } while (start != PMESH_NONE);
    }
    return reached == edge_count ? NULL : "a vertex has more than one fan";
}
