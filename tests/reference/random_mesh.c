/* SPDX-License-Identifier: MIT */
#include "tests/reference/random_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/golden/golden_mesh.h"

/* A golden mesh, small, that gets spoilt; and attributes of its own. */
typedef struct random_mesh {
    golden_mesh golden;
    pmesh_mesh_input *input;
    uint32_t seed;
    pmesh_attribute_input channel[PMESH_MAX_ATTRIBUTES];
    float *values[PMESH_MAX_ATTRIBUTES];
    uint32_t *indices[PMESH_MAX_ATTRIBUTES], *materials;
} random_mesh;

static uint32_t below(random_mesh *m, uint32_t n)
{
    return shape_random(&m->seed, n);
}

static bool one_in(random_mesh *m, uint32_t n)
{
    return below(m, n) == 0;
}

/* -1 .. 1 */
static double fraction(random_mesh *m)
{
    return below(m, 2001) / 1000.0 - 1;
}

/* ---- topology ----------------------------------------------------------- */

static void make_shape(random_mesh *m)
{
    static const struct {
        int kind;
        uint32_t least, more;
    } kinds[] = {
        { SHAPE_SPHERE, 3, 6 },    { SHAPE_TERRAIN, 2, 11 },
        { SHAPE_TORUS, 4, 9 },     { SHAPE_FACETS, 4, 5 },
        { SHAPE_SOUP, 5, 40 },     { SHAPE_PIECES, 1, 30 },
        { GOLDEN_TRIANGLE, 3, 1 }, { GOLDEN_FAN, 5, 12 },
        { GOLDEN_SPINDLE, 5, 12 }, { GOLDEN_FAN, 40, 16 },
        { GOLDEN_SPINDLE, 40, 16 }, { GOLDEN_SPIKES, 4, 9 },
        { GOLDEN_LEAVES, 4, 12 }
    };
    const size_t count = sizeof kinds / sizeof *kinds;
    uint32_t i = below(m, (uint32_t)count);
    if (kinds[i].least == 40 && !one_in(m, 3))
        i = 1;
    golden_mesh_make(&m->golden, kinds[i].kind,
                     kinds[i].least + below(m, kinds[i].more));
    m->input = &m->golden.shape->input;
}

/* Makes one vertex of two: pinches, fins, faces that vanish. */
static void join_vertices(random_mesh *m)
{
    const uint32_t n = (uint32_t)m->input->vertex_count;
    uint32_t *index = m->golden.shape->indices;
    const uint32_t a = below(m, n), b = below(m, n);
    for (size_t i = 0; i < 3 * m->input->face_count; i++)
        if (index[i] == a)
            index[i] = b;
}

static void drop_face(random_mesh *m)
{
    uint32_t *index = m->golden.shape->indices;
    const size_t last = 3 * (m->input->face_count - 1);
    const size_t f = 3 * (size_t)below(m, (uint32_t)m->input->face_count);
    if (last == 0)
        return;
    memmove(index + f, index + last, 3 * sizeof *index);
    m->input->face_count--;
}

static void turn_face(random_mesh *m)
{
    uint32_t *f = m->golden.shape->indices +
                  3 * (size_t)below(m, (uint32_t)m->input->face_count);
    const uint32_t keep = f[0];
    f[0] = f[1];
    f[1] = keep;
}

static void spoil_faces(random_mesh *m)
{
    for (uint32_t n = one_in(m, 2) ? below(m, 6) : 0; n > 0; n--)
        join_vertices(m);
    uint32_t n = one_in(m, 2) ? below(m, 8) : 0;
    if (one_in(m, 8))
        n = (uint32_t)m->input->face_count / 2;
    for (; n > 0; n--)
        drop_face(m);
    for (n = one_in(m, 6) ? below(m, 4) : 0; n > 0; n--)
        turn_face(m);
}

/* ---- positions ---------------------------------------------------------- */

static double rounded(double x, double step)
{
    return floor(x / step + 0.5) * step;
}

static void spoil_positions(random_mesh *m)
{
    static const double noises[] = { 0, 0, 0, 1e-4, 0.02, 0.3 };
    static const double steps[] = { 0, 0, 0.001, 0.125, 0.5 };
    static const double sizes[] = { 1, 1, 1e-40, 3e30, 1e5 };
    const double noise = noises[below(m, 6)], step = steps[below(m, 5)];
    const double size = one_in(m, 4) ? sizes[below(m, 5)] : 1;
    const double far = one_in(m, 6) ? 1e4 : 0;
    for (size_t i = 0; i < 3 * m->input->vertex_count; i++) {
        double *p = &m->golden.shape->positions[i];
        *p += noise * fraction(m);
        if (step > 0)
            *p = rounded(*p, step);
        *p = size * (*p + far);
        if (one_in(m, 40))
            *p = one_in(m, 2) ? 0.0 : -0.0;
        if (*p != 0 && one_in(m, 400))
            *p *= 1 + 1e-3 * fraction(m);
    }
}

/* ---- attributes --------------------------------------------------------- */

