/* SPDX-License-Identifier: MIT */
/* scene_instances.cpp - how many nodes show each mesh of a scene. */
#include <new>
#include <set>

#include "tools/scene_budget.h"
#include "tools/scene_writer.h"

namespace {

/* The streams of each glTF mesh: primitives of several materials share one. */
std::vector<std::set<uint32_t>> streams_of(const gltf_document &doc)
{
    std::vector<std::set<uint32_t>> streams;
    for (const gltf_document &mesh : doc.at("meshes")) {
        streams.emplace_back();
        for (const gltf_document &p : mesh.at("primitives")) {
            const auto extensions = p.find("extensions");
            if (extensions != p.end() && extensions->contains(GLTF_PROGRESSIVE))
                streams.back().insert(gltf_number_of(
                    extensions->at(GLTF_PROGRESSIVE).at("mesh")));
        }
    }
    return streams;
}

void count(const pmesh_scene *scene, uint32_t mesh_count, uint64_t *instances)
{
    const gltf_document doc = scene_document(scene);
    const auto streams = streams_of(doc);
    const auto nodes = doc.find("nodes");
    std::vector<uint64_t> shown(streams.size());

    if (nodes == doc.end())
        return;
    for (const gltf_document &node : *nodes) {
        const auto mesh = node.find("mesh");
        const uint32_t number =
            mesh == node.end() ? GLTF_NONE : gltf_number_of(*mesh);
        if (number < shown.size())
            shown[number]++;
    }
    for (size_t i = 0; i < streams.size(); i++)
        for (const uint32_t stream : streams[i])
            if (stream < mesh_count)
                instances[stream] += shown[i];
}

} // namespace

bool scene_instances(const pmesh_scene *scene, uint32_t mesh_count,
                     uint64_t *instances, asset_error *error)
{
    try {
        count(scene, mesh_count, instances);
        return true;
    } catch (const std::bad_alloc &) {
        return asset_fail(error, "", "out of memory");
    } catch (const gltf_document::exception &) {
        return asset_fail(error, "", "the document is no glTF of a scene");
    } catch (const std::runtime_error &e) {
        return asset_fail(error, "", "%s", e.what());
    } catch (...) {
        return asset_fail(error, "", "the document is unreadable");
    }
}
