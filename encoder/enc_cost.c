/* SPDX-License-Identifier: MIT */
#include "encoder/enc_cost.h"

#include <math.h>

/* Decides between contractions that cost nothing: short edges first. Far above
 * the rounding of sums, far below what can be seen. */
#define LENGTH_TIE 1e-12

/* The factor f of the camera cost. */
#define CAMERA_FACTOR 0.01

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void to_model(const enc_cost_rule *rule, const double x[3],
                     double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = rule->origin[i] + rule->unit * x[i];
}

/* In model units, and never 0. */
static double camera_distance(const enc_cost_rule *rule, const double x[3])
{
    double d[3];

    to_model(rule, x, d);
    for (int i = 0; i < 3; i++)
        d[i] -= rule->camera[i];
    const double far = sqrt(dot(d, d)), least = 1e-6 * rule->unit;
    return far > least ? far : least;
}

static double ask_hook(const enc_cost_rule *rule, const enc_cost_pair *pair)
{
    const double square = rule->unit * rule->unit;
    double ends[2][3];
    pmesh_simplify_pair told = {
        .vertices = { pair->kept, pair->gone },
        .positions = { ends[0], ends[1] },
        .quadric = pair->quadric * square * square,
        .distance = sqrt(pair->distance) * rule->unit,
    };

    to_model(rule, pair->ends[0], ends[0]);
    to_model(rule, pair->ends[1], ends[1]);
    to_model(rule, pair->place, told.place);
    const double cost = rule->hook(rule->user, &told);
    return cost >= 0 ? cost : INFINITY;
}

double enc_cost(const enc_cost_rule *rule, const enc_cost_pair *pair)
{
    const double square = dot(pair->half, pair->half), half = sqrt(square);
    const double tie = LENGTH_TIE * 16 * square * square;

    if (!(pair->quadric < INFINITY))
        return INFINITY;
    switch (rule->cost) {
    case PMESH_COST_LENGTH:
        return half * rule->unit;
    case PMESH_COST_CAMERA:
        return half * rule->unit /
               (CAMERA_FACTOR * camera_distance(rule, pair->middle));
    case PMESH_COST_QUADRIC_CAMERA: {
        const double far = camera_distance(rule, pair->place) / rule->unit;
        return (pair->quadric + tie) / (far * far * far * far);
    }
    case PMESH_COST_CUSTOM:
        return ask_hook(rule, pair);
    case PMESH_COST_QUADRIC:
        break;
    }
    return pair->quadric + tie;
}
