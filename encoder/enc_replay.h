/* SPDX-License-Identifier: MIT */
/*
 * enc_replay.h - runs a schedule backwards: from the base mesh up, in step
 * with the codec, whose oracle it is.
 *
 * The codec numbers vertices, faces and wedges as the decoder will; the
 * enc_mesh keeps the numbers of the import. The replay knows both. The fine
 * mesh of a level is never built: a corner's vertex there is the nearest
 * ancestor of its original vertex that lives in that level.
 */
#ifndef ENC_REPLAY_H
#define ENC_REPLAY_H

#include "encoder/enc_mesh.h"
#include "encoder/enc_relay.h"
#include "encoder/enc_schedule.h"
#include "format/codec.h"
#include "format/join.h"

typedef struct enc_replay {
    const enc_mesh *mesh;
    const enc_schedule *schedule;
    pmesh_allocator allocator;
    pmesh_codec codec;
    void *block;
    uint64_t block_size;
    pmesh_oracle oracle;

    /* From the codec's numbers to those of the import. */
    uint32_t *corner_of; /* per half-edge */
    uint32_t *vertex_of;
    uint32_t *wedge_of; /* NULL without attributes, as all that follows */

    /* From the import's numbers. */
    uint32_t *born;         /* vertex -> codec's, ENC_NONE if not yet there */
    uint32_t *wedge_number; /* wedge -> codec's, likewise */
    uint32_t *label;        /* vertex -> ancestor in the level's fine mesh */
    uint32_t *wedge_label;
    uint32_t *split_of;     /* vertex -> its contraction as parent, in the
                               current batch or a coarser one */
    uint32_t (*wings)[2];   /* contraction -> faces it removes, or ENC_NONE; from
                               its level on, the parent's corner at each wing */
    /* Of a joined mesh, instead: contraction -> its faces in the list; face ->
     * codec's, ENC_NONE if not yet there. See enc_part.c. */
    uint32_t *removed_first, *removed_list;
    uint32_t *face_of;
    uint32_t part_corner[2 * PMESH_MAX_RING + PMESH_MAX_LONE];
    uint32_t part_count; /* corners that the new faces of the split start at */
    bool lost;           /* a contraction that no split undoes: a bug */
    int32_t (*position)[3]; /* vertex -> place in the level's fine mesh */
    uint32_t *wedge_list, *wedge_first; /* vertex -> its wedges */

    bool moves;           /* optimal placement */
    uint32_t batch;       /* being replayed */
    uint32_t splits_left; /* of it */
    enc_relay *relay;     /* from the first level on that is worth two threads;
                             or NULL */
    uint32_t base_faces, base_vertices;
    pmesh_base_coder base_coder; /* who coded the base, once it is */
} enc_replay;

/* Prepares everything up to the empty codec. Returns PMESH_OK or E_MEMORY. */
pmesh_status enc_replay_create(enc_replay *r, const enc_mesh *mesh,
                               const enc_schedule *schedule, bool moves);
void enc_replay_destroy(enc_replay *r);

/* Writes the payload of the base mesh. If the config's hook cannot hold it, it
 * is coded natively: see base_coder. */
pmesh_status enc_replay_base(enc_replay *r, const pmesh_encoder_config *config,
                             pmesh_writer *out);

/* ---- of joined meshes: enc_part.c ---------------------------------------- */

bool enc_part_allocate(enc_replay *r);
void enc_part_release(enc_replay *r);
void enc_part_fill(enc_replay *r);

/* What lies across half-edge h of the import among the faces that the codec
 * has: those that are not there yet have their sides glued together. */
uint32_t enc_part_twin(const enc_replay *r, uint32_t h);

/* The codec's oracle: how the fans of v part, by contraction t. */
void enc_part_answer(enc_replay *r, const enc_contraction *t, uint32_t v,
                     const pmesh_fans *fans, pmesh_parting *out);

/* The codec's faces from `face` on are these: of the split, or of the base. */
void enc_part_number(enc_replay *r, uint32_t face, uint32_t count);

/* ---- all ----------------------------------------------------------------- */

/* The import's vertex that a corner of it has in the level's fine mesh. */
static inline uint32_t enc_replay_label_at(const enc_replay *r, uint32_t corner)
{
    return r->label[r->mesh->vertex[corner]];
}

/* Labels of the mesh in which contractions 0 .. done - 1 have happened. */
void enc_replay_label(enc_replay *r, uint32_t done);

/* Starts a batch, counted down from the last one. */
void enc_replay_begin(enc_replay *r, uint32_t batch);

/* Codes the next `splits` <= splits_left splits of the batch. */
pmesh_status enc_replay_block(enc_replay *r, pmesh_coder *coder,
                              uint32_t splits);

#endif
