/* SPDX-License-Identifier: MIT */
/*
 * scene_lods.cpp - a scene at several levels, by MSFT_lod: a node with a mesh
 * refers to nodes that stand for it, with coarser ones, and says down to which
 * share of the screen each is to be shown.
 *
 *   node - extensions.MSFT_lod.ids: [node 1, node 2]
 *        - extras.MSFT_screencoverage: [0.3, 0.05, 0]
 */
#include <algorithm>
#include <cmath>

#include "tools/scene_writer.h"

namespace {

/* Lines of a screen, on which an error is to take one at most. */
constexpr double lines = 1000;

/*
 * Share of the screen's area at which a mesh with this error is as good as the
 * full one: of its diagonal d a line shows d / h, where h is its height in
 * lines, which is sqrt(share) of them all.
 */
double coverage(const pmesh_decoder *dec)
{
    pmesh_header header;
    pmesh_view view;

    if (!dec || pmesh_decoder_header(dec, &header) != PMESH_OK ||
        pmesh_decoder_mesh(dec, &view) != PMESH_OK || !(view.error > 0))
        return 1;
    double square = 0;
    for (const int32_t bound : header.bounds)
        square += std::pow(header.grid.step * bound, 2);
    const double height = std::sqrt(square) / static_cast<double>(view.error);
    return std::min(1.0, std::pow(height / lines, 2));
}

} // namespace

/* Appends each coded mesh at a level. */
void scene_writer::add_level(size_t level, const gltf_document &originals)
{
    const pmesh_scene_target target = { style.lod_faces[level], 0, 0 };

    pmesh_scene_refine(scene, &target, nullptr);
    meshes.clear();
    written.clear();
    for (size_t i = 0; i < originals.size(); i++) {
        gltf_document mesh = originals[i];
        double share = 1;
        for (const gltf_document &p : mesh.at("primitives")) {
            const auto found = p.find("extensions");
            if (found != p.end() && found->contains(GLTF_PROGRESSIVE))
                share = std::min(share,
                                 coverage(pmesh_scene_mesh(
                                     scene, gltf_number_of(
                                                found->at(GLTF_PROGRESSIVE)
                                                    .at("mesh")))));
        }
        if (!fill(mesh) && level > 0)
            continue;
        coverages[i].push_back(share);
        if (level > 0) {
            chains[i].push_back(doc["meshes"].size());
            doc["meshes"].push_back(std::move(mesh));
        } else {
            doc["meshes"][i] = std::move(mesh);
        }
    }
}

/* A node whose children have to stay visible gives its mesh to a new one. */
void scene_writer::chain_node(size_t node, const std::vector<size_t> &chain)
{
    gltf_document &nodes = doc["nodes"];
    const uint32_t mesh = gltf_number_of(nodes[node].at("mesh"));
    gltf_document ids = gltf_document::array(), shares = ids;

    if (nodes[node].contains("children")) {
        gltf_document inner = { { "mesh", mesh } };
        for (const char *member : { "skin", "weights" })
            if (nodes[node].contains(member)) {
                inner[member] = nodes[node][member];
                gltf_erase(nodes[node], member);
            }
        gltf_erase(nodes[node], "mesh");
        gltf_list(nodes[node], "children").push_back(nodes.size());
        node = nodes.size();
        nodes.push_back(std::move(inner));
    }
    for (size_t k = 0; k < chain.size(); k++) {
        gltf_document coarse = nodes[node];
        coarse["mesh"] = chain[k];
        ids.push_back(nodes.size());
        shares.push_back(coverages[mesh][k + 1]);
        nodes.push_back(std::move(coarse));
    }
    shares.push_back(0);
    gltf_object(nodes[node], "extensions")["MSFT_lod"] = {
        { "ids", std::move(ids) }
    };
    gltf_object(nodes[node], "extras")["MSFT_screencoverage"] =
        std::move(shares);
}

void scene_writer::lods()
{
    const gltf_document originals = doc.at("meshes");
    bool any = false;

    chains.resize(originals.size());
    coverages.resize(originals.size());
    for (size_t k = 0; k < style.lod_count; k++)
        add_level(k, originals);
    const size_t nodes = doc.contains("nodes") ? doc["nodes"].size() : 0;
    for (size_t i = 0; i < nodes; i++) {
        const gltf_document &node = doc["nodes"][i];
        const uint32_t mesh =
            node.contains("mesh") ? gltf_number_of(node["mesh"]) : GLTF_NONE;
        if (mesh >= originals.size() || chains[mesh].empty())
            continue;
        chain_node(i, chains[mesh]);
        any = true;
    }
    if (any)
        use_extension("MSFT_lod", false);
}
