/* SPDX-License-Identifier: MIT */
/* The one file that compiles stb_image_write. Its own zlib does not check its
 * allocations: ours does, and packs better. */
#include <limits.h>

#include "tools/pack.h"

static unsigned char *compress_rows(unsigned char *data, int size, int *packed,
                                    int quality)
{
    asset_bytes out = { 0 };
    (void)quality;
    if (!pack_zlib(data, (size_t)size, &out) || out.size > INT_MAX) {
        asset_bytes_free(&out);
        return NULL;
    }
    *packed = (int)out.size;
    return out.data;
}

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wcast-qual"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-prototypes"
#pragma GCC diagnostic ignored "-Wundef"
#pragma GCC diagnostic ignored "-Wpedantic"
#endif
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBIW_ZLIB_COMPRESS compress_rows
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include "tools/picture.h"

static void append(void *user, void *data, int size)
{
    asset_put(user, data, (size_t)size);
}

bool picture_to_png(const picture *p, asset_bytes *out)
{
    /* The writer counts bytes in int. */
    if (p->width > INT_MAX / 3 ||
        (uint64_t)p->width * p->height > INT_MAX / 8)
        return false;
    const int width = (int)p->width;
    return stbi_write_png_to_func(append, out, width, (int)p->height, 3, p->rgb,
                                  3 * width) != 0 &&
           !out->failed;
}
