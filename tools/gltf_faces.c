/* SPDX-License-Identifier: MIT */
/* gltf_faces.c - the triangles of a primitive, whatever its mode. */
#include "tools/gltf.h"

static const gltf_accessor *indices_of(const gltf_model *model,
                                       const gltf_primitive *p)
{
    return p->indices == GLTF_NONE ? NULL : &model->accessors[p->indices];
}

bool gltf_face_count(const gltf_model *model, const gltf_primitive *p,
                     const char *where, uint64_t *faces, asset_error *error)
{
    const gltf_accessor *position = &model->accessors[p->position];
    const gltf_accessor *indices = indices_of(model, p);

    if (position->components != 3 || position->type == GLTF_U32)
        return asset_fail(error, where, "POSITION has a wrong type");
    if (indices && (indices->components != 1 ||
                    (indices->type != GLTF_U8 && indices->type != GLTF_U16 &&
                     indices->type != GLTF_U32)))
        return asset_fail(error, where, "indices have a wrong type");

    const uint64_t corners = indices ? indices->count : position->count;
    if (p->mode == 4 && corners % 3 != 0)
        return asset_fail(error, where, "%llu corners are no triangles",
                          (unsigned long long)corners);
    *faces = p->mode == 4 ? corners / 3 : corners >= 3 ? corners - 2 : 0;
    return true;
}

/* Corner numbers of triangle `i` in the order of the glTF specification. */
static void triangle(uint32_t mode, uint64_t i, uint64_t corners[3])
{
    if (mode == 4) {
        for (unsigned k = 0; k < 3; k++)
            corners[k] = 3 * i + k;
    } else if (mode == 5) {
        corners[0] = i;
        corners[1] = i + 1 + i % 2;
        corners[2] = i + 2 - i % 2;
    } else {
        corners[0] = i + 1;
        corners[1] = i + 2;
        corners[2] = 0;
    }
}

static bool corner_vertex(const gltf_model *model, const gltf_primitive *p,
                          uint64_t corner, const char *where, uint32_t *v,
                          asset_error *error)
{
    const gltf_accessor *indices = indices_of(model, p);
    const uint64_t count = model->accessors[p->position].count;

    *v = (uint32_t)corner;
    if (!indices)
        return true; /* corners were counted from the positions */
    const uint32_t restart = indices->type == GLTF_U8    ? 0xFFu
                             : indices->type == GLTF_U16 ? 0xFFFFu
                                                         : 0xFFFFFFFFu;
    *v = gltf_index(indices, corner);
    if (*v == restart)
        return asset_fail(error, where, "index %llu is a primitive restart",
                          (unsigned long long)corner);
    if (*v >= count)
        return asset_fail(error, where,
                          "index %u is out of range (%llu vertices)",
                          (unsigned)*v, (unsigned long long)count);
    return true;
}

bool gltf_face(const gltf_model *model, const gltf_primitive *p, uint64_t i,
               const char *where, uint32_t v[3], asset_error *error)
{
    uint64_t corners[3];

    triangle(p->mode, i, corners);
    for (int k = 0; k < 3; k++) {
        if (!corner_vertex(model, p, corners[k], where, &v[k], error))
            return false;
    }
    return true;
}
