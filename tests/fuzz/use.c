/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/fuzz.h"
#include "tests/unit/shapes.h"

/* Buffers as an engine has them, for full detail, and what they must hold. */
typedef struct mirror {
    pmesh_header h;
    pmesh_buffers out;
    float *expected; /* room for any tuples of all output vertices */
} mirror;

static mirror mirror_make(const pmesh_decoder *dec, fuzz_dice *dice)
{
    mirror m;
    FUZZ_CHECK(pmesh_decoder_header(dec, &m.h) == PMESH_OK);
    m.out = (pmesh_buffers){ .index_size = 4 };
    if (m.h.vertices <= 65536 && fuzz_draw(dice, 2))
        m.out.index_size = 2;
    m.out.indices = fuzz_room(3 * (size_t)m.out.index_size * m.h.faces);
    m.out.positions = fuzz_room(12 * (size_t)m.h.vertices);
    for (uint32_t i = 0; i < m.h.attribute_count; i++)
        m.out.attributes[i] =
            fuzz_room(4u * m.h.attributes[i].components *
                      (size_t)m.h.vertices);
    m.expected = fuzz_room(16 * (size_t)m.h.vertices);
    return m;
}

static void mirror_free(mirror *m)
{
    for (uint32_t i = 0; i < m->h.attribute_count; i++)
        free(m->out.attributes[i]);
    free(m->out.indices);
    free(m->out.positions);
    free(m->expected);
}

/* The bound buffers show the visible mesh, bit for bit. */
static void mirror_check(mirror *m, const pmesh_decoder *dec)
{
    pmesh_view v;
    FUZZ_CHECK(pmesh_decoder_mesh(dec, &v) == PMESH_OK);
    for (size_t i = 0; i < 3 * (size_t)v.face_count; i++)
        FUZZ_CHECK(v.indices[i] ==
                   (m->out.index_size == 2
                        ? ((const uint16_t *)m->out.indices)[i]
                        : ((const uint32_t *)m->out.indices)[i]));
    FUZZ_CHECK(pmesh_decoder_copy_positions(dec, m->expected, 0) == PMESH_OK);
    FUZZ_CHECK(memcmp(m->expected, m->out.positions,
                      12 * (size_t)v.vertex_count) == 0);
    for (uint32_t i = 0; i < m->h.attribute_count; i++) {
        FUZZ_CHECK(pmesh_decoder_copy_attribute(dec, i, m->expected, 0) ==
                   PMESH_OK);
        FUZZ_CHECK(memcmp(m->expected, m->out.attributes[i],
                          4u * m->h.attributes[i].components *
                              (size_t)v.vertex_count) == 0);
    }
}

static void check_ranges(const pmesh_range *range, uint32_t count,
                         uint32_t end)
{
    uint32_t at = 0;
    FUZZ_CHECK(count <= PMESH_MAX_RANGES);
    for (uint32_t i = 0; i < count; i++) {
        FUZZ_CHECK(range[i].count > 0 && range[i].first >= at);
        FUZZ_CHECK(range[i].count <= end - range[i].first);
        at = range[i].first + range[i].count;
    }
}

/* Goes to a budget, in steps or at once. */
static uint32_t go(pmesh_decoder *dec, uint32_t faces, uint32_t max_ops)
{
    const pmesh_target target = { .faces = faces, .max_ops = max_ops };
    pmesh_changes changes;
    pmesh_status status;
    pmesh_view v;
    do {
        status = pmesh_decoder_refine(dec, &target, &changes);
        FUZZ_CHECK(status == PMESH_OK || (status == PMESH_MORE && max_ops));
        pmesh_decoder_mesh(dec, &v);
        check_ranges(changes.vertices, changes.vertex_range_count,
                     v.vertex_count);
        check_ranges(changes.faces, changes.face_range_count, v.face_count);
    } while (status == PMESH_MORE);
    return v.face_count;
}

/* Faces shown rise with the budget and never exceed it; coming from below or
 * above shows the same. */
