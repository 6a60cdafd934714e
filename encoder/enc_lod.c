/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod.h"

#include <string.h>

#include "format/alloc.h"

/* A vertex with more seams is faceted, not on a line. */
enum { MAX_SEAMS = 4 };

/* ---- rings of links ------------------------------------------------------ */

static void link(uint32_t *first, uint32_t *next, uint32_t item)
{
    if (*first == ENC_NONE) {
        *first = next[item] = item;
        return;
    }
    next[item] = next[*first];
    next[*first] = item;
}

static void unlink_item(uint32_t *first, uint32_t *next, uint32_t item)
{
    uint32_t before = item;

    while (next[before] != item)
        before = next[before];
    next[before] = next[item];
    if (*first == item)
        *first = before == item ? ENC_NONE : before;
}

/* ---- creation ------------------------------------------------------------ */

static pmesh_status allocate(enc_lod *lod)
{
    const pmesh_allocator *a = &lod->allocator;
    const size_t n = lod->vertex_count, corners = 3 * (size_t)lod->face_count;

    lod->position = pmesh_alloc(a, n, sizeof *lod->position);
    lod->first_corner = pmesh_alloc(a, n, sizeof *lod->first_corner);
    lod->corner_vertex = pmesh_alloc(a, corners, sizeof *lod->corner_vertex);
    lod->corner_wedge = pmesh_alloc(a, corners, sizeof *lod->corner_wedge);
    lod->corner_next = pmesh_alloc(a, corners, sizeof *lod->corner_next);
    lod->first_end = pmesh_alloc(a, n, sizeof *lod->first_end);
    lod->lines = pmesh_alloc_zero(a, n, sizeof *lod->lines);
    lod->lone = pmesh_alloc(a, n, sizeof *lod->lone);
    lod->normal = pmesh_alloc(a, n, sizeof *lod->normal);
    lod->mark = pmesh_alloc_zero(a, n, sizeof *lod->mark);
    return lod->position && lod->first_corner && lod->corner_vertex &&
                   lod->corner_wedge && lod->corner_next && lod->first_end &&
                   lod->lines && lod->lone && lod->normal && lod->mark
               ? PMESH_OK
               : PMESH_E_MEMORY;
}

void enc_lod_destroy(enc_lod *lod)
{
    const pmesh_allocator *a = &lod->allocator;
    const size_t n = lod->vertex_count, corners = 3 * (size_t)lod->face_count;
    const size_t ends = 2 * (size_t)lod->pair_count;

    if (!a->release)
        return;
    pmesh_release(a, lod->position, n, sizeof *lod->position);
    pmesh_release(a, lod->first_corner, n, sizeof *lod->first_corner);
    pmesh_release(a, lod->corner_vertex, corners, sizeof *lod->corner_vertex);
    pmesh_release(a, lod->corner_wedge, corners, sizeof *lod->corner_wedge);
    pmesh_release(a, lod->corner_next, corners, sizeof *lod->corner_next);
    pmesh_release(a, lod->first_end, n, sizeof *lod->first_end);
    pmesh_release(a, lod->end_vertex, ends, sizeof *lod->end_vertex);
    pmesh_release(a, lod->end_next, ends, sizeof *lod->end_next);
    pmesh_release(a, lod->lines, n, sizeof *lod->lines);
    pmesh_release(a, lod->lone, n, sizeof *lod->lone);
    pmesh_release(a, lod->normal, n, sizeof *lod->normal);
    pmesh_release(a, lod->mark, n, sizeof *lod->mark);
    *lod = (enc_lod){ 0 };
}

static void add_faces(enc_lod *lod, const uint32_t *indices,
                      const uint32_t *root, const uint32_t *wedge)
{
    for (uint32_t f = 0; f < lod->face_count; f++) {
        const uint32_t *in = &indices[3 * (size_t)f];
        const uint32_t a = root[in[0]], b = root[in[1]], c = root[in[2]];
        const bool good = a != ENC_NONE && b != ENC_NONE && c != ENC_NONE &&
                          a != b && b != c && c != a;

        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t corner = 3 * f + k, v = root[in[k]];
            lod->corner_vertex[corner] = good ? v : ENC_NONE;
            lod->corner_wedge[corner] = wedge[in[k]];
            if (!good)
                continue;
            lod->vertices += lod->first_corner[v] == ENC_NONE;
            link(&lod->first_corner[v], lod->corner_next, corner);
        }
        lod->faces += good;
    }
}

/* Calls for each neighbour of v that is greater than v: counts it, and makes
 * the pair if there is room by now. */
