/* SPDX-License-Identifier: MIT */
/* guide_file.cpp - NAME.guide.json, in and out; tools/guide.md describes it. */
#include "tools/guide_store.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <new>

namespace {

/* Of all constraints together: 256 MiB. A few bytes name all of a mesh. */
constexpr uint64_t most_named = uint64_t{ 1 } << 26;

/* A list of the document, or an empty one. */
const guide_json &list_of(const guide_json &in, const char *name)
{
    static const guide_json none = guide_json::array();
    const auto found = in.find(name);
    if (found == in.end())
        return none;
    if (!found->is_array())
        guide_fail(name, "a list is expected");
    return *found;
}

std::string entry(const char *list, size_t i)
{
    return std::string(list) + "[" + std::to_string(i) + "]";
}

double importance_of(const guide_json &item, const std::string &where)
{
    if (!item.is_object() || !item.contains("importance"))
        return 1;
    const double value = guide_number(item["importance"], where);
    if (!(value > 0))
        guide_fail(where + ".importance", "more than 0 is expected");
    return value;
}

void read_weights(const guide_json &in, const guide_finder &find,
                  std::vector<float> &weights)
{
    const guide_json &list = list_of(in, "weights");

    for (size_t i = 0; i < list.size(); i++) {
        const std::string where = entry("weights", i);
        std::vector<double> strength;
        if (list[i].is_object() && list[i].contains("values")) {
            std::vector<float> values;
            for (const auto &v : list[i]["values"])
                values.push_back(static_cast<float>(
                    std::clamp(guide_number(v, where + ".values"),
                               -static_cast<double>(FLT_MAX),
                               static_cast<double>(FLT_MAX))));
            if (values.size() != find.count())
                guide_fail(where + ".values",
                           std::to_string(values.size()) + " weights for " +
                               std::to_string(find.count()) + " vertices");
            weights = find.spread(values);
            continue;
        }
        const std::vector<uint32_t> at = find.find(list[i], where, &strength);
        if (!list[i].contains("weight"))
            guide_fail(where, "weight is missing");
        const double weight = guide_number(list[i]["weight"], where);
        if (!(weight >= 0 && weight <= 1))
            guide_fail(where + ".weight", "0 .. 1 is expected");
        for (size_t k = 0; k < at.size(); k++)
            weights[at[k]] += static_cast<float>(
                strength[k] * (weight - static_cast<double>(weights[at[k]])));
    }
}

void put_constraint(guide_store *to, pmesh_constraint_kind kind,
                    std::vector<uint32_t> vertices, double importance,
                    const std::string &where)
{
    to->named += vertices.size();
    if (to->named > most_named)
        guide_fail(where, "the constraints name more than 2^26 vertices");
    to->lists.push_back(std::move(vertices));
    to->constraints.push_back({ kind, to->lists.back().data(),
                                to->lists.back().size(), importance });
}

void read_constraints(const guide_json &in, const char *name,
                      pmesh_constraint_kind kind, const guide_finder &find,
                      guide_store *to, pmesh_guide *use)
{
    const guide_json &list = list_of(in, name);

    for (size_t i = 0; i < list.size(); i++) {
        const std::string where = entry(name, i);
        const guide_json &item = list[i];
        const double importance = importance_of(item, where);
        if (kind == PMESH_CONTOUR && item.is_object() &&
            (item.contains("crease") || item.contains("seams") ||
             item.contains("borders"))) {
            if (item.contains("crease"))
                use->crease = guide_number(item["crease"], where + ".crease");
            if (!(use->crease >= 0 && use->crease < 180))
                guide_fail(where + ".crease", "0 .. 180 is expected");
            use->seams |= item.value("seams", false);
            use->borders |= item.value("borders", false);
            use->importance = importance;
            continue;
        }
        std::vector<uint32_t> at = find.find(item, where);
        if (kind == PMESH_CONTOUR) {
            if (!item.contains("vertices") && !item.contains("positions"))
                guide_fail(where, "a contour is a path: vertices or positions "
                                  "are expected");
            if (item.value("closed", false) && !at.empty())
                at.push_back(at.front());
        }
        put_constraint(to, kind, std::move(at), importance, where);
    }
}

void read_segments(const guide_json &in, const guide_finder &find,
                   size_t vertex_count, guide_store *to)
{
    const guide_json &list = list_of(in, "segments");

    if (list.empty())
        return;
    if (list.size() > UINT16_MAX)
        guide_fail("segments", "too many");
    to->segments.assign(vertex_count, 0);
    to->shares.assign(list.size() + 1, 0);
    for (size_t i = 0; i < list.size(); i++) {
        const std::string where = entry("segments", i);
        for (const uint32_t v : find.find(list[i], where))
            to->segments[v] = static_cast<uint16_t>(i + 1);
        if (!list[i].contains("share"))
            continue;
        const double share = guide_number(list[i]["share"], where + ".share");
        if (!(share >= 0 && share <= 1))
            guide_fail(where + ".share", "0 .. 1 is expected");
        to->shares[i + 1] = share;
    }
}

void read_cameras(const guide_json &in, guide_store *to)
{
    const guide_json &list = list_of(in, "cameras");

    for (size_t i = 0; i < list.size(); i++) {
        const std::string where = entry("cameras", i);
        if (!list[i].is_object() || !list[i].contains("yaw") ||
            !list[i].contains("pitch"))
            guide_fail(where, "yaw and pitch are expected");
        to->names.push_back(list[i].value("name", std::to_string(i)));
        to->cameras.push_back({ to->names.back().c_str(),
                                guide_number(list[i]["yaw"], where),
                                guide_number(list[i]["pitch"], where) });
    }
}

/* A word that nobody knows is a slip of the pen, which would be silent. */
void check_members(const guide_json &in)
{
    static const char *const known[] = {
        "pmesh_guide", "source", "factor", "weights", "locks", "contours",
        "planes", "points", "segments", "cameras", "comment"
    };

    if (!in.is_object() || !in.contains("pmesh_guide"))
        throw std::runtime_error("no guide file: \"pmesh_guide\" is missing");
    if (!in["pmesh_guide"].is_number_unsigned() ||
        in["pmesh_guide"].get<uint64_t>() != 1)
        throw std::runtime_error("pmesh_guide: version 1 is expected");
    for (const auto &[name, value] : in.items()) {
        bool found = false;
        for (const char *word : known)
            found = found || name == word;
        if (!found)
            guide_fail(name.substr(0, 40), "no member of a guide");
    }
}

void read(const guide_json &in, const asset *mesh, guide *out)
{
    check_members(in);
    guide_store *to = static_cast<guide_store *>(out->owner);
    /* Not a copy, which would recurse as deep as it is nested. */
    static const guide_json none;
    const auto source = in.find("source");
    const guide_finder find(mesh, source == in.end() ? none : *source);
    if (find.is_other())
        to->warning = "the guide was made for another mesh: its vertices are "
                      "carried over to the nearest ones";
    if (in.contains("factor"))
        out->use.factor = guide_number(in["factor"], "factor");
    if (!(out->use.factor > 1))
        guide_fail("factor", "more than 1 is expected");
    if (!list_of(in, "weights").empty() && to->weights.empty())
        to->weights.assign(mesh->vertex_count, 0.5f);
    read_weights(in, find, to->weights);
    const guide_json &locks = list_of(in, "locks");
    for (size_t i = 0; i < locks.size(); i++) {
        to->locks.resize(mesh->vertex_count);
        for (const uint32_t v : find.find(locks[i], entry("locks", i)))
            to->locks[v] = 1;
    }
    read_constraints(in, "contours", PMESH_CONTOUR, find, to, &out->use);
    read_constraints(in, "planes", PMESH_PLANE, find, to, &out->use);
    read_constraints(in, "points", PMESH_POINT, find, to, &out->use);
    read_segments(in, find, mesh->vertex_count, to);
    read_cameras(in, to);
    to->publish(out);
}

} // namespace

