/* SPDX-License-Identifier: MIT */
/*
 * pmesh_encode.h - bakes a triangle mesh into a progressive .pmesh stream.
 *
 *   pmesh_encoder_config config = pmesh_encoder_config_default();
 *   pmesh_mesh_input mesh = {
 *       .positions = xyz, .vertex_count = nv, .indices = tri, .face_count = nf
 *   };
 *   pmesh_encode_report report;
 *   pmesh_status status =
 *       pmesh_encode(&mesh, &config, my_write, my_file, &report);
 *
 * Vertex pairs are contracted in the order of quadric error metrics (Garland
 * and Heckbert 1997, 1998), batch by batch; the contractions, reversed, are
 * the vertex splits of the file (Hoppe 1996).
 *
 * Any triangle soup is legal: open, non-manifold, unoriented, self-crossing,
 * in pieces. No face is lost at full detail except those the report counts.
 *
 * The same input and config give the same bytes on every machine, whatever
 * `threads` is, as far as hooks do. The bytes may differ between versions of
 * this library.
 */
#ifndef PMESH_ENCODE_H
#define PMESH_ENCODE_H

#include "encoder/pmesh_guide.h"
#include "encoder/pmesh_simplify.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * One attribute channel: `count` tuples of `components` floats, `stride` bytes
 * apart (0: packed). `indices` names the tuple of every corner (3 per face),
 * or is NULL if tuples go with the position indices (then count must be at
 * least vertex_count). NaN and infinities are replaced by 0 and counted.
 */
typedef struct pmesh_attribute_input {
    pmesh_attribute_kind kind;
    uint8_t set;
    uint8_t components; /* 3 for normals, 2 texcoords, 3..4 colours, 1..4 */
    uint8_t bits;       /* 4..16; 0: the config's default for the kind */
    const float *values;
    size_t count;
    size_t stride;
    const uint32_t *indices;
    float weight; /* of a difference of 1 in the costs; 0: the config's default
                     for the kind, negative: none */
} pmesh_attribute_input;

/*
 * A triangle mesh, borrowed for the call. Positions are `position_stride`
 * bytes apart (0: packed xyz). Positions of equal value are one vertex.
 */
typedef struct pmesh_mesh_input {
    const double *positions;
    size_t vertex_count;
    size_t position_stride;
    const uint32_t *indices; /* 3 per face, counter-clockwise from outside */
    size_t face_count;
    const uint32_t *materials; /* per face, < material_count; NULL: all 0 */
    uint32_t material_count;   /* 0 stands for 1 */
    const char *const *material_names; /* UTF-8, NULL or material_count */
    const pmesh_attribute_input *attributes;
    size_t attribute_count; /* at most PMESH_MAX_ATTRIBUTES */
} pmesh_mesh_input;

/*
 * What coarse levels do where the surface is not manifold or in pieces. Files
 * that join cost a little more where they do, and nothing where they do not;
 * their base mesh is always coded natively. At full detail all show the input.
 */
typedef enum pmesh_topology {
    PMESH_TOPOLOGY_AUTO = 0, /* join if there is a threshold; or if no Draco base
                                is asked for, and the surface is not manifold or
                                has more pieces than the base shall have faces */
    PMESH_TOPOLOGY_KEEP = 1, /* sheets that meet are cut apart and may open
                                cracks; no piece joins another or vanishes */
    PMESH_TOPOLOGY_JOIN = 2  /* sheets stay together where they meet; pieces
                                join and vanish when edges do not suffice */
} pmesh_topology;

/*
 * Hook: writes a base mesh into at most `capacity` bytes at `out` as a Draco
 * buffer, with positions as they are, and sets *size. No two vertices may
 * become one, even at one position. Returns PMESH_OK, or PMESH_E_MEMORY; any
 * other status says that Draco cannot hold this mesh.
 */
