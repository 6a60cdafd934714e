/* SPDX-License-Identifier: MIT */
#include "encoder/enc_mesh.h"
#include "format/quantize.h"
#include "tests/unit/import_trial.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* A random soup on few vertices, with everything that can be wrong. */
typedef struct soup {
    double xyz[64][3];
    uint32_t faces[200][3], materials[200], tuples[200][3];
    float values[16][2];
    pmesh_attribute_input attribute;
} soup;

static trial make_soup(soup *s, uint32_t seed)
{
    uint32_t random = seed * 7919 + 1;
    const uint32_t vertices = 4 + import_random(&random) % 60;
    const uint32_t faces = 1 + import_random(&random) % 200;
    const uint32_t side = 2 + import_random(&random) % 4;

    for (uint32_t v = 0; v < vertices; v++)
        for (int k = 0; k < 3; k++)
            s->xyz[v][k] = import_random(&random) % side;
    if (seed % 7 == 0)
        s->xyz[0][1] = NAN;
    for (uint32_t i = 0; i < faces; i++) {
        for (int k = 0; k < 3; k++) {
            s->faces[i][k] = import_random(&random) % vertices;
            s->tuples[i][k] = import_random(&random) % 16;
        }
        s->materials[i] = import_random(&random) % 2;
    }
    for (int i = 0; i < 16; i++)
        for (int k = 0; k < 2; k++)
            s->values[i][k] = (float)(import_random(&random) % 3);
    s->attribute = (pmesh_attribute_input){
        .kind = PMESH_GENERIC, .components = 2, .values = s->values[0],
        .count = 16, .indices = s->tuples[0]
    };
    trial t = import_trial_of(s->xyz[0], vertices, s->faces[0], faces);
    t.in.materials = seed % 3 ? NULL : s->materials;
    t.in.material_count = 2;
    t.in.attributes = &s->attribute;
    t.in.attribute_count = seed % 2;
    return t;
}

typedef struct flat_face {
    int32_t corner[3][3];
    uint32_t material;
} flat_face;

static int compare_faces(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(flat_face));
}

/* With the least corner first, so that rotation does not matter. */
static void rotate_face(flat_face *face)
{
    const size_t size = sizeof face->corner[0];

    for (int i = 0; i < 2; i++) {
        if (memcmp(face->corner[0], face->corner[1], size) <= 0 &&
            memcmp(face->corner[0], face->corner[2], size) <= 0)
            return;
        int32_t first[3];
        memcpy(first, face->corner[0], size);
        memmove(face->corner[0], face->corner[1], 2 * size);
        memcpy(face->corner[2], first, size);
    }
}

/* The input's faces by grid position, without those that must go: sorted, and
 * equal ones united. Positions of soups are equal only if they are welded. */
static size_t expected_faces(const trial *t, flat_face *out)
{
    size_t count = 0, kept = 0;

    for (size_t i = 0; i < t->in.face_count; i++) {
        flat_face *face = &out[count];
        bool finite = true;
        face->material = t->in.materials ? t->in.materials[i] : 0;
        for (size_t j = 0; j < 3; j++) {
            for (int k = 0; k < 3; k++) {
                const double x =
                    t->in.positions[3 * t->in.indices[3 * i + j] +
                                    (size_t)k];
                finite &= x == x;
                face->corner[j][k] =
                    pmesh_grid_quantize(&t->report.grid, k, x);
            }
        }
        const size_t size = sizeof face->corner[0];
        rotate_face(face);
        count += finite &&
            memcmp(face->corner[0], face->corner[1], size) != 0 &&
            memcmp(face->corner[1], face->corner[2], size) != 0 &&
            memcmp(face->corner[2], face->corner[0], size) != 0;
    }
    qsort(out, count, sizeof *out, compare_faces);
    for (size_t i = 0; i < count; i++)
        if (i == 0 || compare_faces(&out[i], &out[kept - 1]) != 0)
            out[kept++] = out[i];
    return kept;
}

