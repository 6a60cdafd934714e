/* SPDX-License-Identifier: MIT */
/* draco.h - what the two users of Draco, .drc and glTF, have in common. */
#ifndef DRACO_BRIDGE_H
#define DRACO_BRIDGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct draco_claim {
    bool mesh; /* else a point cloud, and the counts are 0 */
    uint64_t faces, points;
} draco_claim;

/* False if the bytes are no Draco stream or end inside its header. */
bool draco_claim_read(const uint8_t *data, size_t size, draco_claim *out);

#ifdef __cplusplus
}

#include <memory>
#include <vector>

#include <draco/mesh/mesh.h>

/* Decodes a mesh whose face corners all name points of it. Throws
 * std::runtime_error with a reason. */
std::unique_ptr<draco::Mesh> draco_decode(const uint8_t *data, size_t size);

/* The values of all points, `components` each, integers as they are; empty if
 * the attribute cannot be read so. */
std::vector<float> draco_values(const draco::Mesh &mesh,
                                const draco::PointAttribute &attribute,
                                unsigned components);

/* What an integer attribute's 1.0 is: 255, 32767 ...; 0 for real numbers. */
float draco_unit(const draco::PointAttribute &attribute);
#endif
#endif
