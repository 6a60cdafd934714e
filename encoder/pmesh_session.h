/* SPDX-License-Identifier: MIT */
/*
 * pmesh_session.h - simplifies back and forth, and takes guidance at any level.
 *
 *   pmesh_session *s;
 *   pmesh_session_create(&s, &mesh, NULL);
 *   pmesh_session_move(s, 500);                       // how does it look?
 *   pmesh_session_weigh(s, eyes, eye_count, 0.9);     // paint what is there
 *   pmesh_session_move(s, 5000);                      // finer: children inherit
 *   pmesh_session_constrain(s, PMESH_POINT, teeth, tooth_count, 0);
 *   pmesh_session_move(s, 500);                       // and down again, better
 *   pmesh_session_destroy(s);
 *
 * After Kho and Garland, User-Guided Simplification (2003). Edges are contracted
 * in strict order of their cost by summed quadrics; every contraction is a node
 * of a tree with a quadric, a constraint quadric and a representative weight.
 *
 *   contraction   quadrics and constraints are summed; the weight is the mean
 *   expansion     quadrics are scaled by alpha where the node was weighted since,
 *                 Q = alpha (Q1 + Q2); what constraints it got since goes to the
 *                 children in halves; they inherit a weight that it got since
 *
 * Walks without guidance restore every bit. A node that was not touched gives
 * back what its children had.
 *
 * A session belongs to one thread at a time. Vertices are those of the input,
 * by number: one that is contracted lives on in another (pmesh_session_vertex).
 */
#ifndef PMESH_SESSION_H
#define PMESH_SESSION_H

#include "encoder/pmesh_encode.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pmesh_session pmesh_session;

/*
 * Takes a copy of positions and indices; nothing else of the mesh counts, and
 * vertices are one by number only. allocator: NULL or the one to use.
 *
 * Returns PMESH_OK, E_ARGUMENT (an array is missing), E_INDEX, E_NOT_FINITE (a
 * position), E_NO_FACES, E_LIMIT (2^30 corners) or E_MEMORY, with *out NULL.
 */
PMESH_API pmesh_status pmesh_session_create(pmesh_session **out,
                                            const pmesh_mesh_input *mesh,
                                            const pmesh_allocator *allocator);
PMESH_API void pmesh_session_destroy(pmesh_session *session); /* or NULL */

/* Goes to the finest cut of at most `faces`, or as far as it can. Returns
 * PMESH_OK or E_MEMORY (the session stays where it came to). */
PMESH_API pmesh_status pmesh_session_move(pmesh_session *session, size_t faces);

/*
 * Paints vertices with a weight 0 .. 1; 0.5 is neutral, and was there before.
 * Costs are multiplied by 100^(2 weight - 1). Vertices that are contracted
 * stand for what they are in now. The way down is made anew from here.
 *
 * Returns PMESH_OK, E_ARGUMENT (a number out of range) or E_MEMORY.
 */
PMESH_API pmesh_status pmesh_session_weigh(pmesh_session *session,
                                           const uint32_t *vertices,
                                           size_t count, double weight);

/* Adds a constraint as of pmesh_guide.h, at this cut. As above. */
PMESH_API pmesh_status pmesh_session_constrain(pmesh_session *session,
                                               pmesh_constraint_kind kind,
                                               const uint32_t *vertices,
                                               size_t count,
                                               double importance);

/* Takes the last action back: the session is as it was before it, to the bit.
 * Returns PMESH_OK, E_ARGUMENT (there is none) or E_MEMORY. */
PMESH_API pmesh_status pmesh_session_undo(pmesh_session *session);

/* ---- what there is now --------------------------------------------------- */

PMESH_API size_t pmesh_session_faces(const pmesh_session *session);

/* Room for 3 * pmesh_session_faces(); numbers of the input, in its order. */
PMESH_API void pmesh_session_indices(const pmesh_session *session,
                                     uint32_t *out);

/* The vertex that an input vertex is in now; itself if it is alive. */
PMESH_API uint32_t pmesh_session_vertex(const pmesh_session *session,
                                        uint32_t vertex);

/* A living vertex: a node of the tree. Quadrics are xx xy xz yy yz zz, x y z,
 * constant, about the origin, in model units. */
typedef struct pmesh_session_node {
    double position[3];
    double weight;         /* representative, 0 .. 1 */
    double quadric[10];    /* geometry, times its factor */
    double constraint[10]; /* their sum */
} pmesh_session_node;

PMESH_API void pmesh_session_look(const pmesh_session *session,
                                  uint32_t vertex, pmesh_session_node *out);

/* ---- the log ------------------------------------------------------------- */

typedef enum pmesh_session_action {
    PMESH_SESSION_MOVE = 0,
    PMESH_SESSION_WEIGH = 1,
    PMESH_SESSION_CONSTRAIN = 2
} pmesh_session_action;

/* One line: what was done, and what there was then. */
typedef struct pmesh_session_step {
    pmesh_session_action action;
    size_t faces;
    double error; /* root mean squared distance, where it is largest */
} pmesh_session_step;

/* The steps so far without those undone; valid until the next action. */
PMESH_API const pmesh_session_step *
pmesh_session_log(const pmesh_session *session, size_t *count);

/* ---- other cuts of the same tree ----------------------------------------- */

/*
 * The mesh of another cut, whatever the session shows: every contraction of the
 * tree on whose leaves (input vertices) the error stays within their threshold,
 * and that of its parts. Thresholds that differ by region make meshes that the
 * order of contraction never showed (Zeta, Cignoni and others 1998); equal ones
 * for the vertices of a segment cut that (Semisimp, Li and Watson 2001).
 *
 * thresholds: per input vertex. vertex_of: room for as many, becomes the vertex
 * that each is in. positions: NULL or room for 3 doubles a vertex: where those
 * are. *forced: contractions that come before one that is left out, of those
 * they were made after. Faces are those of the input whose three vertices are
 * different ones.
 *
 * Returns PMESH_OK or E_MEMORY.
 */
PMESH_API pmesh_status pmesh_session_cut(const pmesh_session *session,
                                         const double *thresholds,
                                         uint32_t *vertex_of, double *positions,
                                         size_t *forced);

#ifdef __cplusplus
}
#endif
#endif
