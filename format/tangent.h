/* SPDX-License-Identifier: MIT */
/*
 * tangent.h - where a tangent points (SPEC 6.6): along the surface, in the
 * direction in which the first texture coordinate grows.
 */
#ifndef PMESH_TANGENT_H
#define PMESH_TANGENT_H

#include "format/codec.h"

enum { PMESH_TANGENT_BITS = 14 };

/* Of wedge w, whose texture coordinates and normal are known, by its faces whose
 * other wedges are known: a vector of length 2^PMESH_TANGENT_BITS, or 0. */
void pmesh_tangent(const pmesh_codec *c, uint32_t w, int64_t tangent[3]);

#endif
