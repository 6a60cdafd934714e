/* SPDX-License-Identifier: MIT */
/*
 * enc_match.h - finds a mesh again in a copy whose vertices and faces are
 * numbered otherwise.
 */
#ifndef ENC_MATCH_H
#define ENC_MATCH_H

#include "format/mesh.h"

/*
 * If `copy` is `mesh` with other numbers: sets edge_of[h], for every half-edge
 * h of the copy, to the mesh's half-edge that runs between the same positions
 * and has the same neighbours, each one once. Positions may repeat.
 *
 * *same is false if it is not, or if so many faces lie upon each other that the
 * search is given up. Returns PMESH_OK, or PMESH_E_MEMORY.
 */
pmesh_status enc_match(const pmesh_allocator *allocator, const pmesh_mesh *mesh,
                       const pmesh_mesh *copy, uint32_t *edge_of, bool *same);

#endif
