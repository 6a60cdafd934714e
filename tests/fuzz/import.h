/* SPDX-License-Identifier: MIT */
/*
 * import.h - what the targets of mesh files share: a mesh that was read is
 * sound, can be baked, and comes back.
 */
#ifndef IMPORT_H
#define IMPORT_H

#include "encoder/pmesh_encode.h"
#include "tests/fuzz/fuzz.h"
#include "tools/asset.h"

/* A file of that format, from memory and without side files: an error with a
 * reason, or a sound mesh; a small one is baked and decoded, and written in
 * other formats and read again. */
void fuzz_import(const uint8_t *data, size_t size, asset_format format);

/* Indices in range, text without control characters. */
void fuzz_asset_sound(const asset *mesh);
void fuzz_error_sound(const asset_error *error);

/* Bakes; the dice choose the options. */
pmesh_status fuzz_bake(const asset *mesh, fuzz_dice *dice, asset_bytes *out,
                       pmesh_encode_report *report);

#endif
