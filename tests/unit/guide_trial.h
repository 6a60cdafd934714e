/* SPDX-License-Identifier: MIT */
/* guide_trial.h - a mesh, guidance, and what becomes of both. */
#ifndef GUIDE_TRIAL_H
#define GUIDE_TRIAL_H

#include "encoder/enc_guide.h"
#include "encoder/enc_schedule.h"
#include "tests/unit/shapes.h"

typedef struct guide_trial {
    shape_mesh *shape;
    float *weights;
    uint8_t *locks;
    uint16_t *segments;
    pmesh_guide guide;
    pmesh_encoder_config config;
    enc_mesh mesh;
    enc_schedule schedule;
} guide_trial;

/* A trial without guidance but with room for it. Takes the shape over. */
guide_trial *guide_trial_of(shape_mesh *shape);

/* Imports and contracts, once more if it has been done before. */
void guide_run(guide_trial *t);

/* Frees what guide_run() made, or all. */
void guide_forget(guide_trial *t);
void guide_finish(guide_trial *t);

shape_bytes guide_bake(guide_trial *t);

/* Frees both. */
bool guide_same_bytes(shape_bytes a, shape_bytes b);

/* The vertex that v has become in the base mesh. */
uint32_t guide_root_of(const guide_trial *t, uint32_t v);

double guide_distance(const int32_t a[3], const int32_t b[3]);
double guide_diagonal(const guide_trial *t);

/* Positions of the input in grid steps. */
void guide_step_place(const guide_trial *t, uint32_t v, double out[3]);

/* A box of n x n uneven cells a side: flat sides, straight edges. */
shape_mesh *guide_box(uint32_t n);

/* Vertices of the box's side z = 0, or of its edge y = z = 0 in order. */
size_t guide_side_of(const guide_trial *t, bool edge, uint32_t *out);

#endif
