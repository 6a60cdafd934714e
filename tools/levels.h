/* SPDX-License-Identifier: MIT */
/*
 * levels.h - the level table, for people and as JSON.
 */
#ifndef LEVELS_H
#define LEVELS_H

#include <stdint.h>
#include <stdio.h>

#include "format/pmesh.h"
#include "tools/json.h"

/* How many of the levels the first `bytes` bytes of the file hold. */
uint32_t levels_within(const pmesh_level *levels, uint32_t count,
                       uint64_t bytes);

void levels_print(FILE *out, const pmesh_level *levels, uint32_t count,
                  bool measured);

/* The array "levels": objects with bytes, faces, vertices (distinct
 * positions), output_vertices and error. */
void levels_json(json *j, const pmesh_level *levels, uint32_t count,
                 bool measured);

const char *levels_profile_name(pmesh_profile profile);
const char *levels_placement_name(pmesh_placement placement);
const char *levels_kind_name(pmesh_attribute_kind kind);
const char *levels_base_name(pmesh_base_coder coder);

#endif
