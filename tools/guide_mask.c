/* SPDX-License-Identifier: MIT */
/* The one file that compiles stb_image, for PNG alone. */
#include "tools/guide_mask.h"

#include <limits.h>
#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wcast-qual"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wmissing-prototypes"
#pragma GCC diagnostic ignored "-Wundef"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wimplicit-fallthrough"
#endif
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_MAX_DIMENSIONS 16384
#include <stb/stb_image.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
/* Told at the end of the file. */
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#include "tools/file.h"

bool guide_mask_read(const char *path, guide_mask *out, asset_error *error)
{
    file_data data;
    int width = 0, height = 0, channels;

    *out = (guide_mask){ 0 };
    if (!file_read(path, INT_MAX, &data, error))
        return false;
    out->gray = stbi_load_from_memory(data.bytes, (int)data.size, &width,
                                      &height, &channels, 1);
    file_free(&data);
    if (!out->gray)
        return asset_fail(error, "", "unreadable as a PNG picture: %s",
                          stbi_failure_reason());
    out->width = (uint32_t)width;
    out->height = (uint32_t)height;
    return true;
}

void guide_mask_free(guide_mask *mask)
{
    stbi_image_free(mask->gray);
    *mask = (guide_mask){ 0 };
}

/* What is not finite counts as 0. */
static uint32_t pixel(float t, uint32_t size)
{
    const double whole = floor((double)t);
    const double part = (double)t - whole;
    const double at = part >= 0 && part < 1 ? part * size : 0;
    return at < size ? (uint32_t)at : size - 1;
}

float guide_mask_at(const guide_mask *mask, float u, float v)
{
    const size_t at =
        (size_t)pixel(v, mask->height) * mask->width + pixel(u, mask->width);
    return (float)mask->gray[at] / 255;
}
