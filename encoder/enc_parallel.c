/* SPDX-License-Identifier: MIT */
#include "encoder/enc_parallel.h"

/* The best continuation of an irregular vertex must be this straight. */
#define MIN_COSINE 0.8

static void along(const enc_surface *s, uint32_t h, double out[3])
{
    const int32_t *from = s->position[s->vertex[h]];
    const int32_t *to = s->position[s->vertex[enc_next(h)]];

    for (int i = 0; i < 3; i++)
        out[i] = (double)(to[i] - from[i]);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The half-edge that continues h beyond its end, or ENC_NONE. */
static uint32_t straight_on(const enc_surface *s, uint32_t h)
{
    if (h == ENC_NONE || s->twin[h] == ENC_NONE)
        return ENC_NONE;
    const uint32_t end = s->vertex[enc_next(h)];
    if (s->degree[end] == 6 && !enc_on_boundary(s, end)) {
        const uint32_t side = enc_turn(s, s->twin[h]);
        return enc_turn(s, enc_turn(s, side));
    }

    uint32_t best = ENC_NONE, g = s->first[end];
    double most = 0, d[3], x[3];

    along(s, h, d);
    do {
        along(s, g, x);
        const double cosine = dot(d, x);
        /* The cosine's square, but for the factor that all share. */
        const double straight =
            cosine > 0 ? cosine * cosine / (dot(x, x) * dot(d, d)) : 0;
        if (straight > most && straight > MIN_COSINE * MIN_COSINE) {
            most = straight;
            best = g;
        }
        g = enc_turn(s, g);
    } while (g != ENC_NONE && g != s->first[end]);
    return best;
}

/*
 *         left ---> .        On a regular grid all five run the same way; the
 *        /    \    /         row to the left starts half an edge later, the one
 *   --> u ---> v -->         to the right half an edge earlier. So does the
 *        \    /              row beyond it, in the same sense: the pattern has
 *    . -> right              no mirror image in it.
 */
void enc_parallel_pairs(const enc_surface *s, const enc_pair *pair,
                        enc_direction out[4])
{
    for (int i = 0; i < 4; i++)
        out[i] = (enc_direction){ ENC_NONE, false };

    if (pair->right != ENC_NONE) {
        /* Beyond child -> right wing: the half-edge that ends at the wing. */
        const uint32_t beyond = s->twin[enc_next(pair->right)];
        if (beyond != ENC_NONE)
            out[0] = (enc_direction){ enc_prev(beyond), false };
        const uint32_t behind = straight_on(s, straight_on(s, pair->right));
        out[3] = (enc_direction){ behind, true };
    }
    if (pair->left != ENC_NONE) {
        /* Beyond left wing -> parent: the half-edge that ends at the wing. */
        const uint32_t beyond = s->twin[enc_next(pair->left)];
        if (beyond != ENC_NONE)
            out[1] = (enc_direction){ enc_prev(beyond), true };
        out[2].edge = straight_on(s, straight_on(s, pair->left));
    }
}