typedef pmesh_status (*pmesh_base_encode)(void *user, const int32_t *positions,
                                          uint32_t vertex_count,
                                          const uint32_t *indices,
                                          uint32_t face_count, void *out,
                                          size_t capacity, size_t *size);

/* Called now and then with done in 0 .. 1; a non-zero return cancels. */
typedef int (*pmesh_progress)(void *user, const char *stage, double done);

typedef struct pmesh_encoder_config {
    pmesh_allocator allocator;
    pmesh_profile profile;     /* default PMESH_BALANCED */
    pmesh_placement placement; /* default PMESH_SUBSET */
    pmesh_metric metric;       /* default: the one measured best */
    uint8_t position_bits;     /* 4 .. 24, default 14 */
    uint8_t normal_bits;       /* 4 .. 16 per octahedral component, default 10 */
    uint8_t texcoord_bits;     /* 4 .. 16, default 12 */
    uint8_t color_bits;        /* 4 .. 16, default 8 */
    uint8_t generic_bits;      /* 4 .. 16, default 12 */
    double weld;               /* join positions this close, model units; 0:
                                  only equal ones */
    double threshold;          /* vertices this close may be contracted though
                                  they have no edge, model units; 0: none */
    pmesh_topology topology;   /* default PMESH_TOPOLOGY_AUTO */
    const pmesh_guide *guide;  /* NULL: every vertex counts the same */
    int lossless;              /* non-zero: a last layer with the input's
                                  positions, bit for bit, see below */
    /* Stops, of which the first one that is reached counts. */
    uint32_t base_faces;       /* stop at this many faces; 0: about 200 */
    uint32_t base_vertices;    /* ... or this many vertices; 0: no such stop */
    double base_ratio;         /* ... or this share of the faces; 0: no stop */
    double base_error;         /* ... or when the next level would be further
                                  than this, as pmesh_level.error tells, model
                                  units; 0: no such stop */
    int measure;               /* non-zero: the file tells of each level its
                                  distance to the full mesh, both ways, at 2^14
                                  points each: pmesh_level.rms, .furthest */
    pmesh_base_coder base_coder; /* default PMESH_BASE_NATIVE; Draco needs both
                                    hooks; often smaller from some 10,000 base
                                    faces on. A base that it cannot hold is
                                    coded natively: see the report */
    pmesh_base_encode base_encoder;
    pmesh_base_decode base_decoder; /* the numbers it gives are the file's */
    void *base_user;                /* of both hooks */
    /* How much attributes count in the costs: by how much of the model's
     * largest extent a difference of 1 does, per component. 0: no say at all,
     * as if there was no such attribute. No triangle of texture coordinates with
     * weight turns over, or loses its area, from level to level as long as
     * anything else can be contracted. */
    double normal_weight;      /* default 0.01 */
    double texcoord_weight;    /* default 0.1 */
    double color_weight;       /* default 0.03 */
    double generic_weight;     /* default 0 */
    pmesh_cost cost;           /* default PMESH_COST_QUADRIC; with another,
                                  contractions come strictly in its order, batch
                                  by batch, whatever the profile */
    double camera[3];          /* of the two camera costs, model units */
    pmesh_cost_hook cost_hook; /* of PMESH_COST_CUSTOM; asked about directed
                                  contractions: the pair's second vertex goes */
    void *cost_user;           /* of the hook */
    uint32_t threads;          /* at most so many, the calling one among them;
                                  default 1. More are POSIX threads for the time
                                  of the call; if there are none to be had, the
                                  calling thread does all. Hooks are called in
                                  it alone, but the allocator's with
                                  PMESH_COMPACT: there by others, too, one at a
                                  time. With PMESH_COST_CUSTOM always 1 */
    pmesh_progress progress;   /* NULL: none */
    void *progress_user;
} pmesh_encoder_config;

