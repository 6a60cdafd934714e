/* SPDX-License-Identifier: MIT */
/*
 * pmesh_simplify.h - fewer triangles for a mesh in memory; no file is involved.
 *
 *   size_t n;
 *   uint32_t *lod = malloc(face_count * 3 * sizeof *lod);
 *   pmesh_simplify(indices, face_count, xyz, vertex_count, 3 * sizeof *xyz,
 *                  face_count / 10, 0, lod, &n, NULL);
 *   draw(xyz, lod, 3 * n);
 *
 * Edges are contracted one by one, always the cheapest, by quadric error
 * metrics: Garland and Heckbert, Surface Simplification Using Quadric Error
 * Metrics, 1997, and Simplifying Surfaces with Color and Texture, 1998. As in
 * Lindstrom and Turk, Fast and Memory Efficient Polygonal Simplification, 1998,
 * quadrics are those of the current surface, and moved vertices keep the
 * volume. It is the most accurate way in this library, and slower than the
 * batches of pmesh_encode().
 *
 * Any triangle soup is legal. Vertices of equal position are one vertex with
 * several sets of attributes, so that no crack opens at a seam. Triangles with
 * two corners at one position or with a position that is not finite are left
 * out.
 *
 * Neither the unit nor the place of the model matters: all is computed
 * relative to its bounding box. Same input, same result, on every machine.
 * Calls do not share state.
 */
#ifndef PMESH_SIMPLIFY_H
#define PMESH_SIMPLIFY_H

#include "format/pmesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * The call for a result that indexes the vertices of the input.
 *
 * indices: 3 per face, counter-clockwise from outside. positions: xyz, `stride`
 * bytes apart (0: packed). Contracts until there are `faces` faces at most (0:
 * no such bound) and as long as the estimated distance to the original is
 * below `error` (model units; 0: no such bound); with neither bound as far as
 * it goes. It stops early, with more faces than asked, when nothing more can
 * be contracted: a piece of the surface keeps its topology.
 *
 * out: room for 3 * face_count indices, which may be `indices` itself.
 * *out_faces: how many faces it has got. *out_error: the estimated distance, or
 * pass NULL.
 *
 * Returns PMESH_OK or what pmesh_simplify_mesh() returns.
 */
PMESH_API pmesh_status pmesh_simplify(const uint32_t *indices,
                                      size_t face_count,
                                      const float *positions,
                                      size_t vertex_count, size_t stride,
                                      size_t faces, double error,
                                      uint32_t *out, size_t *out_faces,
                                      double *out_error);

/* ---- everything else ----------------------------------------------------- */

/* Where the vertex goes that a contracted edge becomes. */
typedef enum pmesh_place {
    PMESH_PLACE_OPTIMAL = 0, /* to the quadric's minimum, keeping the volume
                                where that costs little; on the line, at the
                                middle or an end where there is no minimum */
    PMESH_PLACE_LINE = 1,    /* to the best place between the ends */
    PMESH_PLACE_MIDPOINT = 2,
    PMESH_PLACE_ENDPOINT = 3, /* to the better end: vertices of the result are
                                 vertices of the input */
    PMESH_PLACE_VOLUME = 4, /* where the volume within a closed surface stays
                               the same, whatever that costs */
    PMESH_PLACE_HULL = 5    /* to the best place outside of all faces around:
                               a closed surface grows, and each result encloses
                               the input (a progressive hull: Sander, Gu,
                               Gortler, Hoppe and Snyder, Silhouette Clipping,
                               2000). Hollows fill up; it ends early where no
                               such place is left */
} pmesh_place;

/* Which edge is contracted first. Placement goes by quadrics in any case. */
typedef enum pmesh_cost {
    PMESH_COST_QUADRIC = 0, /* squared distance to the planes, times the area
                               to the power of 3/4. What would leave a place
                               far behind, fold, turn a face, or make a sliver
                               or a vertex of many faces has to wait: it counts
                               as dearer */
    PMESH_COST_LENGTH = 1,  /* half the edge, nothing else */
    PMESH_COST_CAMERA = 2,  /* that, by 0.01 of the distance to the camera: what
                               is far goes first, whatever its shape */
    PMESH_COST_QUADRIC_CAMERA = 3, /* the quadric as the camera sees it: area
                                      and squared distance both shrink with the
                                      squared distance to the camera */
    PMESH_COST_CUSTOM = 4   /* the hook's */
} pmesh_cost;

/* What a cost hook is told, in model units. */
typedef struct pmesh_simplify_pair {
    uint32_t vertices[2];     /* an input vertex at either end */
    const double *positions[2]; /* of the ends, as they are now */
    double place[3];          /* of the vertex they become */
    double quadric;           /* area times squared distance */
    double distance;          /* root of its mean: what `error` is about */
} pmesh_simplify_pair;

/*
 * Hook: the cost of a contraction, >= 0; the least comes first. NaN, infinity
 * or a negative number forbids it. Must depend on the pair alone: it is asked
 * again whenever something around the pair has changed.
 */
typedef double (*pmesh_cost_hook)(void *user, const pmesh_simplify_pair *pair);

/*
 * One attribute. Values go with vertices: a corner of a face that has other
 * attributes at the same position is another vertex.
 *
 * weight: by how much of the model's largest extent a difference of 1 counts,
 * per component; 0: it has no influence and is interpolated along the edges.
 * 0.01 for normals, 0.1 for texture coordinates and 0.03 for colours drew the
 * best pictures of tests/bench/attributes.sh.
 *
 * Where an attribute varies within what becomes one triangle, no simplifier can
 * keep it at the vertices: bake it into a texture of the original, and give the
 * texture's coordinates here.
 */