void guide_store::publish(guide *out) const
{
    out->use.weights = weights.empty() ? nullptr : weights.data();
    out->use.locks = locks.empty() ? nullptr : locks.data();
    out->use.segments = segments.empty() ? nullptr : segments.data();
    out->use.shares = shares.empty() ? nullptr : shares.data();
    out->use.segment_count = static_cast<uint32_t>(shares.size());
    out->use.constraints = constraints.data();
    out->use.constraint_count = constraints.size();
    out->cameras = cameras.data();
    out->camera_count = cameras.size();
    out->warning = warning.c_str();
}

bool guide_create(guide *out)
{
    *out = {};
    out->use = pmesh_guide_default();
    out->warning = "";
    out->owner = new (std::nothrow) guide_store;
    return out->owner != nullptr;
}

void guide_free(guide *g)
{
    delete static_cast<guide_store *>(g->owner);
    *g = {};
}

/* FNV-1a over the positions and indices. */
void guide_hash(const asset *mesh, char out[17])
{
    uint64_t hash = 14695981039346656037u;
    const auto add = [&hash](uint64_t bits, unsigned size) {
        for (unsigned i = 0; i < size; i++)
            hash = (hash ^ (bits >> (8 * i) & 0xFF)) * 1099511628211u;
    };

    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        uint64_t bits;
        const double value = mesh->positions[i] + 0.0; /* -0 is 0 */
        memcpy(&bits, &value, sizeof bits);
        add(bits, 8);
    }
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        add(mesh->indices[i], 4);
    snprintf(out, 17, "%016llx", static_cast<unsigned long long>(hash));
}

