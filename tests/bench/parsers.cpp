/* SPDX-License-Identifier: MIT */
#include "tests/bench/parsers.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <sstream>
#include <string>

#include <tiny_obj_loader.h>
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include <tiny_gltf.h>

namespace {

void load(const Bytes &file, tinygltf::Model *model)
{
    tinygltf::TinyGLTF loader;
    std::string error, warning;
    expect(loader.LoadBinaryFromMemory(model, &error, &warning, file.data(),
                                       static_cast<unsigned>(file.size())),
           "tinygltf fails");
}

/* Where an accessor's elements lie, `size` bytes each without gaps. */
const unsigned char *elements(const tinygltf::Model &model, int number,
                              std::size_t size, std::size_t *count)
{
    const tinygltf::Accessor &a =
        model.accessors.at(static_cast<std::size_t>(number));
    const tinygltf::BufferView &view =
        model.bufferViews.at(static_cast<std::size_t>(a.bufferView));
    const std::vector<unsigned char> &bytes =
        model.buffers.at(static_cast<std::size_t>(view.buffer)).data;
    const std::size_t at = view.byteOffset + a.byteOffset;
    expect((view.byteStride == 0 || view.byteStride == size) &&
               at <= bytes.size() && a.count <= (bytes.size() - at) / size,
           "a view is too short");
    *count = a.count;
    return bytes.data() + at;
}

template <class Number, class To>
std::unique_ptr<To[]> unpacked(const unsigned char *from, std::size_t count)
{
    std::unique_ptr<To[]> to(new To[count]);
    for (std::size_t i = 0; i < count; i++) {
        Number value;
        std::memcpy(&value, from + i * sizeof value, sizeof value);
        to[i] = value;
    }
    return to;
}

} // namespace

double parse_tinyobj(const Bytes &file)
{
    std::istringstream in(std::string(file.begin(), file.end()));
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warning, error;
    const double start = cpu_ms();
    expect(tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error,
                            &in), "tinyobjloader fails");
    return cpu_ms() - start;
}

double parse_tinygltf(const Bytes &file)
{
    tinygltf::Model model;
    const double start = cpu_ms();
    load(file, &model);
    return cpu_ms() - start;
}

double unpack_tinygltf(const Bytes &file)
{
    tinygltf::Model model;
    const double start = cpu_ms();
    load(file, &model);
    const tinygltf::Primitive &p = model.meshes.at(0).primitives.at(0);
    const bool wide =
        model.accessors.at(static_cast<std::size_t>(p.indices)).componentType ==
        TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    std::size_t vertices, corners;
    const unsigned char *from =
        elements(model, p.attributes.at("POSITION"), 12, &vertices);
    const auto positions = unpacked<float, double>(from, 3 * vertices);
    from = elements(model, p.indices, wide ? 4 : 2, &corners);
    const auto indices =
        wide ? unpacked<std::uint32_t, std::uint32_t>(from, corners)
             : unpacked<std::uint16_t, std::uint32_t>(from, corners);
    bool good = true;
    for (std::size_t i = 0; i < 3 * vertices; i++)
        good &= std::fabs(positions[i]) <= std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < corners; i++)
        good &= indices[i] < vertices;
    expect(good, "a number is out of range");
    return cpu_ms() - start;
}
