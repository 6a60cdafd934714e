/* SPDX-License-Identifier: MIT */
/*
 * gltf_document.h - the JSON of a scene, with its geometry taken out.
 * Functions throw std::runtime_error.
 */
#ifndef GLTF_DOCUMENT_H
#define GLTF_DOCUMENT_H

#include "tools/gltf_plain.h"

/* Keeps members in their order. */
using gltf_document = nlohmann::ordered_json;

#define GLTF_PROGRESSIVE "PMESH_progressive"

/* Which stream, and which material of it, a primitive became, and how. */
struct gltf_stream {
    uint32_t number = GLTF_NONE; /* GLTF_NONE: it is kept as it is */
    uint32_t material = 0;
    gltf_channels channels = {};
};

struct gltf_parts {
    std::string document;
    std::vector<gltf_bytes> resources;
    size_t early = 0;
    std::string outside; /* lines that name images left in their files */
};

/*
 * Writes the document. `streams` has an element for each primitive of the
 * model, which was loaded from `source` with everything. `sides` are the files
 * that were read for the model and since.
 */
gltf_parts gltf_take_apart(const gltf_source &source, const gltf_model &model,
                           const std::vector<gltf_stream> &streams,
                           gltf_sides &sides, gltf_budget &budget,
                           asset *warnings);

/* The largest scale of the instances of each mesh, over all scenes; 1e30 if it
 * is larger or not a number. */
std::vector<double> gltf_scales(const gltf_source &source, gltf_sides &sides,
                                gltf_budget &budget);

/* Erases a member if it is there. Not nlohmann's erase(), which moves the
 * members behind it in place and copies their names meanwhile: if memory runs
 * out then, what it leaves cannot even be destroyed. */
void gltf_erase(gltf_document &object, const char *member);

/* The same of an extension, and of what holds it if nothing else is left. */
void gltf_erase_extension(gltf_document &object, const char *name);

#endif
