/* SPDX-License-Identifier: MIT */
/*
 * load.h - any mesh file into an asset, .pmesh included.
 *
 * A path that ends in .pmesh or bytes with its magic are a stream; the rest is
 * asset_read()'s, by the path's ending or else by the bytes.
 *
 * Functions that return int return an exit code (tools/cmd.h): CMD_DONE,
 * CMD_IO, CMD_ASSET or CMD_STREAM. If it is not CMD_DONE, *error says why and
 * there is nothing to free.
 */
#ifndef LOAD_H
#define LOAD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "decoder/pmesh_decode.h"
#include "tools/asset.h"
#include "tools/file.h"

/* `path` may be NULL or "-". */
bool load_is_stream(const file_data *data, const char *path);

/*
 * Copies the visible mesh of a decoder: one position per mesh vertex, origin +
 * step * q in doubles, or floats once exact ones have come; indices name the
 * mesh vertex, attributes have .indices with the output vertex of every corner. Fails (false, *out empty) before the
 * base mesh has arrived and when memory is out.
 */
bool asset_from_decoder(const pmesh_decoder *dec, asset *out,
                        asset_error *error);

/* Swells its positions, for display (pmesh_decoder_copy_inflated). False if
 * memory is out. */
bool asset_inflate(const pmesh_decoder *dec, asset *mesh);

/* A mesh file, or a .pmesh at full detail. Of a .pmesh that is cut off, what
 * is there, with a line in out->warnings; a damaged one fails. */
int load_mesh_data(const file_data *data, const char *path, asset *out,
                   asset_error *error);

/* Reads the file first; "-" is standard input. */
int load_mesh(const char *path, asset *out, asset_error *error);

#endif
