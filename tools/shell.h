/* SPDX-License-Identifier: MIT */
/*
 * shell.h - the shape of the sample mesh: an ammonite, a closed surface of
 * rings around a spiral.
 *
 * The tube grows by a fixed factor per turn. It begins in a round tip, carries
 * ribs, knobs, a keel, growth lines and grain, ends in a lip, runs back inside
 * and is closed by a fluted wall. Arithmetic of the same bits everywhere.
 */
#ifndef SHELL_H
#define SHELL_H

#include <stdbool.h>
#include <stdint.h>

/* The parts of the surface on the way from the tip to the wall. */
typedef enum shell_part {
    SHELL_TIP,
    SHELL_TUBE,
    SHELL_LIP,
    SHELL_INSIDE,
    SHELL_WALL,
    SHELL_PARTS
} shell_part;

/* A closed curve around the spiral. */
typedef struct shell_ring {
    double turn;     /* where on the spiral, turns from the tip */
    double scale;    /* of the cross section; 0: a point */
    double shift;    /* along the spiral, tube radii */
    double ornament; /* 0 .. 1 */
    double flute;    /* 0 .. 1 */
} shell_ring;

/* The ring at `at` = 0 .. 1 of a part. Parts meet: 1 is 0 of the next. */
shell_ring shell_ring_at(shell_part part, double at);

/* Radius of the spiral, and of the tube, at a turn. */
double shell_spiral_radius(double turn);
double shell_tube_radius(double turn);

/* About how far the surface moves per unit of `at`. */
double shell_speed(shell_part part, double at);

/* The point at `around` = 0 .. 1 of a ring; 0 and 1 face the axis. Detail that
 * edges of length `spacing` cannot show is left out. */
void shell_point(const shell_ring *ring, double around, double spacing,
                 double out[3]);

#endif