bool guide_read(guide *g, const uint8_t *data, size_t size, const asset *mesh,
                asset_error *error)
{
    try {
        read(guide_json::parse(data, data + size), mesh, g);
        return true;
    } catch (const guide_json::parse_error &e) {
        char where[48];
        snprintf(where, sizeof where, "byte %zu", e.byte);
        return asset_fail(error, where, "not JSON");
    } catch (const std::bad_alloc &) {
        return asset_fail(error, "", "out of memory");
    } catch (const guide_json::exception &e) {
        return asset_fail(error, "", "a value of another kind is expected");
    } catch (const std::exception &e) {
        return asset_fail(error, "", "%s", e.what());
    }
}

bool guide_write(const guide *g, const asset *mesh, asset_bytes *out)
{
    char hash[17];

    guide_hash(mesh, hash);
    asset_printf(out, "{\n  \"pmesh_guide\": 1,\n  \"source\": {\n"
                      "    \"hash\": \"%s\",\n    \"vertices\": %zu,\n"
                      "    \"positions\": [", hash, mesh->vertex_count);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        char number[40];
        number[asset_number_print(number, mesh->positions[i])] = '\0';
        asset_printf(out, "%s%s%s", i ? "," : "", i % 3 ? " " : "\n      ",
                     number);
    }
    asset_printf(out, "\n    ]\n  },\n  \"factor\": 100,\n  \"weights\": [");
    if (g->use.weights) {
        asset_printf(out, "\n    { \"values\": [");
        for (size_t v = 0; v < mesh->vertex_count; v++) {
            char number[40];
            number[asset_number_print_float(number, g->use.weights[v])] = '\0';
            asset_printf(out, "%s%s%s", v ? "," : "", v % 10 ? " " : "\n      ",
                         number);
        }
        asset_printf(out, " ] }\n  ");
    }
    asset_printf(out, "],\n  \"locks\": [],\n  \"contours\": [],\n"
                      "  \"planes\": [],\n  \"points\": [],\n"
                      "  \"segments\": [],\n  \"cameras\": []\n}\n");
    return !out->failed;
}
