/* SPDX-License-Identifier: MIT */
#include "tools/pack.h"

#include <limits.h>
#include <stdlib.h>
#define ZLIB_CONST
#include <zlib.h>

enum { STEP = 65536 };

bool pack_zlib(const void *data, size_t size, asset_bytes *out)
{
    uLongf packed = compressBound((uLong)size);
    Bytef *room = malloc(packed);

    const bool good = room && compress2(room, &packed, data, (uLong)size,
                                        Z_BEST_COMPRESSION) == Z_OK;
    if (good)
        asset_put(out, room, packed);
    free(room);
    return good && !out->failed;
}

/* Grows by steps: a stream that lies about its size costs no memory. */
static bool unpack(z_stream *z, size_t limit, asset_bytes *out)
{
    static const Bytef nothing[1];
    Bytef room[STEP];
    size_t total = 0;
    int status = Z_OK;

    if (!z->next_in)
        z->next_in = nothing;
    while (status == Z_OK) {
        z->next_out = room;
        z->avail_out = sizeof room;
        status = inflate(z, Z_NO_FLUSH);
        const size_t got = sizeof room - z->avail_out;
        if ((status != Z_OK && status != Z_STREAM_END) || got > limit - total)
            return false;
        asset_put(out, room, got);
        total += got;
    }
    return z->avail_in == 0 && !out->failed;
}

bool unpack_zlib(const void *data, size_t size, size_t limit, asset_bytes *out)
{
    z_stream z = { .next_in = data };

    if (size > UINT_MAX || inflateInit(&z) != Z_OK)
        return false;
    z.avail_in = (uInt)size;
    const bool good = unpack(&z, limit, out);
    inflateEnd(&z);
    return good;
}