/* Which tuple a corner has: its vertex', its face's, any of a few, ... */
static uint32_t *choose_tuples(random_mesh *m, uint32_t *count)
{
    const size_t corners = 3 * m->input->face_count;
    const uint32_t way = below(m, 5), few = 1 + below(m, 5);
    uint32_t *index = calloc(corners, sizeof *index);
    *count = (uint32_t)m->input->vertex_count;
    if (way == 0) {
        free(index);
        return NULL;
    }
    for (uint32_t i = 0; i < corners; i++) {
        const uint32_t v = m->golden.shape->indices[i];
        index[i] = way == 1   ? i / 3 % *count
                   : way == 2 ? below(m, few)
                   : way == 3 ? (i / 3 / 8 + v) % *count
                              : (one_in(m, 12) ? below(m, few) : v);
        index[i] %= *count;
    }
    return index;
}

static void add_channel(random_mesh *m, const double *wave)
{
    static const uint8_t least[] = { 3, 2, 3, 1 }, more[] = { 1, 1, 2, 4 };
    const size_t i = m->input->attribute_count;
    const uint32_t kind = below(m, 4);
    pmesh_attribute_input *a = &m->channel[i];
    uint32_t count;
    m->indices[i] = choose_tuples(m, &count);
    *a = (pmesh_attribute_input){
        .kind = (pmesh_attribute_kind)kind,
        .set = (uint8_t)below(m, 3),
        .components = (uint8_t)(least[kind] + below(m, more[kind])),
        .bits = one_in(m, 4) ? 0 : (uint8_t)(4 + below(m, 13)),
        .count = count,
        .indices = m->indices[i]
    };
    m->values[i] = calloc((size_t)count * a->components, sizeof(float));
    for (uint32_t k = 0; k < count * a->components; k++)
        m->values[i][k] =
            (float)(wave[0] * sin(wave[1] * k) + wave[2] * fraction(m));
    a->values = m->values[i];
    m->input->attribute_count++;
}

static void add_channels(random_mesh *m)
{
    uint32_t count = one_in(m, 12) ? 8 : below(m, 4);
    if (one_in(m, 4)) /* those that the shape comes with, if it still can */
        return;
    m->input->attribute_count = 0;
    for (; count > 0; count--) {
        const double wave[] = { fraction(m), fraction(m) / 10,
                                one_in(m, 2) ? 0 : fraction(m) };
        add_channel(m, wave);
    }
    m->input->attributes = m->channel;
}

static void add_materials(random_mesh *m)
{
    static const char *const names[] = { "skin", "", "gold \xc3\xa9" };
    const uint32_t count = one_in(m, 5) ? 300 : 2 + below(m, 4);
    const uint32_t patch = 1 + below(m, 20), odd = 2 + below(m, 30);
    m->input->materials = NULL;
    m->input->material_names = NULL;
    m->input->material_count = 0;
    if (!one_in(m, 3))
        return;
    m->materials = calloc(m->input->face_count, sizeof *m->materials);
    for (uint32_t f = 0; f < m->input->face_count; f++)
        m->materials[f] =
            (one_in(m, odd) ? below(m, count) : f / patch) % count;
    m->input->materials = m->materials;
    m->input->material_count = count;
    if (count == 3)
        m->input->material_names = names;
}

static void random_mesh_free(random_mesh *m)
{
    for (int i = 0; i < PMESH_MAX_ATTRIBUTES; i++) {
        free(m->values[i]);
        free(m->indices[i]);
    }
    free(m->materials);
    golden_mesh_free(&m->golden);
}

/* ---- baking ------------------------------------------------------------- */

static pmesh_encoder_config choose_config(random_mesh *m)
{
    pmesh_encoder_config c = pmesh_encoder_config_default();
    c.profile = (pmesh_profile)below(m, 3);
    c.placement = one_in(m, 2) ? PMESH_OPTIMAL : PMESH_SUBSET;
    c.metric = one_in(m, 4) ? PMESH_ACCUMULATED : PMESH_MEMORYLESS;
    c.position_bits =
        one_in(m, 3) ? 14 : (uint8_t)(4 + below(m, 21));
    c.lossless = one_in(m, 3);
    c.measure = one_in(m, 16);
    c.topology = (pmesh_topology)below(m, 3);
    if (c.topology != PMESH_TOPOLOGY_KEEP && one_in(m, 4))
        c.threshold = 0.2 * (1 + fraction(m));
    c.base_faces = one_in(m, 4) ? 1 + below(m, 60) : 1;
    return c;
}

pmesh_status random_file(uint32_t seed, shape_bytes *out)
{
    random_mesh m = { .seed = seed * 2654435761u + 12345 };
    pmesh_encode_report report;
    make_shape(&m);
    /* The shape's own per-corner arrays go by face and stay as they are. */
    spoil_positions(&m);
    spoil_faces(&m);
    add_channels(&m);
    add_materials(&m);
    const pmesh_encoder_config config = choose_config(&m);
    const pmesh_status status =
        shape_bake(m.golden.shape, &config, out, &report);
    random_mesh_free(&m);
    return status;
}
