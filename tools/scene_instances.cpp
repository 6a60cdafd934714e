/* SPDX-License-Identifier: MIT */
/* scene_instances.cpp - how many nodes show each mesh of a scene. */
#include <memory>
#include <new>
#include <set>

#include "tools/scene_budget.h"
#include "tools/scene_writer.h"

namespace {

/* The streams of each glTF mesh: primitives of several materials share one. */
std::vector<std::set<uint32_t>> streams_of(const gltf_json &doc)
{
    std::vector<std::set<uint32_t>> streams;
    for (const gltf_json &mesh : doc.at("meshes")) {
        streams.emplace_back();
        for (const gltf_json &p : mesh.at("primitives")) {
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
    asset_bytes plain = {};
    const std::unique_ptr<asset_bytes, void (*)(asset_bytes *)> text(
        &plain, asset_bytes_free);
    gltf_source source = {};
    asset unused = {};
    asset_error error;

    scene_read_document(scene, &plain);
    if (!gltf_open(plain.data, plain.size, &source, &unused, &error))
        throw std::runtime_error(std::string("the document is no glTF: ") +
                                 error.what);
    const gltf_json doc =
        gltf_json::parse(source.json, source.json + source.json_size);
    const auto streams = streams_of(doc);
    for (const gltf_json &node : doc.value("nodes", gltf_json::array())) {
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
    } catch (const gltf_json::exception &) {
        return asset_fail(error, "", "the document is no glTF of a scene");
    } catch (const std::runtime_error &e) {
        return asset_fail(error, "", "%s", e.what());
    } catch (...) {
        return asset_fail(error, "", "the document is unreadable");
    }
}