static void pair_up(enc_lod *lod, uint32_t v, uint32_t *count)
{
    uint32_t c = lod->first_corner[v];

    enc_lod_survey(lod, v);
    do {
        const uint32_t both[2] = { enc_lod_after(c), enc_lod_before(c) };
        for (int side = 0; side < 2; side++) {
            const uint32_t w = lod->corner_vertex[both[side]];
            if (w < v || lod->mark[w].wing)
                continue;
            lod->mark[w].wing = true; /* counted */
            if (lod->end_vertex) {
                lod->end_vertex[2 * *count] = v;
                lod->end_vertex[2 * *count + 1] = w;
                link(&lod->first_end[v], lod->end_next, 2 * *count);
                link(&lod->first_end[w], lod->end_next, 2 * *count + 1);
            }
            ++*count;
        }
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
}

static uint32_t pair_up_all(enc_lod *lod)
{
    uint32_t count = 0;

    for (uint32_t v = 0; v < lod->vertex_count; v++)
        if (lod->first_corner[v] != ENC_NONE)
            pair_up(lod, v, &count);
    return count;
}

pmesh_status enc_lod_add_pairs(enc_lod *lod, const uint32_t (*more)[2],
                               uint32_t more_count)
{
    const pmesh_allocator *a = &lod->allocator;
    const uint32_t edges = pair_up_all(lod); /* counts */
    const size_t ends = 2 * ((size_t)edges + more_count);

    if (more_count > UINT32_MAX / 2 - 1 - edges)
        return PMESH_E_LIMIT;
    lod->pair_count = edges + more_count;
    lod->end_vertex = pmesh_alloc(a, ends, sizeof *lod->end_vertex);
    lod->end_next = pmesh_alloc(a, ends, sizeof *lod->end_next);
    if (!lod->end_vertex || !lod->end_next)
        return PMESH_E_MEMORY;
    pair_up_all(lod);
    for (uint32_t i = 0; i < more_count; i++) {
        for (uint32_t k = 0; k < 2; k++) {
            const uint32_t end = 2 * (edges + i) + k;
            lod->end_vertex[end] = more[i][k];
            link(&lod->first_end[more[i][k]], lod->end_next, end);
        }
    }
    return PMESH_OK;
}

pmesh_status enc_lod_create(const pmesh_allocator *allocator,
                            const uint32_t *indices, uint32_t face_count,
                            const uint32_t *material, uint32_t vertex_count,
                            const uint32_t *root, const uint32_t *wedge,
                            const double (*position)[3], enc_lod *out)
{
    *out = (enc_lod){ .allocator = *allocator,
                      .vertex_count = vertex_count,
                      .face_count = face_count,
                      .material = material };
    const pmesh_status status = allocate(out);
    if (status != PMESH_OK) {
        enc_lod_destroy(out);
        return status;
    }
    memset(out->first_corner, 0xff, vertex_count * sizeof *out->first_corner);
    memset(out->first_end, 0xff, vertex_count * sizeof *out->first_end);
    memcpy(out->position, position, vertex_count * sizeof *position);
    add_faces(out, indices, root, wedge);
    return PMESH_OK;
}

/* ---- survey -------------------------------------------------------------- */

static void touch(enc_lod *lod, uint32_t near, uint32_t far)
{
    enc_lod_mark *m = &lod->mark[lod->corner_vertex[far]];
    const uint32_t wedge_near = lod->corner_wedge[near];
    const uint32_t wedge_far = lod->corner_wedge[far];
    const uint32_t material = lod->material ? lod->material[near / 3] : 0;

    if (m->stamp != lod->stamp) {
        *m = (enc_lod_mark){ lod->stamp, 1,     wedge_near, wedge_far,
                             material,   false, false };
        return;
    }
    m->faces++;
    m->breaks |= m->wedge_near != wedge_near || m->wedge_far != wedge_far ||
                 m->material != material;
}

void enc_lod_survey(enc_lod *lod, uint32_t v)
{
    const uint32_t first = lod->first_corner[v];
    uint32_t c = first, lone = lod->corner_wedge[c], seams = 0;
    bool rim = false;

    if (++lod->stamp == 0) {
        memset(lod->mark, 0, lod->vertex_count * sizeof *lod->mark);
        lod->stamp = 1;
    }
    do {
        touch(lod, c, enc_lod_after(c));
        touch(lod, c, enc_lod_before(c));
        if (lod->corner_wedge[c] != lone)
            lone = ENC_NONE;
    } while ((c = lod->corner_next[c]) != first);
    do {
        const enc_lod_mark *m =
            &lod->mark[lod->corner_vertex[enc_lod_after(c)]];
        const enc_lod_mark *n =
            &lod->mark[lod->corner_vertex[enc_lod_before(c)]];
        rim |= m->faces != 2 || n->faces != 2;
        seams += m->breaks + n->breaks;
    } while ((c = lod->corner_next[c]) != first);
    lod->lines[v] =
        (uint8_t)((rim ? ENC_LOD_RIM : 0) |
                  (seams > 0 && seams <= 2 * MAX_SEAMS ? ENC_LOD_SEAM : 0));
    lod->lone[v] = lone;
}

void enc_lod_sum_normals(enc_lod *lod, uint32_t v)
{
    uint32_t c = lod->first_corner[v];
    double *sum = lod->normal[v];

    sum[0] = sum[1] = sum[2] = 0;
    do {
        double n[3];
        enc_lod_normal(lod, c, lod->position[v], n);
        for (int i = 0; i < 3; i++)
            sum[i] += n[i];
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
}

/* ---- contraction --------------------------------------------------------- */

static void kill_pair(enc_lod *lod, uint32_t pair)
{
    for (uint32_t end = 2 * pair; end < 2 * pair + 2; end++) {
        unlink_item(&lod->first_end[lod->end_vertex[end]], lod->end_next, end);
        lod->end_vertex[end] = ENC_NONE;
    }
}

static void kill_vertex(enc_lod *lod, uint32_t v)
{
    while (lod->first_end[v] != ENC_NONE)
        kill_pair(lod, lod->first_end[v] / 2);
    lod->vertices--;
}

/* A third vertex that has no other face goes, too: its piece is vanishing. */
static void kill_face(enc_lod *lod, uint32_t face, uint32_t gone, uint32_t kept)
{
    for (uint32_t c = 3 * face; c < 3 * face + 3; c++) {
        const uint32_t v = lod->corner_vertex[c];
        unlink_item(&lod->first_corner[v], lod->corner_next, c);
        lod->corner_vertex[c] = ENC_NONE;
        if (v != gone && v != kept && lod->first_corner[v] == ENC_NONE)
            kill_vertex(lod, v);
    }
    lod->faces--;
}

static uint32_t ring_size(uint32_t first, const uint32_t *next)
{
    uint32_t item = first, count = 0;

    if (first == ENC_NONE)
        return 0;
    do
        count++;
    while ((item = next[item]) != first);
    return count;
}

static void splice(uint32_t *to, uint32_t *from, uint32_t *next)
{
    if (*from == ENC_NONE)
        return;
    if (*to == ENC_NONE) {
        *to = *from;
    } else {
        const uint32_t after = next[*to];
        next[*to] = next[*from];
        next[*from] = after;
    }
    *from = ENC_NONE;
}

static void move_faces(enc_lod *lod, uint32_t gone, uint32_t kept)
{
    uint32_t c = lod->first_corner[gone];

    for (uint32_t n = ring_size(c, lod->corner_next); n > 0; n--) {
        const uint32_t next = lod->corner_next[c];
        if (enc_lod_corner_of(lod, c, kept) != ENC_NONE)
            kill_face(lod, c / 3, gone, kept);
        else
            lod->corner_vertex[c] = kept;
        c = next;
    }
    splice(&lod->first_corner[kept], &lod->first_corner[gone],
           lod->corner_next);
}

/* Of two pairs with a common neighbour the one of `kept` stays. */
static void move_pairs(enc_lod *lod, uint32_t gone, uint32_t kept)
{
    uint32_t end = lod->first_end[kept];

    ++lod->stamp;
    for (uint32_t n = ring_size(end, lod->end_next); n > 0; n--) {
        lod->mark[lod->end_vertex[end ^ 1]].stamp = lod->stamp;
        end = lod->end_next[end];
    }
    end = lod->first_end[gone];
    for (uint32_t n = ring_size(end, lod->end_next); n > 0; n--) {
        const uint32_t next = lod->end_next[end];
        if (lod->mark[lod->end_vertex[end ^ 1]].stamp == lod->stamp)
            kill_pair(lod, end / 2);
        else
            lod->end_vertex[end] = kept;
        end = next;
    }
    splice(&lod->first_end[kept], &lod->first_end[gone], lod->end_next);
}

void enc_lod_contract(enc_lod *lod, uint32_t pair, uint32_t gone, uint32_t kept)
{
    kill_pair(lod, pair);
    move_faces(lod, gone, kept);
    move_pairs(lod, gone, kept);
    lod->vertices--;
    if (lod->first_corner[kept] == ENC_NONE)
        kill_vertex(lod, kept);
}

/* Two faces that show each other their backs, over the same vertices. */
static bool backs(const enc_lod *lod, uint32_t c, uint32_t d)
{
    return lod->corner_vertex[enc_lod_after(c)] ==
               lod->corner_vertex[enc_lod_before(d)] &&
           lod->corner_vertex[enc_lod_before(c)] ==
               lod->corner_vertex[enc_lod_after(d)];
}

static bool cancel_one(enc_lod *lod, uint32_t v)
{
    const uint32_t first = lod->first_corner[v];
    uint32_t c = first;

    if (first == ENC_NONE)
        return false;
    do {
        for (uint32_t d = lod->corner_next[c]; d != first;
             d = lod->corner_next[d]) {
            if (!backs(lod, c, d))
                continue;
            kill_face(lod, c / 3, v, v);
            kill_face(lod, d / 3, v, v);
            return true;
        }
    } while ((c = lod->corner_next[c]) != first);
    return false;
}

void enc_lod_cancel(enc_lod *lod, uint32_t v)
{
    if (lod->first_corner[v] == ENC_NONE)
        return;
    while (cancel_one(lod, v))
        ;
    if (lod->first_corner[v] == ENC_NONE)
        kill_vertex(lod, v);
}
