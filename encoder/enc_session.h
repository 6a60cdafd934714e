/* SPDX-License-Identifier: MIT */
/*
 * enc_session.h - private to the session: its state, and how it steps.
 *
 *   enc_session.c       actions, log, undo
 *   enc_session_step.c  contraction, expansion, the queue
 *   enc_session_cut.c   what is told of it, other cuts
 *
 * The corners of a vertex form a ring, those of dead faces included. Exchanging
 * the successors of one corner of each of two rings makes one of them, and the
 * same exchange makes two again, in the order of before: contraction and its
 * inverse.
 */
#ifndef ENC_SESSION_H
#define ENC_SESSION_H

#include <stdbool.h>

#include "encoder/enc_quadric.h"
#include "encoder/pmesh_session.h"

#define ENC_NOBODY UINT32_MAX

/* What a vertex stands for. */
typedef struct enc_node {
    double position[3];
    double weight;
    enc_quadric quadric, pull; /* about the position */
} enc_node;

/* One contraction: `gone` into `kept`. */
typedef struct enc_merge {
    uint32_t gone, kept;
    enc_node before; /* of kept; that of gone stays where it is */
    enc_node after;  /* of kept, without later guidance */
    double error;    /* squared; never less than that of its parts */
    uint32_t faces;  /* that died */
} enc_merge;

typedef struct enc_choice {
    double cost;
    uint32_t ends[2], age[2];
} enc_choice;

/* A deed, to be done again after an undo. */
typedef struct enc_deed {
    pmesh_session_action action;
    pmesh_constraint_kind kind;
    size_t faces;
    double amount;
    uint32_t *vertices;
    size_t count;
} enc_deed;

struct pmesh_session {
    pmesh_allocator allocator;
    uint32_t vertex_count, face_count;
    uint32_t *original; /* per corner: the input's vertex */
    double *input;      /* positions */

    enc_node *node;   /* per vertex */
    uint32_t *vertex; /* per corner, now */
    uint32_t *next;   /* per corner: the ring of its vertex */
    uint32_t *first;  /* per vertex: a corner, or ENC_NOBODY */
    uint32_t *end;    /* per face: the contraction it died of, or ENC_NOBODY */
    uint32_t *into;   /* per vertex: where it went, or ENC_NOBODY if alive */
    double *error;    /* per vertex: squared, of what it is made of */
    uint32_t alive;   /* faces */

    enc_merge *merge; /* the first `done` of them are what is contracted now, */
    uint32_t done, known; /* the others the way down that is known, */
    uint32_t old; /* but the first `old` of them were made before guidance, and
                     will not be made again */

    enc_choice *heap;
    size_t heap_count, heap_room;
    uint32_t *age;  /* per vertex: choices of another age are stale */
    uint32_t *mark; /* per vertex */
    uint32_t stamp;
    bool fresh;     /* the heap is that of the deepest known cut */

    enc_deed *deed;
    pmesh_session_step *step;
    size_t deed_count, deed_room;
};

/* All as in the input. */
void enc_session_reset(pmesh_session *s);

/* Contracts until at most `faces` are left, or expands while there are no more;
 * false if memory is out. */
bool enc_session_walk(pmesh_session *s, size_t faces);

/* The way down is no longer known. */
void enc_session_forget(pmesh_session *s);

/* Of faces around a living vertex, alive. */
double enc_session_area(const pmesh_session *s, uint32_t v);

#endif