TEST(import_conserves_the_faces_of_random_soups)
{
    static soup s;
    static flat_face expected[200], actual[200];

    for (uint32_t seed = 0; seed < 2000; seed++) {
        trial t = make_soup(&s, seed);
        const pmesh_status status = import_run(&t);
        if (status) {
            CHECK(status == PMESH_E_NO_FACES || status == PMESH_E_NOT_FINITE);
            continue;
        }
        for (uint32_t i = 0; i < t.mesh.face_count; i++) {
            for (uint32_t j = 0; j < 3; j++)
                memcpy(actual[i].corner[j],
                       t.mesh.position[t.mesh.vertex[3 * i + j]],
                       sizeof actual[i].corner[j]);
            actual[i].material = t.mesh.material[i];
            rotate_face(&actual[i]);
        }
        qsort(actual, t.mesh.face_count, sizeof *actual, compare_faces);
        CHECK(expected_faces(&t, expected) == t.mesh.face_count);
        CHECK(memcmp(actual, expected,
                     t.mesh.face_count * sizeof *actual) == 0);
        import_finish(&t);
    }
}

TEST(import_keeps_attributes_of_random_soups)
{
    static soup s;

    for (uint32_t seed = 1; seed < 400; seed += 2) {
        trial t = make_soup(&s, seed);
        if (import_run(&t))
            continue;
        CHECK(t.mesh.value_count == 2);
        uint32_t previous = 0;
        for (uint32_t w = 0; w < t.mesh.wedge_count; w++) {
            CHECK(t.mesh.wedge_vertex[w] >= previous); /* by vertex */
            previous = t.mesh.wedge_vertex[w];
            for (uint32_t v = w;
                 v-- > 0 && t.mesh.wedge_vertex[v] == previous;)
                CHECK(memcmp(t.mesh.value + 2 * w, t.mesh.value + 2 * v,
                             2 * sizeof *t.mesh.value) != 0);
        }
        import_finish(&t);
    }
}

TEST(import_survives_every_failing_allocation)
{
    static soup s;

    for (uint32_t seed = 1; seed < 40; seed++) {
        size_t allowed = 0;
        for (;; allowed++) {
            trial t = make_soup(&s, seed);
            t.config.weld = seed % 5 == 0 ? 0.5 : 0;
            t.acc.allowed = allowed;
            t.config.allocator =
                (pmesh_allocator){ import_alloc, import_release, &t.acc };
            const pmesh_status status =
                enc_mesh_import(&t.in, &t.config, NULL, &t.mesh, &t.report);
            if (status)
                CHECK(t.acc.bytes == 0);
            enc_mesh_destroy(&t.mesh);
            CHECK(t.acc.bytes == 0);
            if (status != PMESH_E_MEMORY)
                break;
        }
        CHECK(allowed > 3);
    }
}

/* `count` triangles around vertex 0, or all on the edge 0-1, or apart. */
typedef enum crowd_kind { CROWD_FAN, CROWD_EDGE, CROWD_APART } crowd_kind;

static void check_crowd(crowd_kind kind, uint32_t count)
{
    double *xyz = calloc(3 * (size_t)count + 6, 3 * sizeof *xyz);
    uint32_t *faces = calloc(3 * (size_t)count, sizeof *faces);
    uint32_t vertices = kind == CROWD_APART ? 3 * count : count + 2;

    CHECK(xyz && faces);
    for (uint32_t v = 0; v < 3 * vertices; v++)
        xyz[v] = (double)(v * v % 65521);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t spoke = 2 + i, next = 2 + (i + 1) % count;
        const uint32_t fan[3] = { 0, spoke, next };
        const uint32_t edge[3] = { i % 2, 1 - i % 2, spoke };
        const uint32_t apart[3] = { 3 * i, 3 * i + 1, 3 * i + 2 };
        memcpy(faces + 3 * i,
               kind == CROWD_FAN ? fan : kind == CROWD_EDGE ? edge : apart,
               sizeof fan);
    }
    trial t = import_trial_of(xyz, vertices, faces, count);
    CHECK(import_run(&t) == PMESH_OK);
    CHECK(t.report.faces == count);
    CHECK(t.acc.peak < 4096 + 150 * (size_t)count);
    import_finish(&t);
    free(faces);
    free(xyz);
}

TEST(import_is_linear_on_crowds)
{
    check_crowd(CROWD_FAN, 70000);
    check_crowd(CROWD_EDGE, 1000);
    check_crowd(CROWD_EDGE, 70000);
    check_crowd(CROWD_APART, 10000);
}
