/* SPDX-License-Identifier: MIT */
/*
 * enc_schedule.h - which vertex pairs are contracted, in which batch.
 *
 * A batch is a set of disjoint pairs (child u -> parent v) contracted on one
 * mesh; its inverse is one level of the file. Any subset of a batch, in any
 * order, is a legal mesh: every pair meets the link condition both in the mesh
 * before the batch and in the mesh with the rest of the batch contracted (the
 * double link test).
 *
 * The record of all contractions is the vertex tree: parent and child by
 * vertex number of the enc_mesh, which contractions never renumber.
 */
#ifndef ENC_SCHEDULE_H
#define ENC_SCHEDULE_H

#include "encoder/enc_mesh.h"

/* A ring (neighbours of the vertex that will split again, the virtual one
 * across a boundary included) may have this many members; SPEC 6. */
#define ENC_MAX_RING 48

/* One contraction: u vanishes, v moves from `before` to its place after. */
typedef struct enc_contraction {
    uint32_t child, parent;
    int32_t before[3]; /* of the parent, grid coordinates, before */
} enc_contraction;

typedef struct enc_schedule {
    pmesh_allocator allocator;
    uint32_t vertex_count, face_count, wedge_count; /* of the enc_mesh */

    pmesh_simplify_end end; /* why there are no more contractions */
    uint32_t batch_count;  /* at most PMESH_MAX_LEVELS - 1, none is empty */
    uint32_t *batch_first; /* batch_count + 1 entries into `contraction`: batch
                              0 is contracted first, so it is the finest */
    double *batch_error;   /* per batch: bound of the distance in steps after
                              it, see enc_reach.h; never falls */
    struct enc_reach *reach; /* finds these out; NULL: they are known */
    enc_contraction *contraction; /* in the order of contraction */
    uint32_t contraction_count;

    /* Per vertex: the contraction that removes it as child, or ENC_NONE. */
    uint32_t *vertex_end;
    /* Per vertex: its last position (at death, or in the base mesh). */
    int32_t (*position)[3];
    /* Per face: the contraction that removes it, or ENC_NONE. */
    uint32_t *face_end;
    /* Of a joined mesh, per face removed: the side 0 .. 2 that it died at, from
     * its corner of that number on. */
    uint8_t *face_side;
    /* Per wedge (NULL without attributes): the wedge of the parent vertex that
     * its surviving corners take when its vertex is contracted; ENC_NONE for
     * wedges of base vertices. A wedge dies with its vertex. */
    uint32_t *wedge_parent;
} enc_schedule;

/* The number of faces at which contraction is to end, of so many. */
uint32_t enc_base_target(const pmesh_encoder_config *config, uint32_t faces);

/* How many ways there are to try for the config: at least 1. */
uint32_t enc_schedule_variants(const pmesh_encoder_config *config);

/* Contracts `mesh` (which is not changed) down to the base mesh that the
 * config asks for, in the given way. `progress` may cancel. Returns PMESH_OK or a status of
 * pmesh_encode() with *out empty. */
pmesh_status enc_schedule_build(const enc_mesh *mesh,
                                const pmesh_encoder_config *config,
                                uint32_t variant, enc_schedule *out);

/* Waits for the last of batch_error, if there are threads; all else is complete
 * before. */
void enc_schedule_settle(enc_schedule *schedule);

void enc_schedule_destroy(enc_schedule *schedule);

#endif
