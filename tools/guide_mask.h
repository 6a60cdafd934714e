/* SPDX-License-Identifier: MIT */
/* guide_mask.h - a picture that says where detail is wanted. */
#ifndef GUIDE_MASK_H
#define GUIDE_MASK_H

#include "tools/asset.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct guide_mask {
    uint8_t *gray; /* row by row, from the top */
    uint32_t width, height;
} guide_mask;

bool guide_mask_read(const char *path, guide_mask *out, asset_error *error);
void guide_mask_free(guide_mask *mask);

/* The pixel at texture coordinates as glTF has them: v runs down, both repeat.
 * 0 .. 1. */
float guide_mask_at(const guide_mask *mask, float u, float v);

#ifdef __cplusplus
}
#endif
#endif
