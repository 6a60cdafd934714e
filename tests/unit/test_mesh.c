/* SPDX-License-Identifier: MIT */
#include "format/mesh.h"

#include <stdlib.h>
#include <string.h>

#include "tests/unit/random_cut.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

enum { CAPACITY = 600 };

typedef struct store {
    pmesh_mesh mesh;
    uint32_t vertex[3 * 2 * CAPACITY], twin[3 * 2 * CAPACITY];
    uint32_t first[CAPACITY], parent[CAPACITY];
    uint8_t seen[3 * 2 * CAPACITY];
} store;

static store *store_make(uint32_t vertices, uint32_t faces,
                         const uint32_t *corners, const uint32_t *twins)
{
    store *s = calloc(1, sizeof *s);
    s->mesh = (pmesh_mesh){
        .vertex_count = vertices, .vertex_capacity = CAPACITY,
        .face_count = faces, .face_capacity = 2 * CAPACITY,
        .vertex = s->vertex, .twin = s->twin,
        .first = s->first, .parent = s->parent
    };
    for (uint32_t h = 0; h < 3 * faces; h++) {
        s->vertex[h] = corners[h];
        s->twin[h] = twins[h];
    }
    for (uint32_t h = 3 * faces; h-- > 0;)
        if (s->twin[h] == PMESH_NONE || s->first[corners[h]] == 0)
            s->first[corners[h]] = h;
    return s;
}

static store *tetrahedron(void)
{
    static const uint32_t corners[] = { 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2 };
    static const uint32_t twins[] = { 11, 6, 3, 2, 8, 9, 1, 10, 4, 5, 7, 0 };
    return store_make(4, 4, corners, twins);
}

static store *triangle(void)
{
    static const uint32_t corners[] = { 0, 1, 2 };
    static const uint32_t twins[] = { PMESH_NONE, PMESH_NONE, PMESH_NONE };
    return store_make(3, 1, corners, twins);
}

static bool grows_soundly(store *s, uint32_t seed)
{
    bool sound = true;
    while (sound && s->mesh.vertex_count < CAPACITY) {
        pmesh_ring ring;
        const uint32_t v = shape_random(&seed, s->mesh.vertex_count);
        if (!pmesh_ring_gather(&s->mesh, v, &ring))
            continue;
        pmesh_mesh_split(&s->mesh, v, &ring, random_cut(&seed, &ring));
        sound = pmesh_mesh_check(&s->mesh, s->seen) == NULL;
    }
    free(s);
    return sound;
}

TEST(mesh_stays_a_manifold_under_any_splits)
{
    for (uint32_t seed = 1; seed <= 40; seed++) {
        CHECK(grows_soundly(tetrahedron(), seed));
        CHECK(grows_soundly(triangle(), seed));
    }
}

static bool rings_agree(const pmesh_mesh *m, uint32_t v)
{
    pmesh_ring a, b;
    if (!pmesh_ring_gather(m, v, &a))
        return true;
    return pmesh_ring_gather_known(m, v, a.count, &b) && b.count == a.count &&
           b.face_count == a.face_count && b.open == a.open &&
           !memcmp(b.edge, a.edge, a.face_count * sizeof *a.edge) &&
           !memcmp(b.vertex, a.vertex, a.count * sizeof *a.vertex);
}

TEST(ring_of_known_size_is_the_one_that_is_walked_around)
{
    for (uint32_t seed = 1; seed <= 40; seed++) {
        store *s = seed % 2 ? tetrahedron() : triangle();
        uint32_t random = seed;
        while (s->mesh.vertex_count < CAPACITY) {
            pmesh_ring ring;
            const uint32_t v = shape_random(&random, s->mesh.vertex_count);
            if (!pmesh_ring_gather(&s->mesh, v, &ring))
                continue;
            pmesh_mesh_split(&s->mesh, v, &ring, random_cut(&random, &ring));
        }
        for (uint32_t v = 0; v < s->mesh.vertex_count; v++)
            CHECK(rings_agree(&s->mesh, v));
        free(s);
    }
}

TEST(mesh_check_finds_a_broken_twin)
{
    store *s = tetrahedron();
    CHECK(pmesh_mesh_check(&s->mesh, s->seen) == NULL);
    s->twin[0] = PMESH_NONE;
    CHECK(pmesh_mesh_check(&s->mesh, s->seen) != NULL);
    free(s);
}

TEST(cut_through_the_ghost_is_illegal)
{
    store *s = triangle();
    pmesh_ring ring;
    CHECK(pmesh_ring_gather(&s->mesh, 0, &ring));
    CHECK(ring.open && ring.count == 2 && ring.face_count == 1);
    CHECK(pmesh_cut_legal(&ring, (pmesh_cut){ 0, 1 }));
    CHECK(!pmesh_cut_legal(&ring, (pmesh_cut){ 1, 0 }));
    CHECK(pmesh_cut_legal(&ring, (pmesh_cut){ 1, PMESH_NONE }));
    CHECK(!pmesh_cut_legal(&ring, (pmesh_cut){ PMESH_NONE, PMESH_NONE }));
    free(s);
}
