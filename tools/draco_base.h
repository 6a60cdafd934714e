/* SPDX-License-Identifier: MIT */
/* draco_base.h - the hooks through which the libraries reach Draco: a base mesh
 * into a Draco buffer, lossless, and back. `user` is not looked at. */
#ifndef DRACO_BASE_H
#define DRACO_BASE_H

#include "format/pmesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A pmesh_base_encode. */
pmesh_status draco_base_encode(void *user, const int32_t *positions,
                               uint32_t vertex_count, const uint32_t *indices,
                               uint32_t face_count, void *out, size_t capacity,
                               size_t *size);

/* A pmesh_base_decode. */
pmesh_status draco_base_decode(void *user, const void *data, size_t size,
                               uint32_t vertex_count, uint32_t face_count,
                               int32_t *positions, uint32_t *indices);

#ifdef __cplusplus
}
#endif
#endif
