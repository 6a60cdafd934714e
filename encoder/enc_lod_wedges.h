/* SPDX-License-Identifier: MIT */
/*
 * enc_lod_wedges.h - attributes and quadrics of an enc_lod's wedges, and what
 * becomes of them when two vertices do.
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
#ifndef ENC_LOD_WEDGES_H
#define ENC_LOD_WEDGES_H

#include "encoder/enc_joint.h"
#include "encoder/enc_lod.h"
#include "encoder/enc_lod_channels.h"

typedef struct enc_lod_wedges {
    enc_lod *lod;
    enc_lod_channels channels;
    /* Values of a wedge: `active` weighted ones, which are dimensions of the
     * quadrics, and behind them `passive` ones, interpolated. */
    unsigned active, passive;
    double *value;        /* per wedge */
    enc_quadric *quadric; /* per wedge, about its position and values */
    double *tail;         /* of it */
    double boundary, seam; /* weights of planes that hold lines */

    /* Of the pair that was gathered last. */
    uint32_t *list; /* wedges: those of the vertex that stays come first */
    uint32_t count, kept_count;
    uint32_t *fate;   /* per wedge: the one it becomes */
    uint32_t *choice; /* per wedge that goes: see enc_lod_onto_kept() */
    uint32_t *stamp;  /* per wedge: fate and next are of this pair */
    uint32_t now;
    double *next;     /* per wedge that is a fate: its values afterwards */
} enc_lod_wedges;

/* The ends of a pair as seen from the middle between them. */
typedef struct enc_lod_edge {
    double middle[3], half[3]; /* the latter leads to the end that goes */
    uint32_t gone, kept;
} enc_lod_edge;

/* `value` is taken over, on failure as well. */
pmesh_status enc_lod_wedges_create(enc_lod *lod,
                                   const enc_lod_channels *channels,
                                   double boundary, double seam, double *value,
                                   enc_lod_wedges *out);
void enc_lod_wedges_destroy(enc_lod_wedges *ws);

static inline size_t enc_lod_stride(const enc_lod_wedges *ws)
{
    return ws->active + ws->passive;
}

static inline const double *enc_lod_value(const enc_lod_wedges *ws,
                                          uint32_t wedge)
{
    return &ws->value[wedge * enc_lod_stride(ws)];
}

static inline double *enc_lod_tail(const enc_lod_wedges *ws, uint32_t wedge)
{
    return &ws->tail[wedge * enc_joint_tail(ws->active)];
}

/* Surveys v and computes its wedges' quadrics from its faces. */
void enc_lod_renew(enc_lod_wedges *ws, uint32_t v);
/* The latter alone: v was surveyed last, or lies on no lines. */
void enc_lod_sum_planes(enc_lod_wedges *ws, uint32_t v);

/* Lists the wedges at both ends and finds out which belong together: their
 * fate is the same, and one of `kept` if there is one. What follows is about
 * the pair that was gathered last. */
void enc_lod_gather(enc_lod_wedges *ws, uint32_t gone, uint32_t kept);

/* All wedges' quadrics together, about the middle and of the place alone: at
 * every place the attributes are the best for it. */
void enc_lod_sum(const enc_lod_wedges *ws, const enc_lod_edge *e,
                 enc_quadric *total);

/* True if the two have a wedge each, which have no values in the quadrics:
 * nearly all have, and then this is the same without gathering. */
static inline bool enc_lod_is_plain(const enc_lod_wedges *ws, uint32_t gone,
                                    uint32_t kept)
{
    return ws->active == 0 && ws->lod->lone[gone] != ENC_NONE &&
           ws->lod->lone[kept] != ENC_NONE;
}
void enc_lod_sum_plain(const enc_lod_wedges *ws, const enc_lod_edge *e,
                       enc_quadric *total);

/* The weight of all these planes. */
double enc_lod_weight(const enc_lod_wedges *ws);

/* Solves for the values of all fates at x, seen from the middle. */
void enc_lod_solve(enc_lod_wedges *ws, const enc_lod_edge *e,
                   const double x[3]);

/*
 * The value if `gone` goes to `kept` as that is, and the choices: a wedge that
 * goes takes on the best of the wedges at `kept` that it belongs to. Where
 * there is none it is infinite, or, to break seams, any will do.
 */
double enc_lod_onto_kept(enc_lod_wedges *ws, const enc_lod_edge *e,
                         bool break_seams);
/* Makes the choices fates. */
void enc_lod_choose(enc_lod_wedges *ws);

/* The values of a wedge at either end afterwards. */
static inline const double *enc_lod_next(const enc_lod_wedges *ws,
                                         uint32_t wedge)
{
    return ws->stamp[wedge] == ws->now
               ? &ws->next[ws->fate[wedge] * enc_lod_stride(ws)]
               : enc_lod_value(ws, wedge);
}

/* Fates get their values and the sum of their quadrics; positions are still
 * the old ones, and before enc_lod_contract(). */
void enc_lod_merge(enc_lod_wedges *ws, uint32_t gone, uint32_t kept,
                   const double place[3]);
/* Gives the corners of `kept` their wedges; after it. */
void enc_lod_settle(enc_lod_wedges *ws, uint32_t kept);

#endif