static void climb(pmesh_decoder *dec, mirror *m, fuzz_dice *dice)
{
    const uint32_t all = pmesh_decoder_progress(dec).faces;
    const uint32_t a = m->h.base_faces +
                       fuzz_draw(dice, all - m->h.base_faces + 1);
    const uint32_t b = a + fuzz_draw(dice, all - a + 1);
    const uint32_t shown_b = go(dec, b, 0);
    mirror_check(m, dec);
    const uint32_t shown_a = go(dec, a, 1 + fuzz_draw(dice, 1000));
    mirror_check(m, dec);
    FUZZ_CHECK(shown_a <= a && shown_b <= b && shown_a <= shown_b);
    fuzz_sound(dec);
    const uint64_t hash = shape_view_hash(dec);
    FUZZ_CHECK(go(dec, 1, 0) == m->h.base_faces);
    FUZZ_CHECK(go(dec, a, 0) == shown_a && shape_view_hash(dec) == hash);
    mirror_check(m, dec);
}

static void check_groups(const pmesh_decoder *dec, mirror *m)
{
    pmesh_range *group = fuzz_room(m->h.material_count * sizeof *group);
    pmesh_view v;
    uint32_t sum = 0;
    pmesh_decoder_mesh(dec, &v);
    void *sorted = fuzz_room(12 * (size_t)v.face_count);
    FUZZ_CHECK(pmesh_decoder_copy_indices(dec, sorted, 4, group) == PMESH_OK);
    for (uint32_t i = 0; i < m->h.material_count; i++)
        sum += group[i].count;
    FUZZ_CHECK(sum == v.face_count);
    free(sorted);
    free(group);
}

static void look_around(pmesh_decoder *dec, mirror *m, fuzz_dice *dice)
{
    const pmesh_target low = { .faces = 1 + fuzz_draw(dice, m->h.faces) };
    const pmesh_target far = { .error = fuzz_draw(dice, 100) / 100.0,
                               .bytes = fuzz_draw(dice, 100000) };
    const double from[3] = { 0.1, 0.2, 9 }, along[3] = { 0.01, 0, -1 };
    double a[3], b[3];
    pmesh_hit hit;
    pmesh_view v;

    pmesh_decoder_refine(dec, &far, NULL);
    fuzz_sound(dec);
    pmesh_decoder_mesh(dec, &v);
    void *room = fuzz_room(pmesh_decoder_inflate_room(dec));
    float *xyz = fuzz_room(12 * (size_t)v.vertex_count);
    FUZZ_CHECK(pmesh_decoder_copy_inflated(dec, xyz, 0, room) == PMESH_OK);
    FUZZ_CHECK(pmesh_decoder_copy_morph(dec, &low, xyz, 0) == PMESH_OK);
    FUZZ_CHECK(pmesh_decoder_bounds(dec, a, b) == PMESH_OK);
    if (pmesh_decoder_raycast(dec, from, along, &hit))
        FUZZ_CHECK(hit.face < v.face_count && hit.distance >= 0);
    for (uint32_t i = 0; i < v.mesh_vertex_count && i < 1000; i++)
        FUZZ_CHECK(pmesh_decoder_parent(dec, i) == UINT32_MAX ||
                   pmesh_decoder_parent(dec, i) < i);
    free(xyz);
    free(room);
}

void fuzz_use(pmesh_decoder *dec, fuzz_dice *dice)
{
    fuzz_sound(dec);
    if (pmesh_decoder_refine(dec, NULL, NULL) != PMESH_OK)
        return;
    fuzz_sound(dec);
    mirror m = mirror_make(dec, dice);
    FUZZ_CHECK(pmesh_decoder_bind(dec, &m.out) == PMESH_OK);
    mirror_check(&m, dec);
    climb(dec, &m, dice);
    look_around(dec, &m, dice);
    check_groups(dec, &m);
    mirror_check(&m, dec);
    FUZZ_CHECK(pmesh_decoder_bind(dec, NULL) == PMESH_OK);
    mirror_free(&m);
}
