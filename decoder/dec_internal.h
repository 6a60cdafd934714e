/* SPDX-License-Identifier: MIT */
/*
 * dec_internal.h - the decoder's state.
 *
 * The codec's mesh is as fine as what was decoded. The visible mesh is the
 * file's first n vertices; its index buffer is the codec's own array of corners,
 * which moves up and down by lists made once, when a block is decoded. A corner
 * that names a vertex beyond the first n names the nearest ancestor among them.
 * To decode a block the array is moved up to all there is; where the visible
 * mesh is coarser it goes back when somebody looks (dec_view_settle()), so that
 * feeding alone never moves it.
 */
#ifndef DEC_INTERNAL_H
#define DEC_INTERNAL_H

#include "decoder/dec_touched.h"
#include "decoder/dec_frame.h"
#include "format/codec.h"
#include "format/exact.h"
#include "format/header.h"

/* The visible mesh and how to move it. Split u (a vertex number) shows its
 * faces and gives u its moved corners. These are listed split by split, each a
 * half-edge in bytes apart: few meshes need more than three. */
typedef struct dec_view {
    uint32_t vertices; /* visible mesh vertices */
    uint32_t decoded;  /* of those decoded: the most that can be visible */
    uint32_t stands;   /* where index and position are */
    uint32_t *index;   /* 3 per face: output vertices; behind the visible faces
                          the values that faces are born with */
    uint8_t *moved_count;   /* per vertex */
    uint32_t moved;         /* corners of the splits below `stands` */
    uint16_t *moved_low;    /* half-edges: */
    uint8_t *moved_high;    /* the bits from 16 on, */
    uint8_t *moved_highest; /* and from 24 on; NULL if there are none */
    uint32_t *moved_wedge; /* what they become; NULL without attributes: u */
    /* If parents move: the visible positions, and for each split the parent's
     * other position (beyond the split while it is not visible). */
    int32_t (*position)[3];
    int32_t (*other)[3];
} dec_view;

/* What the caller has not been told of yet. */
typedef struct dec_changed {
    dec_touched faces, vertices; /* output vertices */
    dec_touched moved;    /* mesh vertices whose position changed; has no memory
                             if none can: no parent moves, nothing is exact */
    bool base;            /* the base mesh has come */
    uint32_t exact;       /* vertices known to be exact */
} dec_changed;

struct pmesh_decoder {
    pmesh_decoder *self; /* for dec_view_settle() */
    pmesh_allocator allocator;
    pmesh_decoder_config config;
    dec_frame frame;

    /* Contents (dec_chunk.c). */
    bool has_header, has_base, has_names;
    uint64_t header_end; /* bytes up to the end of the header chunk */
    pmesh_header_chunk header;
    uint32_t levels;     /* complete */
    bool in_level;
    pmesh_codec codec;
    dec_view view;
    dec_changed changed;
    pmesh_buffers buffers; /* the caller's; all NULL: none */
    bool bound;
    pmesh_exact exact; /* positions; unused unless header.exact_size > 0 */
    uint8_t *payload; /* buffer of header.chunk_size bytes */
    char *names;      /* the names chunk and a final 0 */
    void *block;      /* the one allocation behind the handle */
    uint64_t block_size;
    uint8_t small[PMESH_MAX_HEADER_SIZE]; /* payload of the header chunk */
};

/* Bytes and layout of the view's arrays, as pmesh_codec_bind(). */
uint64_t dec_view_bind(dec_view *view, const pmesh_header_chunk *header,
                       void *block);

/* Makes room for the codec: all that is decoded, in the codec's arrays. */
void dec_view_raise(pmesh_decoder *dec);

/* Takes back what a block that failed did to the index. */
void dec_view_restore(pmesh_decoder *dec);

/* The index becomes that of the visible mesh. Behind the back of functions that
 * only look: a decoder is used by one thread at a time. */
void dec_view_settle(const pmesh_decoder *dec);

/* Makes the base mesh visible. */
void dec_view_start(pmesh_decoder *dec);

/* Lists what the codec's block changed. False if it moves more corners than
 * the header declares. */
bool dec_view_append(pmesh_decoder *dec);

/* Moves the visible mesh to `vertices` mesh vertices; noting: marks what
 * changes below the shorter end of each buffer. */
void dec_view_move(pmesh_decoder *dec, uint32_t vertices, bool noting);

/* How many mesh vertices meet the target; target NULL: all. */
uint32_t dec_target_vertices(const pmesh_decoder *dec,
                             const pmesh_target *target);

/* Bytes and layout of changed's arrays, as pmesh_codec_bind(). */
uint64_t dec_changed_bind(dec_changed *changed, const pmesh_header_chunk *header,
                          void *block);

/* Mesh vertex v as it is visible; value `attribute` of output vertex w. */
void dec_position(const pmesh_decoder *dec, uint32_t v, float xyz[3]);
void dec_value(const pmesh_decoder *dec, uint32_t attribute, uint32_t w,
               float value[PMESH_MAX_COMPONENTS]);

/* Brings the caller's buffers up to date with what is marked as changed. */
void dec_write_bound(const pmesh_decoder *dec);

static inline uint32_t dec_mesh_vertex(const pmesh_decoder *dec, uint32_t w)
{
    return dec->codec.mesh.wedge ? dec->codec.mesh.wedge_vertex[w] : w;
}

/* Faces, and output vertices, of the visible mesh's first n vertices. */
uint32_t dec_faces_at(const pmesh_decoder *dec, uint32_t vertices);
uint32_t dec_wedges_at(const pmesh_decoder *dec, uint32_t vertices);

#endif