/*
 * Lossless: the file ends in the position of every vertex as a float, bit for
 * bit: -0, the smallest and the largest included. Doubles are rounded to floats
 * first, and one beyond FLT_MAX is not finite. Equal positions are then floats
 * of equal bits: what differs in the sign of a zero is counted (zero_twins) and
 * not joined, unless `weld` says so. Of joined vertices the first one's
 * position counts. All else of the file is as without: levels are coded on the
 * grid of `position_bits`, attributes keep their bits.
 */
PMESH_API pmesh_encoder_config pmesh_encoder_config_default(void);

/* What the values of an attribute take, wedges not counted. */
typedef struct pmesh_attribute_size {
    pmesh_attribute_kind kind;
    uint8_t set;
    uint64_t bytes; /* rounded; of the base mesh, too */
} pmesh_attribute_size;

/* What the encoder did. Counts are of the input unless they say otherwise. */
typedef struct pmesh_encode_report {
    pmesh_grid grid;
    uint32_t input_faces, input_vertices;
    uint32_t degenerate_faces;    /* dropped: two corners at one position */
    uint32_t duplicate_faces;     /* dropped: exact copies */
    uint32_t not_finite_faces;    /* dropped: a NaN or infinite position */
    uint32_t not_finite_values;   /* attribute tuples repaired */
    uint32_t welded_vertices;     /* joined with another of equal position */
    uint32_t unused_vertices;     /* no face uses them */
    uint32_t zero_twins;          /* lossless: positions that equal another but
                                     for the sign of a zero; not joined */
    uint32_t cut_vertices;        /* added where the surface is not manifold */
    uint32_t joined_vertices;     /* where it is not, and sheets stay together */
    int joined;                   /* non-zero: sheets and pieces may join */
    uint32_t base_components;     /* pieces of the base mesh */
    uint32_t components;          /* connected pieces of the surface */
    uint32_t faces, vertices, wedges; /* full detail of the file */
    pmesh_base_coder base_coder;  /* the one that was used */
    uint32_t base_faces, base_vertices;
    pmesh_simplify_end end;       /* why the base mesh is no coarser; exhausted:
                                     nothing was left to contract */
    uint32_t level_count;
    pmesh_level levels[PMESH_MAX_LEVELS];
    int measured;                 /* the levels are */
    uint64_t bytes;               /* the file */
    uint64_t bytes_header, bytes_base, bytes_connectivity, bytes_positions,
        bytes_attributes;         /* its parts, chunk framing in bytes_header */
    uint64_t bytes_lossless;      /* exact positions, framing included */
    double seconds_import, seconds_contract, seconds_code; /* 0: no clock */
    double (*clock)(void);        /* in: seconds, or NULL */
    uint64_t error_index;         /* with E_INDEX, E_NOT_FINITE: which face */
    uint32_t attribute_count;
    pmesh_attribute_size attributes[PMESH_MAX_ATTRIBUTES];
} pmesh_encode_report;

/* Takes the next `size` bytes of the file; non-zero reports a failure. */
typedef int (*pmesh_write)(void *user, const void *data, size_t size);

/*
 * Bakes `mesh` and writes the file front to back through `write`. Input is
 * checked, not trusted: any values give a status, never undefined behaviour.
 *
 * report: NULL or filled as far as the call came; set report->clock (or zero
 * the struct) before the call.
 *
 * Returns PMESH_OK, E_ARGUMENT (config or guide out of range), E_MEMORY,
 * E_LIMIT (more than 2^30 corners), E_CANCELLED, E_WRITE, E_NO_FACES, E_INDEX,
 * E_NOT_FINITE (every face has a position that is not finite), or E_CORRUPT (a
 * bug of ours: the file would not hold the mesh). On failure nothing has been
 * written, except with E_WRITE.
 */
PMESH_API pmesh_status pmesh_encode(const pmesh_mesh_input *mesh,
                                    const pmesh_encoder_config *config,
                                    pmesh_write write, void *user,
                                    pmesh_encode_report *report);

#ifdef __cplusplus
}
#endif
#endif
