/* SPDX-License-Identifier: MIT */
/* import_trial.h - one import, with an allocator that counts. */
#ifndef IMPORT_TRIAL_H
#define IMPORT_TRIAL_H

#include "encoder/enc_mesh.h"

/* An allocator that counts, and fails from some call on. */
typedef struct account {
    size_t bytes, peak, calls, allowed;
} account;
void *import_alloc(void *user, size_t size);
void import_release(void *user, void *ptr, size_t size);

/* One import and what came of it. */
typedef struct trial {
    pmesh_mesh_input in;
    pmesh_encoder_config config;
    enc_mesh mesh;
    pmesh_encode_report report;
    account acc;
} trial;

/* An import with default settings that is yet to run. */
trial import_trial_of(const double *positions, size_t vertex_count,
                      const uint32_t *indices, size_t face_count);

/* Imports and checks what holds of every import. */
pmesh_status import_run(trial *t);

/* Frees; nothing may be left. */
void import_finish(trial *t);

uint32_t import_open_edges(const enc_mesh *mesh);

static inline uint32_t import_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

#endif
