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
                streams.back().insert(extensions->at(GLTF_PROGRESSIVE)
                                          .at("mesh").get<uint32_t>());
        }
    }
    return streams;
}

void count(const pmesh_scene *scene, uint32_t mesh_count, uint64_t *instances)
{
    const gltf_document doc = scene_document(scene);
    const auto streams = streams_of(doc);
    for (const gltf_document &node :
         doc.value("nodes", gltf_document::array())) {
        const size_t mesh = node.value("mesh", streams.size());
        if (mesh < streams.size())
            for (const uint32_t stream : streams[mesh])
                if (stream < mesh_count)
                    instances[stream]++;
    }
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
