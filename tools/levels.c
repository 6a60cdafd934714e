/* SPDX-License-Identifier: MIT */
#include "tools/levels.h"

uint32_t levels_within(const pmesh_level *levels, uint32_t count,
                       uint64_t bytes)
{
    uint32_t n = 0;
    while (n < count && levels[n].bytes <= bytes)
        n++;
    return n;
}

void levels_print(FILE *out, const pmesh_level *levels, uint32_t count,
                  bool measured)
{
    fprintf(out,
            "level       bytes       faces    vertices       error  inflate%s\n",
            measured ? "         rms    furthest" : "");
    for (uint32_t i = 0; i < count; i++) {
        fprintf(out, "%5lu %11llu %11lu %11lu %11.4g %8.3f", (unsigned long)i,
                (unsigned long long)levels[i].bytes,
                (unsigned long)levels[i].faces,
                (unsigned long)levels[i].mesh_vertices,
                (double)levels[i].error, (double)levels[i].inflation);
        if (measured)
            fprintf(out, " %11.4g %11.4g", (double)levels[i].rms,
                    (double)levels[i].furthest);
        putc('\n', out);
    }
}

void levels_json(json *j, const pmesh_level *levels, uint32_t count,
                 bool measured)
{
    json_open(j, "levels", '[');
    for (uint32_t i = 0; i < count; i++) {
        json_open_flat(j, NULL, '{');
        json_count(j, "bytes", levels[i].bytes);
        json_count(j, "faces", levels[i].faces);
        json_count(j, "vertices", levels[i].mesh_vertices);
        json_count(j, "output_vertices", levels[i].vertices);
        json_float(j, "error", levels[i].error);
        json_float(j, "inflation", levels[i].inflation);
        if (measured) {
            json_float(j, "rms", levels[i].rms);
            json_float(j, "furthest", levels[i].furthest);
        }
        json_close(j);
    }
    json_close(j);
}

const char *levels_profile_name(pmesh_profile profile)
{
    switch (profile) {
    case PMESH_COMPACT: return "compact";
    case PMESH_BALANCED: return "balanced";
    case PMESH_QUALITY: return "quality";
    }
    return "unknown";
}

const char *levels_placement_name(pmesh_placement placement)
{
    switch (placement) {
    case PMESH_SUBSET: return "subset";
    case PMESH_OPTIMAL: return "optimal";
    }
    return "unknown";
}

const char *levels_kind_name(pmesh_attribute_kind kind)
{
    switch (kind) {
    case PMESH_NORMAL: return "normal";
    case PMESH_TEXCOORD: return "texcoord";
    case PMESH_COLOR: return "color";
    case PMESH_GENERIC: return "generic";
    }
    return "unknown";
}

const char *levels_base_name(pmesh_base_coder coder)
{
    return coder == PMESH_BASE_DRACO ? "draco" : "native";
}
