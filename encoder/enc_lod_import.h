/* SPDX-License-Identifier: MIT */
/*
 * enc_lod_import.h - the caller's mesh into an enc_lod.
 */
#ifndef ENC_LOD_IMPORT_H
#define ENC_LOD_IMPORT_H

#include "encoder/enc_lod.h"
#include "encoder/enc_lod_channels.h"
#include "encoder/enc_lod_price.h"

/* A position of the input as it is. */
void enc_lod_input_position(const pmesh_simplify_input *in, size_t vertex,
                            double out[3]);

/*
 * Checks the input, finds the frame, joins positions closer than `weld`,
 * makes the mesh, with pairs of vertices closer than `threshold`, and the rows of its values, which go to *value with room for all vertices.
 *
 * exact: every input vertex is a wedge of its own, since the result is going
 * to name it; else those that agree in position and values are one.
 *
 * Returns PMESH_OK or a status of pmesh_simplify_mesh() with nothing to free.
 */
pmesh_status enc_lod_import(const pmesh_allocator *allocator,
                            const pmesh_simplify_input *in, double weld,
                            double threshold, bool exact,
                            enc_lod_channels *channels, enc_lod_frame *frame,
                            enc_lod *lod, double **value);

#endif
