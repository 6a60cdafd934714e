/* SPDX-License-Identifier: MIT */
#include "tools/shell.h"

#include <math.h>

#include "tools/trig.h"

#define TURNS 4.3
#define GROWTH_LOG 0.7654678421395714 /* ln 2.15: per turn */
#define TUBE 0.345      /* tube radius by spiral radius: whorls nearly touch */
#define FLATNESS 0.86   /* of the section, along the axis */
#define INSIDE_TURNS 0.20
#define LIP 0.15        /* thickness, tube radii */
#define RIBS 20.0       /* per turn */
#define END_ANGLE 0.10  /* of the mouth, turns from +x */

#define CIRCLE 6.283185307179586

/* ---- spiral ------------------------------------------------------------- */

/* exp() of the C library differs between machines; |x| stays below 4. */
static double exponential(double x)
{
    double term = 1;
    double sum = 1;
    for (int n = 1; n < 40; n++) {
        term *= x / n;
        sum += term;
    }
    return sum;
}

double shell_spiral_radius(double turn)
{
    return exponential(GROWTH_LOG * (turn - TURNS));
}

double shell_tube_radius(double turn)
{
    return TUBE * shell_spiral_radius(turn);
}

static double smooth_step(double from, double to, double x)
{
    const double t = fmax(0, fmin(1, (x - from) / (to - from)));
    return t * t * (3 - 2 * t);
}

shell_ring shell_ring_at(shell_part part, double at)
{
    shell_ring r = { .turn = TURNS, .scale = 1 };

    switch (part) {
    case SHELL_TIP: /* half a ball */
        r.turn = 0;
        r.scale = trig_sin(at / 4);
        r.shift = -trig_cos(at / 4);
        break;
    case SHELL_TUBE:
        r.turn = TURNS * at;
        r.ornament = smooth_step(0.5, 1.7, r.turn);
        break;
    case SHELL_LIP: /* half a circle, from outside to inside */
        r.scale = 1 - LIP * (1 - trig_cos(at / 2)) / 2;
        r.shift = LIP * trig_sin(at / 2) / 2;
        r.ornament = (1 + trig_cos(at / 2)) / 2;
        break;
    case SHELL_INSIDE:
        r.turn = TURNS - INSIDE_TURNS * at;
        r.scale = 1 - LIP;
        break;
    default: /* the wall */
        r.turn = TURNS - INSIDE_TURNS;
        r.scale = (1 - LIP) * (1 - at);
        r.shift = -0.25 * (1 - (1 - at) * (1 - at));
        r.flute = 4 * at * (1 - at) * (1 - at);
        break;
    }
    return r;
}

double shell_speed(shell_part part, double at)
{
    const shell_ring r = shell_ring_at(part, at);
    const double spiral = CIRCLE * shell_spiral_radius(r.turn);
    const double tube = shell_tube_radius(r.turn);

    switch (part) {
    case SHELL_TIP:
        return tube * CIRCLE / 4;
    case SHELL_TUBE:
        return spiral * TURNS;
    case SHELL_LIP:
        return tube * LIP * CIRCLE / 4;
    case SHELL_INSIDE:
        return spiral * INSIDE_TURNS;
    default:
        return tube;
    }
}

/* ---- relief ------------------------------------------------------------- */

/* A hill of width 2 and height 1. */
static double bump(double x)
{
    const double y = 1 - x * x;
    return y > 0 ? y * y * y : 0;
}

/* A sharp crest per unit. */
static double ridge(double x)
{
    const double c = 1 - fabs(2 * (x - floor(x)) - 1);
    return c * c * (1.5 - 0.5 * c);
}

static double lattice(int64_t x, int64_t y, int64_t z)
{
    uint64_t h = (uint64_t)x * 0x9e3779b97f4a7c15u ^
                 (uint64_t)y * 0xc2b2ae3d27d4eb4fu ^
                 (uint64_t)z * 0x165667b19e3779f9u;
    h ^= h >> 31;
    h *= 0xbf58476d1ce4e5b9u;
    h ^= h >> 29;
    return (double)(h >> 32) * 0x1p-31 - 1;
}

