/* SPDX-License-Identifier: MIT */
#include "tests/unit/import_trial.h"

#include <stdlib.h>

#include "tests/unit/test.h"

void *import_alloc(void *user, size_t size)
{
    account *acc = user;

    if (acc->calls++ >= acc->allowed)
        return NULL;
    acc->bytes += size;
    if (acc->bytes > acc->peak)
        acc->peak = acc->bytes;
    return malloc(size);
}

void import_release(void *user, void *ptr, size_t size)
{
    account *acc = user;

    acc->bytes -= size;
    free(ptr);
}

trial import_trial_of(const double *positions, size_t vertex_count,
                      const uint32_t *indices, size_t face_count)
{
    return (trial){
        .in = { .positions = positions, .vertex_count = vertex_count,
                .indices = indices, .face_count = face_count },
        .config = { .position_bits = 14, .normal_bits = 10,
                    .texcoord_bits = 12, .color_bits = 8,
                    .generic_bits = 12,
                    .topology = PMESH_TOPOLOGY_KEEP },
        .acc = { .allowed = SIZE_MAX }
    };
}

pmesh_status import_run(trial *t)
{
    t->config.allocator =
        (pmesh_allocator){ import_alloc, import_release, &t->acc };
    const pmesh_status status =
        enc_mesh_import(&t->in, &t->config, NULL, &t->mesh, &t->report);
    if (status) {
        CHECK(t->acc.bytes == 0);
        CHECK(!t->mesh.vertex && t->mesh.face_count == 0);
        return status;
    }
    const pmesh_encode_report *r = &t->report;
    CHECK(enc_mesh_check(&t->mesh) == NULL);
    CHECK(r->faces == t->mesh.face_count);
    CHECK(r->vertices == t->mesh.vertex_count);
    CHECK(r->wedges == t->mesh.wedge_count);
    CHECK(r->faces == r->input_faces - r->not_finite_faces -
                          r->degenerate_faces - r->duplicate_faces);
    CHECK(r->vertices == r->input_vertices - r->unused_vertices -
                             r->welded_vertices + r->cut_vertices);
    return status;
}

void import_finish(trial *t)
{
    enc_mesh_destroy(&t->mesh);
    CHECK(t->acc.bytes == 0);
}

uint32_t import_open_edges(const enc_mesh *mesh)
{
    uint32_t count = 0;

    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
        count += mesh->twin[h] == ENC_NONE;
    return count;
}
