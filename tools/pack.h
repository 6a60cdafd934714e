/* SPDX-License-Identifier: MIT */
/* pack.h - text made small, and back: zlib streams (RFC 1950), by zlib. */
#ifndef PACK_H
#define PACK_H

#include "tools/asset.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Appends `data` packed, or what a packed stream holds, to `out`. False: out of
 * memory; of unpacking also a damaged stream, or more than `limit` bytes. */
bool pack_zlib(const void *data, size_t size, asset_bytes *out);
bool unpack_zlib(const void *data, size_t size, size_t limit, asset_bytes *out);

#ifdef __cplusplus
}
#endif
#endif
