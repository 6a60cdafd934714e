/* SPDX-License-Identifier: MIT */
/*
 * codec.h - the walk through a stream that encoder and decoder share: base
 * mesh, then levels of vertex splits in blocks (SPEC 6).
 *
 * A level is decoded on the mesh that the level before left. Its vertices are
 * visited breadth first; each has a flag, "splits", and if so a cut. A block is
 * a run of this visit that contains a given number of splits; it holds first
 * all of their connectivity, then all of their positions, then attributes.
 * Behind a block its new vertices and faces are renumbered by importance, so
 * that any prefix of them is a good mesh (SPEC 6.7).
 *
 * When encoding, an oracle answers what the stream will say; when decoding,
 * the oracle is NULL. Nothing here allocates: pmesh_codec_layout() tells the
 * size of each array, its owner provides them.
 */
#ifndef PMESH_CODEC_H
#define PMESH_CODEC_H

#include "format/coder.h"
#include "format/lanes.h"
#include "format/mesh.h"
#include "format/models.h"
#include "format/relay.h"

/* Visit state of a vertex within a level. */
typedef enum pmesh_visit {
    PMESH_UNVISITED = 0,
    PMESH_KEPT = 1,    /* visited, does not split */
    PMESH_PARENT = 2,  /* visited, has split */
    PMESH_NEWBORN = 3, /* made by a split of this level */
    PMESH_GHOST = 4,   /* what lies across a boundary */
    PMESH_QUEUED = 8   /* beside PMESH_UNVISITED: it is in the order */
} pmesh_visit;

typedef struct pmesh_fans pmesh_fans; /* see join.h */
typedef struct pmesh_parting pmesh_parting;

/*
 * The encoder's answers. Half-edges, vertices and faces are the codec's
 * numbers. A key names a wedge in the encoder's own way: two corners have the
 * same wedge if they have the same key.
 */
typedef struct pmesh_oracle {
    void *user;
    /* The base mesh in any numbering; filled in by pmesh_base_code(): of each
     * of the codec's half-edges that of `base`, of each of base's vertices the
     * codec's number (PMESH_NONE before). */
    const pmesh_mesh *base;
    uint32_t *base_edge;
    uint32_t *base_vertex;
    /* Of a joined mesh, where each vertex of `base` is one fan: the point that
     * it belongs to, in any numbering; filled in: of each of those the codec's
     * number (PMESH_NONE before). */
    const uint32_t *base_point;
    uint32_t *point_vertex;

    bool (*splits)(void *user, uint32_t vertex);
    void (*cut)(void *user, uint32_t vertex, const pmesh_ring *ring,
                pmesh_cut *cut);
    /* Instead of cut() in a joined mesh; *parting is zeroed. */
    void (*part)(void *user, uint32_t vertex, const pmesh_fans *fans,
                 pmesh_parting *parting);
    /* Told behind each split: the child, its first new face and their count. */
    void (*split_done)(void *user, uint32_t child, uint32_t face,
                       uint32_t count);
    void (*position)(void *user, uint32_t vertex, int32_t out[3]);
    uint32_t (*key)(void *user, uint32_t half_edge);
    uint32_t (*number)(void *user, uint32_t key); /* PMESH_NONE: has none */
    void (*set_number)(void *user, uint32_t key, uint32_t wedge);
    const uint16_t *(*values)(void *user, uint32_t wedge);
    uint32_t (*material)(void *user, uint32_t face);
} pmesh_oracle;

/* The block being coded: what it appends to the mesh. */
typedef struct pmesh_block {
    uint32_t vertex, vertex_count; /* first, and how many */
    uint32_t face, face_count;
    uint32_t wedge, wedge_count;
} pmesh_block;

