/* SPDX-License-Identifier: MIT */
/* gltf_pack.cpp - buffer data compressed by meshoptimizer. */
#include <cstring>

#include <meshoptimizer.h>

#include "tools/gltf_plain.h"

namespace {

std::vector<unsigned> widen(const gltf_bytes &in, size_t count, size_t stride)
{
    std::vector<unsigned> out(count);
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < stride; k++)
            out[i] |= unsigned{ in[i * stride + k] } << (8 * k);
    return out;
}

} // namespace

gltf_bytes gltf_pack(const gltf_bytes &in, size_t count, size_t stride,
                     bool indices)
{
    gltf_bytes out;

    if (indices) {
        /* Of the vertices only their number counts: one below 2^32. */
        out.resize(meshopt_encodeIndexBufferBound(count, count));
        out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(),
                                             widen(in, count, stride).data(),
                                             count));
    } else {
        out.resize(meshopt_encodeVertexBufferBound(count, stride));
        out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(),
                                              in.data(), count, stride));
    }
    if (out.empty())
        throw std::runtime_error("meshoptimizer cannot pack a buffer");
    return out;
}
