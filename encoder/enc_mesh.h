/* SPDX-License-Identifier: MIT */
/*
 * enc_mesh.h - the encoder's integer mesh: welded, quantised, cut into sheets
 * that are manifold. Everything after the import works on this and on nothing
 * else.
 *
 * Half-edges are numbered 3 * face + k and run from corner k to corner k + 1
 * (mod 3) of the face; "corner" and "half-edge" share the number. The twin is
 * the half-edge of the neighbouring face that runs the other way, or ENC_NONE.
 *
 * Invariants, checked by enc_mesh_check():
 *   - the three vertices of a face differ;
 *   - a directed pair (a, b) occurs in at most one half-edge, and if both
 *     (a, b) and (b, a) occur they are twins;
 *   - the faces of a vertex form one fan, closed or open: the surface is an
 *     oriented 2-manifold with boundary;
 *   - twins are in faces over different vertices: a closed fan has at least
 *     three faces;
 *   - every vertex and every wedge is used by a face.
 * Several vertices may share one grid point; that is never a reason to join.
 *
 * In a joined mesh, instead of the second and third, a vertex may have several
 * fans, at most PMESH_MAX_FANS: the sheets meet there.
 */
#ifndef ENC_MESH_H
#define ENC_MESH_H

#include <stdbool.h>

#include "encoder/enc_pool.h"
#include "encoder/pmesh_encode.h"

#define ENC_NONE UINT32_MAX

typedef struct enc_guide enc_guide;

typedef struct enc_mesh {
    pmesh_allocator allocator;
    pmesh_grid grid;
    int32_t bounds[3]; /* largest coordinate of each axis; the least is 0 */

    uint32_t vertex_count;
    int32_t (*position)[3]; /* grid coordinates */
    float (*exact)[3];      /* positions of the input; NULL unless lossless */
    uint32_t *source;       /* an input vertex of each; NULL unless a cost hook
                               is to be told */

    uint32_t face_count;
    uint32_t *vertex;   /* per corner */
    uint32_t *twin;     /* per half-edge */
    bool joined;        /* vertices may have several fans */
    uint32_t *material; /* per face; NULL if material_count is 1 */
    uint32_t material_count;

    /* A wedge is a vertex together with one attribute tuple. Without
     * attributes (value_count == 0) wedge is NULL and a wedge is its vertex. */
    uint32_t wedge_count;
    uint32_t *wedge;        /* per corner */
    uint32_t *wedge_vertex; /* per wedge */
    uint16_t *value;        /* value_count coded integers per wedge */
    uint32_t value_count;   /* sum of pmesh_coded_components() */
    uint32_t attribute_count;
    pmesh_attribute attribute[PMESH_MAX_ATTRIBUTES];
    float weight[PMESH_MAX_ATTRIBUTES]; /* in costs; see enc_looks.h */

    enc_guide *guide; /* enc_guide.h; NULL: nobody asked for anything */
    enc_pool *pool;   /* borrowed: who helps; NULL: nobody */
} enc_mesh;

/*
 * Imports: checks indices, drops faces that are degenerate, repeated or not
 * finite (counted in the report), welds equal positions, quantises positions
 * and attributes, cuts what is not manifold.
 *
 * Faces and vertices of small meshes keep the input's order as far as they
 * survive (a vertex counts as its first input vertex in use), those of large
 * ones get one by place; vertices that cutting adds come last.
 *
 * report: not NULL; sets the grid, all counts of the input and of the full
 * detail, and error_index. They add up:
 *   faces = input_faces - not_finite - degenerate - duplicate,
 *   vertices = input_vertices - unused - welded + cut.
 *
 * pool: who helps, and becomes the mesh'; or NULL.
 *
 * Returns PMESH_OK or a status of pmesh_encode() with *out empty.
 */
pmesh_status enc_mesh_import(const pmesh_mesh_input *in,
                             const pmesh_encoder_config *config,
                             enc_pool *pool, enc_mesh *out,
                             pmesh_encode_report *report);

void enc_mesh_destroy(enc_mesh *mesh);

/* NULL if all invariants hold, else the one that is broken (or "out of
 * memory"). For tests and debug builds; linear in the corners. */
const char *enc_mesh_check(const enc_mesh *mesh);

#endif
