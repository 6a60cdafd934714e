/* SPDX-License-Identifier: MIT */
/*
 * enc_lod_price.h - what a contraction of an enc_lod costs, where the vertex
 * goes, and with which attributes.
 *
 * Each wedge has the joint quadric of its own faces. When u and v become one,
 * wedges that faces between u and v connect become one, too, and the rest stay
 * apart; all share the position:
 *
 *      a | b      u has the wedges a, b, and v has c, d: a and c become one,
 *        u        b and d become one, and the seam stays where it is.
 *      a | b      With v on the left side only, a and c become one, and b
 *     ---v---     stays alone.
 *      c | d
 */
#ifndef ENC_LOD_PRICE_H
#define ENC_LOD_PRICE_H

#include "encoder/enc_joint.h"
#include "encoder/enc_lod.h"
#include "encoder/enc_lod_channels.h"
#include "encoder/pmesh_simplify.h"

/* From model units to the frame of the enc_lod, where the bounding box is a
 * unit cube about the origin, and back: model = origin + extent * p. */
typedef struct enc_lod_frame {
    double origin[3];
    double extent; /* > 0 */
} enc_lod_frame;

typedef struct enc_lod_pricer {
    enc_lod *lod;
    const pmesh_simplify_options *options;
    enc_lod_frame frame;
    pmesh_place placement;
    /* Values of a wedge: `active` weighted ones, which are dimensions of the
     * quadrics, and behind them `passive` ones, interpolated. */
    unsigned active, passive;
    enc_lod_channels channels;
    double *value; /* per wedge */
    enc_quadric *quadric; /* per wedge, about its position and values */
    double *tail;         /* of it; NULL without active values */
    /* Per vertex: planes of the original's faces, summed. Beside the quadrics
     * of the current surface, `recall` times as heavy, they keep thin limbs
     * from being forgotten; and they tell the distance to the original. */
    enc_quadric *memory;
    double recall;
    bool break_seams; /* PMESH_PLACE_ENDPOINT: a wedge may go where it does not
                         belong, on the other side of a seam */

    /* The wedges around the last pair; see gather(). */
    uint32_t *wedge; /* list: those of the vertex that stays come first */
    uint32_t wedge_count, kept_count;
    uint32_t *fate;   /* per wedge: the one it becomes */
    uint32_t *choice; /* per wedge that goes: the best fate; see onto_kept() */
    uint32_t *stamp; /* per wedge: fate and next are of this offer */
    uint32_t now;
    double *next; /* per wedge that is a fate: its values afterwards */
} enc_lod_pricer;

typedef struct enc_lod_offer {
    uint32_t gone, kept;
    double place[3];
    double cost;     /* infinite: impossible */
    double quadric;  /* of the current surface and attributes, and of memory */
    double distance; /* squared, to the planes of the original */
} enc_lod_offer;

/* `value` is taken over, on failure as well. */
pmesh_status enc_lod_pricer_create(enc_lod *lod,
                                   const pmesh_simplify_options *options,
                                   const enc_lod_frame *frame,
                                   pmesh_place placement,
                                   const enc_lod_channels *channels,
                                   double *value, enc_lod_pricer *out);
void enc_lod_pricer_destroy(enc_lod_pricer *p);

/* Surveys v and computes its wedges' quadrics from its faces. */
void enc_lod_pricer_renew(enc_lod_pricer *p, uint32_t v);

/* Starts the memory of v with its faces as they are; after the renewal. */
void enc_lod_pricer_remember(enc_lod_pricer *p, uint32_t v);

/* The cost of contracting u and v, no more: cheap. With PMESH_PLACE_ENDPOINT,
 * `turn` asks for the worse direction. */
double enc_lod_pricer_cost(enc_lod_pricer *p, uint32_t u, uint32_t v,
                           bool turn);

/* All of it. */
enc_lod_offer enc_lod_pricer_offer(enc_lod_pricer *p, uint32_t u, uint32_t v,
                                   bool turn);

/* The values of a wedge at either end after the last offer. */
static inline const double *enc_lod_pricer_next(const enc_lod_pricer *p,
                                                uint32_t wedge)
{
    const size_t stride = p->active + p->passive;

    return p->stamp[wedge] == p->now ? &p->next[p->fate[wedge] * stride]
                                     : &p->value[wedge * stride];
}

/* Moves the kept vertex and sets its values; before enc_lod_contract(). */
void enc_lod_pricer_move(enc_lod_pricer *p, const enc_lod_offer *offer);
/* Gives the corners of the kept vertex their wedges; after it. */
void enc_lod_pricer_settle(enc_lod_pricer *p, const enc_lod_offer *offer);

#endif