/* What the arrays of a codec are sized by; from the header. */
typedef struct pmesh_codec_sizes {
    uint32_t vertices, faces, wedges; /* at full detail */
    uint32_t base_faces;
    uint32_t coarse_vertices; /* before the last level; 0: not known */
    uint32_t attribute_count;
    uint32_t value_count; /* coded components of a wedge; 0: no attributes */
    uint32_t material_count;
    bool moves;            /* optimal placement: a split moves its parent */
    bool joined;           /* vertices may have several fans; then also: */
    uint32_t base_fans;    /* of all vertices of the base */
    uint32_t block_faces;  /* made by the richest block */
    uint32_t block_splits; /* in the largest block */
    uint32_t block_wedges; /* made by the richest block */
} pmesh_codec_sizes;

/* The most faces of a block. */
static inline uint64_t pmesh_block_faces(const pmesh_codec_sizes *s)
{
    return s->joined ? s->block_faces : 2 * (uint64_t)s->block_splits;
}

/* An attribute's components among all of a wedge. */
typedef struct pmesh_channel {
    uint32_t first, count;
    bool normal;
    bool tangent; /* see pmesh_codec_limit_values() */
} pmesh_channel;

/* The neighbours of a vertex: their number, and the sum of their positions,
 * modulo 2^32. One record, for they are wanted together. */
typedef struct pmesh_near {
    uint32_t sum[3];
    uint32_t degree;
} pmesh_near;

/* The same as four numbers. */
static inline quads pmesh_near_load(const pmesh_near *near)
{
    int32_t all[QUADS];
    memcpy(all, near, sizeof all);
    return quads_load(all);
}

static inline void pmesh_near_store(pmesh_near *near, quads all)
{
    int32_t to[QUADS];
    quads_store(to, all);
    memcpy(near, to, sizeof to);
}

typedef struct pmesh_codec {
    pmesh_codec_sizes sizes;
    pmesh_mesh mesh;
    pmesh_models models;
    pmesh_place_models *place; /* [1] only if parents move: theirs */
    int32_t bounds[3]; /* largest coordinate of each axis */
    uint32_t component_max[PMESH_MAX_ATTRIBUTES * PMESH_MAX_COMPONENTS];
    pmesh_channel channel[PMESH_MAX_ATTRIBUTES];
    uint32_t tangent_map, tangent_normal; /* channels that tangents go by */
    pmesh_channel_models *channel_models; /* per attribute */
    pmesh_value_models *value_models;     /* per component */
    const char *rule;      /* what a negative status was about */
    uint64_t part_size[3]; /* when encoding, bytes so far: connectivity,
                              positions, attributes */
    uint64_t attribute_spent[PMESH_MAX_ATTRIBUTES]; /* likewise 1/256 bits, of
                                                       values, of the base too */

    /* Of the level. */
    uint32_t *order; /* per vertex that was there before it: the visit's order,
                        as far as known */
    uint8_t *state;  /* per vertex: pmesh_visit */
    uint32_t level_vertex_count;
    uint32_t level_seed;   /* vertices below it are in the order */
    uint32_t level_queued; /* length of the order */
    uint32_t level_next;   /* its first that was not visited */

    /* Of the mesh as it is. */
    pmesh_near *near; /* per vertex */

    /* Of the vertex tree: what there is once a vertex is split off. */
    uint8_t *made_faces;    /* per vertex: faces of its split, at most two for
                               each part and each lone one */
    uint32_t *faces_before; /* of every PMESH_FACE_MARK-th vertex: faces before
                               its split */
    uint32_t *wedge_end;    /* per vertex; NULL without attributes */

    uint32_t wedge_limit; /* wedges that the base or the block may make */

    /* Of the block; while it is coded its numbers are in coding order. */
    pmesh_block block;
    int32_t (
        *unsplit)[3];     /* per split, if parents move: where the parent was */
    uint32_t *child_face; /* per split: its first new face */
    uint32_t *importance; /* per split, before face_order, which has its place */
    uint32_t *child_order;  /* per split, afterwards: its place in coding
                               order */
    uint32_t *face_order;   /* per face of the block, likewise */
    uint32_t *wedge_order;  /* per wedge of the block, likewise */
    uint32_t *wedge_corner; /* per wedge: the half-edge it was made for */
    uint32_t *wedge_before; /* per wedge: the next lower one of its vertex, or
                               PMESH_NONE */
    uint32_t *wedge_last;   /* per vertex: its highest wedge, or PMESH_NONE */
    uint32_t *scratch;      /* see base.c, cut.c, rank.c */
} pmesh_codec;