typedef struct pmesh_simplify_attribute {
    pmesh_attribute_kind kind; /* normals are scaled to 1, colours clamped to
                                  0 .. 1, others to the range of the input; no
                                  triangle of texture coordinates turns over */
    uint8_t components;        /* 1 .. PMESH_MAX_COMPONENTS */
    const float *values;       /* finite; others count as 0 */
    size_t stride;             /* bytes; 0: packed */
    float weight[PMESH_MAX_COMPONENTS];
} pmesh_simplify_attribute;

/* The input, borrowed for the call. */
typedef struct pmesh_simplify_input {
    const uint32_t *indices;
    size_t face_count;
    size_t vertex_count;
    const float *positions; /* either these ... */
    const double *doubles;  /* ... or these; the other is NULL */
    size_t stride;          /* of the positions, bytes; 0: packed */
    const uint32_t *materials; /* per face: borders are held; NULL: none */
    const pmesh_simplify_attribute *attributes;
    size_t attribute_count; /* at most PMESH_MAX_ATTRIBUTES */
} pmesh_simplify_input;

typedef struct pmesh_simplify_options {
    pmesh_allocator allocator;
    /* Stops: the first one that is reached counts, 0 is none. */
    size_t faces;    /* at most so many */
    size_t vertices; /* distinct positions */
    double ratio;    /* faces by those of the input */
    double error;    /* no contraction with an estimated distance above this,
                        model units */
    pmesh_place placement; /* default PMESH_PLACE_OPTIMAL */
    pmesh_metric metric;   /* default PMESH_MEMORYLESS */
    double memory; /* with PMESH_MEMORYLESS: how much the planes of the original
                      count beside those of the current surface; default 0.35.
                      More lowers the largest error and thin parts last, less
                      lowers the mean at fine levels; 0: as in 1998 */
    pmesh_cost cost;       /* default PMESH_COST_QUADRIC */
    double camera[3];      /* of the two camera costs, model units */
    pmesh_cost_hook hook;  /* of PMESH_COST_CUSTOM */
    void *user;            /* of the hook */
    double weld;           /* join positions this close, model units */
    double threshold;      /* contract vertices without an edge, too, if they
                              are closer than this, model units, and no wall is
                              between them: parts that are apart grow together.
                              Each has 8 such pairs with later ones at most */
    double boundary;       /* weight of planes that hold edges of one face, in
                              squared lengths of the edge; default 10 */
    double seam;           /* the same of seams of attributes and of borders of
                              materials; default 3 */
    double turn_cosine;    /* no face that is left turns further away from how
                              it was in the input: the cosine of the angle;
                              default -1: no bound. One contraction turns none
                              by more than 78 degrees in any case */
    int loose;             /* non-zero: when nothing else is left, pieces may
                              vanish, holes close, parts join; default 0 */
} pmesh_simplify_options;

PMESH_API pmesh_simplify_options pmesh_simplify_options_default(void);

/* Why it ended. */
typedef enum pmesh_simplify_end {
    PMESH_END_FACES = 0,    /* options.faces or .ratio is reached */
    PMESH_END_VERTICES = 1, /* options.vertices is reached */
    PMESH_END_ERROR = 2,    /* what is left would exceed options.error */
    PMESH_END_EXHAUSTED = 3 /* nothing is left that may be contracted */
} pmesh_simplify_end;

/* The result; memory is the caller's. Members may be NULL but for `indices`. */
typedef struct pmesh_simplify_output {
    uint32_t *indices;     /* room for 3 * face_count of the input */
    uint32_t *position_indices; /* the same size: a vertex at the same place,
                                   one number for each place */
    uint32_t *face_source; /* room for face_count: which face of the input */
    /* Vertices at their new places, by the numbers of the input's: those that
     * `indices` does not name are as they were. Without any of these two, and
     * with attributes and no attribute_values, the placement is
     * PMESH_PLACE_ENDPOINT whatever the options say. */
    double *positions;     /* room for 3 * vertex_count */
    float *attribute_values[PMESH_MAX_ATTRIBUTES]; /* room for components *
                              vertex_count each, packed */

    size_t face_count, vertex_count; /* vertices: distinct positions */
    pmesh_simplify_end end;
    double error; /* estimated distance to the original, root mean square where
                     it is largest, model units; never falls while faces do */
    double cost_least, cost_mean, cost_most; /* of the contractions that may
                     come next, those that wait apart; 0 if there is none */
    size_t joined;        /* contractions without an edge: see threshold */
    size_t dropped_faces; /* of the input: degenerate or not finite */
} pmesh_simplify_output;

/*
 * Simplifies `mesh`. `out` gives the buffers and gets the rest; what it had in
 * the other members does not matter.
 *
 * Returns PMESH_OK, also when a bound was not met (out->end says so);
 * E_ARGUMENT (options out of range, a buffer missing), E_MEMORY, E_LIMIT (more
 * than 2^30 corners or 2^32 - 2 vertices), E_INDEX, E_NO_FACES, E_NOT_FINITE
 * (no face has finite positions). On failure the contents of the buffers are
 * undefined.
 */
PMESH_API pmesh_status
pmesh_simplify_mesh(const pmesh_simplify_input *mesh,
                    const pmesh_simplify_options *options,
                    pmesh_simplify_output *out);

#ifdef __cplusplus
}
#endif
#endif
