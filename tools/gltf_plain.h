/* SPDX-License-Identifier: MIT */
/*
 * gltf_plain.h - the C++ side of the glTF bridge: a document with nothing in
 * it that tinygltf could stumble over. Functions throw std::runtime_error.
 */
#ifndef GLTF_PLAIN_H
#define GLTF_PLAIN_H

#include <cmath>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/gltf.h"

using gltf_json = nlohmann::json;

/*
 * of[name], which becomes an object, or a list, if it is not there. nlohmann's
 * operator[] and push_back make these of null, too; but where memory runs out on
 * the way, they leave a value behind whose destructor crashes.
 */
template <class json>
json &gltf_object(json &of, const char *name)
{
    json &at = of[name];
    if (at.is_null())
        at = json::object();
    return at;
}

template <class json>
json &gltf_list(json &of, const char *name)
{
    json &at = of[name];
    if (at.is_null())
        at = json::array();
    return at;
}

/* A whole number up to 2^53; UINT64_MAX for any other value: a conversion of
 * nlohmann's takes what is too large, or not whole, for something else. */
template <class json>
uint64_t gltf_number(const json &value)
{
    constexpr double limit = 9007199254740992.0; /* 2^53 */
    if (value.is_number_float()) {
        const double real = value.template get<double>();
        return real >= 0 && real <= limit && real == std::floor(real)
                   ? static_cast<uint64_t>(real)
                   : UINT64_MAX;
    }
    if (!value.is_number_integer())
        return UINT64_MAX;
    const auto whole = value.template get<int64_t>(); /* < 0 from 2^63 on */
    return whole >= 0 && whole <= int64_t{ 1 } << 53
               ? static_cast<uint64_t>(whole)
               : UINT64_MAX;
}

/* An element's number; GLTF_NONE, which no list has, for any other value. */
template <class json>
uint32_t gltf_number_of(const json &value)
{
    const uint64_t number = gltf_number(value);
    return number < GLTF_NONE ? static_cast<uint32_t>(number) : GLTF_NONE;
}

using gltf_bytes = std::vector<uint8_t>;

/* What a buffer holds: bytes of its own, or the source's. */
class gltf_blob {
public:
    gltf_blob() = default;
    gltf_blob(const uint8_t *data, size_t size) : first(data), count(size) {}
    explicit gltf_blob(gltf_bytes bytes)
        : own(std::move(bytes)), first(own.data()), count(own.size())
    {
    }
    gltf_blob(gltf_blob &&) = default; /* a moved vector keeps its place */
    gltf_blob &operator=(gltf_blob &&) = default;

    const uint8_t *data() const { return first; }
    size_t size() const { return count; }
    bool empty() const { return count == 0; }

private:
    gltf_bytes own;
    const uint8_t *first = nullptr;
    size_t count = 0;
};

struct gltf_plain {
    std::string text;             /* JSON without buffers */
    std::vector<gltf_blob> blobs; /* which are these */
    uint64_t byte_count = 0;      /* of the file and what lies beside it */
    std::set<std::string> sides;  /* which of these were counted */
};

/* Reads the source's JSON and keeps what triangles and their attributes need:
 * accessors, views and buffers in use, expanded; nodes; material names. */
gltf_plain gltf_make_plain(const gltf_source &source, gltf_budget &budget,
                           asset *warnings);

/* An element of one of the document's lists, with its name for messages. */
struct gltf_item {
    const gltf_json &value;
    const char *list;
    size_t number;

    [[noreturn]] void fail(const std::string &what) const;

    /* A member that is a whole number from 0 to 2^53, or `fallback`. */
    uint64_t whole(const char *member, uint64_t fallback) const;
    uint64_t whole(const char *member) const; /* must be there */

    /* A member that numbers an element of a list of `limit`, or GLTF_NONE. */
    uint32_t id(const char *member, size_t limit) const;

    /* A member that is an object, or nullptr. */
    const gltf_json *object(const char *member) const;

    /* One of its extensions, or nullptr. */
    const gltf_json *extension(const char *name) const;
};

/* `value`, which is the item's `member`, as an element's number. */
uint32_t gltf_to_id(const gltf_item &item, const char *member,
                    const gltf_json &value, size_t limit);

/* Files beside the asset that were read, by their paths. */
struct gltf_sides {
    std::set<std::string> counted; /* by anyone */
    std::set<std::string> read;    /* by who goes over the document now */
};

/* To be called with each URI that was read, and how many bytes. The first time
 * a file adds to the budget as if the asset were larger by it; if it is read
 * again in the same walk its bytes are taken from that, since a few bytes name
 * it once more. True if it was the first time. */
bool gltf_pay_side(gltf_sides &sides, const gltf_item &from,
                   const std::string &uri, uint64_t size, gltf_budget &budget);

/* All that a buffer holds: of the BIN chunk, inline or beside the file. Files
 * are paid for; *first as from gltf_pay_side(). */
gltf_blob gltf_load_buffer(const gltf_source &source, const gltf_item &buffer,
                           gltf_sides &sides, gltf_budget &budget, bool *first);

/* Files that were counted while the model was loaded. */
const std::set<std::string> &gltf_sides_of(const gltf_model &model);

/* Whether geometry is complete without knowing the extension, which refers to
 * no accessor or view but where glTF itself does. */
bool gltf_is_harmless(const std::string &extension);

/* gltf_inflate.cpp */

/* The bytes of a view compressed by EXT_meshopt_compression; `source` is what
 * its byteOffset and byteLength cut out of the buffer. */
/* meshoptimizer's code of `count` elements, or of a primitive's indices, of
 * `stride` bytes each: what gltf_inflate() takes. */
gltf_bytes gltf_pack(const gltf_bytes &in, size_t count, size_t stride,
                     bool indices);

gltf_bytes gltf_inflate(const gltf_item &extension, const uint8_t *source,
                        size_t size, gltf_budget &budget);

/* A primitive's decoded KHR_draco_mesh_compression data. */
struct gltf_draco {
    struct attribute {
        std::string semantic;
        unsigned components;
        gltf_bytes values; /* float32, little-endian, one tuple per point */
    };
    size_t points, faces;
    gltf_bytes indices; /* u32 little-endian */
    std::vector<attribute> attributes;
};

/* `ids` is the extension's attribute map. An attribute whose accessor is
 * normalised is divided by what its integers call 1. */
gltf_draco gltf_inflate_draco(const gltf_item &primitive, const gltf_json &ids,
                              const std::vector<std::string> &normalised,
                              const uint8_t *source, size_t size,
                              gltf_budget &budget);

#endif
