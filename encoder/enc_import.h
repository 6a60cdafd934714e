/* SPDX-License-Identifier: MIT */
/*
 * enc_import.h - private to the import: its steps, in the order they run.
 *
 *   enc_import.c      checks, drops faces, numbers, quantises positions
 *   enc_weld.c        equal (or close) positions become one vertex
 *   enc_order.c       numbers by place
 *   enc_manifold.c    drops repeated faces, counts pieces, and calls
 *     enc_pair.c      half-edges become twins, repeated faces are found
 *     enc_cut.c       one vertex per fan
 *   enc_attributes.c  quantises attributes, corners become wedges
 */
#ifndef ENC_IMPORT_H
#define ENC_IMPORT_H

#include "encoder/enc_bits.h"
#include "encoder/enc_mesh.h"

#include <float.h>
#include <stdbool.h>
#include <string.h>

/* Positions beyond this size are as good as infinite: the sum and difference
 * of any two others are finite. */
#define ENC_LARGEST_COORDINATE 0x1p1020

/* Half-edge numbers stay below 2^30, so two spare bits fit beside one. */
#define ENC_MAX_CORNERS (UINT32_C(1) << 30)

static inline uint32_t enc_next_corner(uint32_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static inline uint32_t enc_previous_corner(uint32_t corner)
{
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

/* Any stride and alignment. Negative zero becomes zero; or, lossless, what is
 * within the floats becomes a float with all of its bits. */
static inline void enc_load_position(const pmesh_mesh_input *in,
                                     bool lossless, uint32_t vertex,
                                     double out[3])
{
    const size_t stride =
        in->position_stride ? in->position_stride : 3 * sizeof(double);
    const unsigned char *base = (const unsigned char *)in->positions;

    memcpy(out, base + vertex * stride, 3 * sizeof(double));
    for (int k = 0; k < 3; k++) {
        if (!lossless)
            out[k] += 0.0;
        else if (out[k] >= -FLT_MAX && out[k] <= FLT_MAX)
            out[k] = (double)(float)out[k];
    }
}

/* A well-mixed hash of `word` on top of `hash`. */
static inline uint64_t enc_mix(uint64_t hash, uint64_t word)
{
    hash = (hash ^ word) * UINT64_C(0x9e3779b97f4a7c15);
    return hash ^ hash >> 32;
}

/* Slots of a hash table for `count` items: a power of two, 1.5 to 3 times. */
static inline size_t enc_table_size(size_t count)
{
    size_t size = 16;
    while (size < count + count / 2)
        size *= 2;
    return size;
}

typedef struct enc_importer {
    const pmesh_mesh_input *in;
    const pmesh_encoder_config *config;
    enc_mesh *mesh;
    pmesh_encode_report *report;
    uint32_t *number; /* per input vertex: the least one it is welded to, then
                         its vertex, before cutting; ENC_NONE if not in use */
    uint32_t *first;  /* set of input vertices: the least of each vertex */
    uint32_t *source; /* per face: which one of the input */
    size_t source_count;
} enc_importer;

/*
 * root: per input vertex, its own number if it takes part, else ENC_NONE. On
 * return, the least of the vertices it is joined with. `distance` 0 joins
 * equal positions only; more joins transitively.
 *
 * lossless: equal are floats of equal bits; *zero_twins counts the positions
 * that have another's value and differ in the sign of a zero.
 */
pmesh_status enc_weld(const pmesh_allocator *allocator,
                      const pmesh_mesh_input *in, double distance,
                      bool lossless, uint32_t *root, uint32_t *zero_twins);

/* Numbers the vertices and faces of a large mesh so that neighbours in space
 * have close numbers. */
pmesh_status enc_order(enc_importer *im);

/* Faces and positions are there; takes out repeated faces, makes the twins and
 * the vertices that are missing for a manifold. */
pmesh_status enc_make_manifold(enc_importer *im);

/* Pieces of so many corners' faces that share no vertex: *count of them. */
pmesh_status enc_count_pieces(const pmesh_allocator *allocator,
                              const uint32_t *vertex, uint32_t corners,
                              uint32_t vertices, uint32_t *count);

/* What enc_pair() finds out. */
typedef struct enc_pairing {
    uint32_t *repeated;      /* in: empty set of faces; out: the repeated */
    uint32_t repeated_count;
    bool regular;            /* no edge had more than two faces, or two that
                                run the same way or cover each other */
} enc_pairing;

/*
 * Makes mesh->twin from mesh->vertex, positions and materials; faces that have
 * vertices, orientation and material of an earlier one are put into
 * `repeated` and stay without twins. A face is never paired with one over the
 * same three vertices. The mesh' pool helps.
 */
pmesh_status enc_pair(enc_mesh *mesh, enc_pairing *pairing);

/*
 * Gives every fan a vertex of its own and cuts fans that meet a neighbour
 * twice. Renumbers corners in mesh->vertex and raises mesh->vertex_count;
 * mesh->position is left as it was. `regular` as in enc_pairing.
 */
pmesh_status enc_cut(enc_mesh *mesh, bool regular);

/*
 * Quantises the attributes and fills all of mesh's attribute and wedge fields.
 * source: the input face of each face. *repaired counts the tuples in use that
 * had no proper value.
 */
pmesh_status enc_wedges(enc_mesh *mesh, const pmesh_mesh_input *in,
                        const pmesh_encoder_config *config,
                        const uint32_t *source, uint32_t *repaired);

/*
 * Sets minimum and scale of component `k` (not of normals) for values in
 * low .. high. A constant is kept exactly, and so are values in a range that
 * holds no more than 2^bits floats (all of them below a power of two, say).
 */
void enc_attribute_fit(pmesh_attribute *attribute, uint32_t k, float low,
                       float high);

#endif
