/* SPDX-License-Identifier: MIT */
/* base64.h - bytes as text (RFC 4648, with padding). */
#ifndef BASE64_H
#define BASE64_H

#include "tools/asset.h"

void base64_put(asset_bytes *out, const uint8_t *data, size_t size);

#endif
