/* SPDX-License-Identifier: MIT */
/* scene_writer.h - the state of scene_write(), private to its sources:
 * scene_write.cpp, for chains of levels scene_lods.cpp, scene_draco.cpp, and for
 * materials of OBJ scene_library.cpp. */
#ifndef SCENE_WRITER_H
#define SCENE_WRITER_H

#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "tools/gltf_document.h"
#include "tools/scene_geometry.h"
#include "tools/scene_write.h"

/* Throws std::runtime_error while the document has not arrived, or if it is no
 * glTF. */
gltf_document scene_document(const pmesh_scene *scene);

#define GLTF_DRACO "KHR_draco_mesh_compression"

class scene_writer {
public:
    scene_writer(pmesh_scene *from, scene_style how, asset *warn)
        : scene(from), style(how), notes(warn),
          budget(gltf_budget_for(pmesh_scene_get_progress(from).bytes))
    {
    }
    void write(asset_bytes *out);

private:
    pmesh_scene *scene;
    scene_style style;
    asset *notes;
    gltf_budget budget; /* of images, and what of meshes is written again */
    std::set<std::pair<uint32_t, uint32_t>> written; /* mesh, material */
    gltf_document doc;
    gltf_bytes bin;
    std::vector<size_t> free_accessors, free_views; /* the last is next */
    std::map<uint32_t, std::unique_ptr<scene_geometry>> meshes;
    bool uses_draco = false;
    size_t unpacked = 0; /* bytes of the buffer that packed views stand for */
    std::vector<std::vector<size_t>> chains; /* by mesh: it at each level */
    std::vector<std::vector<double>> coverages;
    std::vector<size_t> resource_start; /* in bin, or in the stream */
    std::vector<bool> in_stream;        /* by resource */
    std::vector<size_t> image_views;    /* that show one of these */
    std::map<size_t, const char *> endings; /* by image of the library */

    void open();
    std::vector<size_t> free_list(const char *name);
    size_t place(const char *list, std::vector<size_t> &free,
                 gltf_document value);
    void align(size_t to);
    static gltf_document accessor_of(const scene_array &data, size_t count,
                                     bool bounds);
    size_t add(const scene_array &data, int target, bool bounds);
    size_t add_described(const scene_array &data, size_t count, bool bounds);
    void pack_draco(gltf_document &p, scene_array positions,
                    const std::map<std::string, scene_array> &others,
                    scene_array indices, bool ordered);
    scene_form form(const gltf_document &record) const;
    scene_geometry &geometry(const gltf_document &record);
    gltf_document view_of(const scene_array &data, int target);
    void pay(const gltf_document &record, const scene_geometry &mesh);
    void primitive(gltf_document &p);
    bool fill(gltf_document &mesh);
    void lods();
    void add_level(size_t level, const gltf_document &originals);
    void chain_node(size_t node, const std::vector<size_t> &chain);
    void use_extension(const char *name, bool required);
    size_t image_of(const gltf_document &slot) const;
    const char *add_image(const gltf_document &image, size_t number);
    const char *library_image(size_t number);
    void library_map(const char *word, const gltf_document &slot);
    void library_material(const gltf_document &material);
    void library();
    void primitives();
    void drop_animations();
    void missing_images(const std::vector<bool> &missing);
    void resources();
    static uint64_t offset_of(const gltf_document &view);
    void move_views();
    void drop_marks();
    void add_stream();
    void put_glb(const std::string &json, asset_bytes *out) const;
};

#endif
