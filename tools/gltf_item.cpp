/* SPDX-License-Identifier: MIT */
/* gltf_item.cpp - checked members of a JSON object. */
#include "tools/gltf_plain.h"

static uint64_t to_whole(const gltf_item &item, const char *member,
                         const gltf_json &value)
{
    const uint64_t number = gltf_number(value);
    if (number == UINT64_MAX)
        item.fail(std::string(member) + " is not a whole number in range");
    return number;
}

uint32_t gltf_to_id(const gltf_item &item, const char *member,
                    const gltf_json &value, size_t limit)
{
    const uint64_t id = to_whole(item, member, value);
    if (id >= limit)
        item.fail(std::string(member) + " " + std::to_string(id) +
                  " is not there (" + std::to_string(limit) + " are)");
    return static_cast<uint32_t>(id);
}

void gltf_item::fail(const std::string &what) const
{
    throw std::runtime_error(std::string(list) + "[" + std::to_string(number) +
                             "]: " + what);
}

uint64_t gltf_item::whole(const char *member, uint64_t fallback) const
{
    const auto found = value.find(member);
    return found == value.end() ? fallback : to_whole(*this, member, *found);
}

uint64_t gltf_item::whole(const char *member) const
{
    if (!value.contains(member))
        fail(std::string(member) + " is missing");
    return whole(member, 0);
}

uint32_t gltf_item::id(const char *member, size_t limit) const
{
    const auto found = value.find(member);
    return found == value.end() ? GLTF_NONE
                                : gltf_to_id(*this, member, *found, limit);
}

const gltf_json *gltf_item::object(const char *member) const
{
    const auto found = value.find(member);
    if (found == value.end())
        return nullptr;
    if (!found->is_object())
        fail(std::string(member) + " is not an object");
    return &*found;
}

const gltf_json *gltf_item::extension(const char *name) const
{
    const gltf_json *all = object("extensions");
    if (!all)
        return nullptr;
    return gltf_item{ *all, list, number }.object(name);
}
