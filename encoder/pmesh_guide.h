/* SPDX-License-Identifier: MIT */
/*
 * pmesh_guide.h - what matters of a mesh, as an artist says it.
 *
 *   const pmesh_constraint hoof = { .kind = PMESH_PLANE, .vertices = sole,
 *                                   .vertex_count = sole_count };
 *   pmesh_guide guide = pmesh_guide_default();
 *   guide.weights = painted;
 *   guide.constraints = &hoof;
 *   guide.constraint_count = 1;
 *   config.guide = &guide;            // of pmesh_encode()
 *
 * Weights say where detail stays longest: they scale what a contraction costs.
 * Constraints say where the vertices that are left shall be: they steer the
 * place of a contraction and are no part of its cost (Kho and Garland, User-
 * Guided Simplification, 2003). Locks and segments forbid contractions.
 *
 * All arrays are borrowed for the call and go with the vertices of the input;
 * a vertex that is welded to others takes the greatest of their values. Nothing
 * of a guide is stored in the file.
 */
#ifndef PMESH_GUIDE_H
#define PMESH_GUIDE_H

#include "format/pmesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pmesh_constraint_kind {
    PMESH_CONTOUR = 0, /* a path of vertices: what becomes of them stays on the
                          lines between neighbours in the list; repeat the first
                          one to close it */
    PMESH_PLANE = 1,   /* a set: stays on the plane that fits it best */
    PMESH_POINT = 2    /* a set: each one stays where it is */
} pmesh_constraint_kind;

/* Its pull on a vertex is 1000 * importance, at most 1e60, times that of the
 * faces around. */
typedef struct pmesh_constraint {
    pmesh_constraint_kind kind;
    const uint32_t *vertices;
    size_t vertex_count;
    double importance; /* 0 stands for 1 */
} pmesh_constraint;

typedef struct pmesh_guide {
    const float *weights; /* 0 .. 1 per vertex: costs are multiplied by
                             f^(2 weight - 1), so 0.5 changes nothing; NULL: all
                             0.5. NaN counts as 0.5 */
    double factor;        /* f at 10,000 vertices, > 1; at v vertices it is
                             factor * ln v / ln 10000. Default 100 */
    const uint8_t *locks; /* per vertex, not 0: stays, at its place; or NULL */
    const uint16_t *segments; /* per vertex, < segment_count: no contraction
                                 joins two of them; NULL: all 0 */
    const double *shares; /* of each segment: the share of a level's vertices,
                             0 .. 1, that it keeps at least once it has no more
                             than that; or NULL */
    uint32_t segment_count;
    const pmesh_constraint *constraints;
    size_t constraint_count;
    double crease;     /* degrees: edges that bend more are contours; 0: none */
    int seams;         /* non-zero: where attributes break are contours, */
    int borders;       /* ... and where materials do */
    double importance; /* of these contours, 0 stands for 1 */
} pmesh_guide;

PMESH_API pmesh_guide pmesh_guide_default(void);

#ifdef __cplusplus
}
#endif
#endif