static inline uint8_t pmesh_state(const pmesh_codec *c, uint32_t v)
{
    return c->state[v] & (PMESH_QUEUED - 1);
}

/* The ring of v, or of its first fan; false if it is too large. */
static inline bool pmesh_codec_ring(const pmesh_codec *c, uint32_t v,
                                    pmesh_ring *ring)
{
    return c->mesh.fan ? pmesh_ring_gather(&c->mesh, v, ring)
                       : pmesh_ring_gather_known(&c->mesh, v,
                                                 c->near[v].degree, ring);
}

enum { PMESH_FACE_MARK = 32 };

/* Faces of the mesh of the first n vertices; no fewer than those of the base. */
static inline uint32_t pmesh_faces_at(const pmesh_codec *c, uint32_t n)
{
    uint32_t v = n - n % PMESH_FACE_MARK;
    uint32_t faces = c->faces_before[v / PMESH_FACE_MARK];
    for (; v < n; v++)
        faces += c->made_faces[v];
    return faces;
}

/*
 * Lays the arrays out in `block` (aligned for any object, zeroed) and makes an
 * empty mesh and fresh models. Returns the bytes needed; with block NULL that
 * is all, and `c` is not usable. The sizes must be within the limits of
 * layout.h.
 */
uint64_t pmesh_codec_bind(pmesh_codec *c, const pmesh_codec_sizes *sizes,
                          void *block);

/* Makes all models fresh, from other tables than pmesh_start. */
void pmesh_codec_start(pmesh_codec *c, const pmesh_tables *start);

/* Sets component_max and channel from the attributes. A generic one of four
 * components, the first three of which take negative values too, is taken for a
 * tangent if a normal and texture coordinates come before it. */
void pmesh_codec_limit_values(pmesh_codec *c, const pmesh_attribute *attributes,
                              uint32_t count);

/* Hash table of a base mesh's half-edges: a power of two, more than twice
 * their number. */
uint64_t pmesh_base_scratch(uint32_t faces);

/* Codes shape and positions of the base mesh into the empty mesh of `c`. */
pmesh_status pmesh_base_code(pmesh_codec *c, pmesh_coder *coder,
                             const pmesh_oracle *oracle, uint32_t vertices,
                             uint32_t faces);

/* A base mesh that a hook decodes from `data`. */
typedef struct pmesh_base_source {
    pmesh_base_decode decode;
    void *user;
    const uint8_t *data;
    size_t size;
} pmesh_base_source;

/* The same from a hook, whose answer is not trusted. On a negative status the
 * mesh is empty again. */
pmesh_status pmesh_base_import(pmesh_codec *c, const pmesh_base_source *source,
                               uint32_t vertices, uint32_t faces);

/* Behind either: codes materials, wedges and their values; `wedges` as the
 * header says (when encoding, an upper bound). */
pmesh_status pmesh_base_attributes_code(pmesh_codec *c, pmesh_coder *coder,
                                        const pmesh_oracle *oracle,
                                        uint32_t wedges);

/* Starts a level on the current mesh. */
void pmesh_level_begin(pmesh_codec *c);

/*
 * Codes the next `split_count` splits of the level and renumbers what they
 * made. Afterwards block, child_order, face_order, wedge_order and unsplit tell
 * what was appended. On a negative status the mesh is not usable any more.
 */
pmesh_status pmesh_block_code(pmesh_codec *c, pmesh_coder *coder,
                              const pmesh_oracle *oracle, uint32_t split_count);

/* The wedge that a new face's corner has when the face is born in the split of
 * `child`: vertices that split off later are still their parents then. */
static inline uint32_t pmesh_birth_wedge(const pmesh_mesh *m, uint32_t h,
                                         uint32_t child)
{
    const uint32_t v = m->vertex[h];
    if (m->wedge)
        return v > child ? m->wedge_parent[m->wedge[h]] : m->wedge[h];
    return v > child ? m->parent[v] : v;
}

#endif
