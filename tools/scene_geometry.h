/* SPDX-License-Identifier: MIT */
/*
 * scene_geometry.h - the vertices and indices of one primitive, out of a mesh at
 * its visible level. Functions throw std::runtime_error.
 */
#ifndef SCENE_GEOMETRY_H
#define SCENE_GEOMETRY_H

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "decoder/pmesh_decode.h"

/* How an attribute was stored, and is to be again. */
struct scene_form {
    uint32_t channel; /* of the mesh */
    unsigned components;
    uint32_t component_type;
    bool normalised, exact;
};

/* How floats may be quantised: to `bits` over `range` from the origin on, or
 * over what they span if the range is 0; not at all if `bits` is 0. */
struct scene_grid {
    unsigned bits = 0;
    float origin[3] = {}, range = 0;
};

/* Data of one accessor; rows are `stride` bytes apart. */
struct scene_array {
    std::vector<uint8_t> bytes;
    size_t count = 0;
    unsigned components = 0, stride = 0;
    uint32_t component_type = 0;
    bool normalised = false;
    std::vector<float> low, high; /* of floats */
    scene_grid grid;
};

/* A mesh at the level it shows now. */
class scene_geometry {
public:
    /* With `whole`, skin weights are integers whose sum is 1 exactly. */
    scene_geometry(const pmesh_decoder *decoder, bool inflate, bool whole);

    /* Chooses the faces of one material; their vertices are numbered in order
     * of appearance. A material without faces at this level gets one of no
     * area, since a primitive must have some: of three vertices in one place,
     * as an index that comes twice is an error to many. */
    void choose(uint32_t material);

    /* Of the chosen faces, as they are written; channels are the mesh's. */
    size_t vertex_count() const { return wedges.size(); }
    size_t corner_count() const { return corners.size(); }
    size_t channel_count() const { return header.attribute_count; }

    scene_array indices() const;
    scene_array positions() const;

    /* By semantic: JOINTS_n and WEIGHTS_n depend on each other, so all
     * attributes of a primitive are made at once. */
    std::map<std::string, scene_array>
    attributes(const std::map<std::string, scene_form> &forms);

    /* Of a morph target: floats as they are. */
    scene_array differences(const scene_form &form);

private:
    const pmesh_decoder *decoder;
    pmesh_header header;
    pmesh_view view;
    bool whole_weights;
    scene_grid grid;
    std::vector<float> xyz;
    std::vector<std::vector<float>> channels; /* filled when needed */
    std::vector<uint32_t> order, first;       /* faces by material */
    std::vector<uint32_t> number;             /* wedge -> vertex */
    std::vector<uint32_t> wedges, corners;    /* of the chosen faces */

    void find_grid(bool inflated);
    const std::vector<float> &channel(uint32_t number);
    std::vector<float> gather(const scene_form &form);
};

#endif
