/* SPDX-License-Identifier: MIT */
#include "format/tangent.h"

#include "format/octant.h"
#include "format/star.h"

enum {
    SUM_BITS = 20,  /* of a sum over faces, to be made normal to the normal */
    LENGTH_BITS = 15
};

static void scale_to(int64_t v[3], int bits)
{
    uint64_t all = 1;
    for (int k = 0; k < 3; k++)
        all |= (uint64_t)(v[k] < 0 ? -v[k] : v[k]);
    for (int k = 0; k < 3; k++)
        v[k] = pmesh_scale(v[k], bits - (int)pmesh_bit_length(all));
}

static const uint16_t *value_of(const pmesh_codec *c, uint32_t w,
                                uint32_t channel)
{
    return c->mesh.value + (size_t)w * c->mesh.value_count +
           c->channel[channel].first;
}

/* p, q: the ways to the next and the previous corner, (a, b) and (c, d) in the
 * texture. Where one goes to go along the first coordinate alone is p d - q b,
 * turned if the texture is mirrored. Below 2^43. */
static void add_face(const pmesh_codec *c, uint32_t h, uint32_t w,
                     int64_t sum[3])
{
    const pmesh_mesh *m = &c->mesh;
    const uint32_t next = pmesh_next(h), prev = pmesh_prev(h);
    if (m->wedge[next] >= w || m->wedge[prev] >= w)
        return;
    const uint16_t *at = value_of(c, w, c->tangent_map);
    const uint16_t *to = value_of(c, m->wedge[next], c->tangent_map);
    const uint16_t *from = value_of(c, m->wedge[prev], c->tangent_map);
    const int64_t a = to[0] - at[0], b = to[1] - at[1];
    const int64_t e = from[0] - at[0], d = from[1] - at[1];
    const int sign = a * d < b * e ? -1 : 1;
    const int32_t *here = m->position[m->vertex[h]];
    const int32_t *p = m->position[m->vertex[next]];
    const int32_t *q = m->position[m->vertex[prev]];
    for (int k = 0; k < 3; k++)
        sum[k] += sign * ((p[k] - here[k]) * d - (q[k] - here[k]) * b);
}

/* Leaves what is normal to n. */
static void flatten(int64_t v[3], const int32_t n[3])
{
    int64_t square = 0, along = 0;
    for (int k = 0; k < 3; k++) {
        square += (int64_t)n[k] * n[k];
        along += n[k] * v[k];
    }
    for (int k = 0; k < 3; k++)
        v[k] -= n[k] * along / square;
}

void pmesh_tangent(const pmesh_codec *c, uint32_t w, int64_t tangent[3])
{
    const pmesh_mesh *m = &c->mesh;
    const uint32_t start = c->wedge_corner[w];
    const int32_t centre =
        (int32_t)(c->component_max[c->channel[c->tangent_normal].first] / 2);
    uint32_t h = start, count = 0, square = 0;
    int32_t normal[3];
    tangent[0] = tangent[1] = tangent[2] = 0;
    do {
        add_face(c, h, w, tangent);
        h = pmesh_turn_left(m, h);
        count++;
    } while (h != PMESH_NONE && h != start && m->wedge[h] == w &&
             count < PMESH_MAX_RING);
    scale_to(tangent, SUM_BITS);
    pmesh_octant_unfold(value_of(c, w, c->tangent_normal), centre, normal);
    flatten(tangent, normal);
    scale_to(tangent, LENGTH_BITS);
    for (int k = 0; k < 3; k++)
        square += (uint32_t)(tangent[k] * tangent[k]);
    const int64_t length = pmesh_isqrt(square);
    for (int k = 0; k < 3; k++)
        tangent[k] = length ? tangent[k] * (1 << PMESH_TANGENT_BITS) / length
                            : 0;
}