/* Smooth noise in -1 .. 1, of unit wavelength. */
static double noise(double x, double y, double z)
{
    const double cell[3] = { floor(x), floor(y), floor(z) };
    const double part[3] = { x - cell[0], y - cell[1], z - cell[2] };
    double sum = 0;

    for (int corner = 0; corner < 8; corner++) {
        double weight = 1;
        int64_t at[3];
        for (int k = 0; k < 3; k++) {
            const int high = corner >> k & 1;
            const double t = smooth_step(0, 1, part[k]);
            weight *= high ? t : 1 - t;
            at[k] = (int64_t)cell[k] + high;
        }
        sum += weight * lattice(at[0], at[1], at[2]);
    }
    return sum;
}

/* 0 if edges of this length cannot show this wavelength, 1 if they can. */
static double shown(double wavelength, double spacing)
{
    return smooth_step(2.5, 5, wavelength / spacing);
}

static double grain(const double *p, double radius, double spacing)
{
    double sum = 0;
    double height = 0.016;
    double frequency = 5;
    for (int octave = 0; octave < 7; octave++) {
        const double visible = shown(radius / frequency, spacing);
        if (visible > 0)
            sum += visible * height *
                   noise(p[0] * frequency, p[1] * frequency, p[2] * frequency);
        height *= 0.56;
        frequency *= 2.03;
    }
    return sum;
}

/*
 * Height over the plain tube, in tube radii. Ribs run up the sides, fork at a
 * row of knobs and cross the outer edge in twice the number.
 *
 *   axis  |  side  o===== outer edge
 *         |  ------o=====  (the keel runs across them)
 */
static double relief(double turn, double around, const double *p,
                     double spacing)
{
    const double across = around - 0.5; /* 0: outer edge */
    const double off = fabs(across);
    const double radius = shell_spiral_radius(turn);
    const double phase = RIBS * (turn + 0.011 * trig_cos(2 * across));
    const double fork = smooth_step(0.25, 0.18, off);
    const double sides = smooth_step(0.43, 0.30, off);
    const double ribs =
        (1 - fork) * ridge(phase) + 0.75 * fork * ridge(2 * phase);
    const double knob = bump((off - 0.215) / 0.034) *
                        bump((phase - floor(phase) - 0.5) / 0.30);
    const double keel = bump(across / 0.016);
    const double fine = 11 * phase + 0.8 * trig_sin(0.31 * phase);
    const double lines =
        ridge(fine) * shown(CIRCLE * radius / RIBS / 11, spacing);

    const double q[3] = { p[0] / radius, p[1] / radius, p[2] / radius };
    return 0.100 * sides * ribs + 0.10 * knob + 0.05 * keel +
           0.010 * sides * lines + grain(q, radius, spacing);
}

/* ---- surface ------------------------------------------------------------ */

void shell_point(const shell_ring *ring, double around, double spacing,
                 double out[3])
{
    const double radius = shell_spiral_radius(ring->turn);
    const double tube = shell_tube_radius(ring->turn);
    const double angle = ring->turn - TURNS + END_ANGLE;
    const double outward[2] = { trig_cos(angle), trig_sin(angle) };
    const double along[2] = { -outward[1], outward[0] };
    /* Around the section: from the axis over the front to the outer edge. */
    const double u = -trig_cos(around);
    const double w = trig_sin(around);
    double shift = ring->shift * tube;
    if (ring->flute > 0)
        shift += 0.22 * tube * ring->flute * trig_sin(9 * around);

    double scale = ring->scale * tube;
    double height = 0;
    if (ring->ornament > 0) {
        const double p[3] = { outward[0] * (radius + scale * u),
                              outward[1] * (radius + scale * u),
                              FLATNESS * scale * w };
        height = ring->ornament * relief(ring->turn, around, p, spacing);
    }
    scale += height * tube;
    for (int k = 0; k < 2; k++)
        out[k] = outward[k] * (radius + scale * u) + along[k] * shift;
    out[2] = FLATNESS * scale * w;
}
