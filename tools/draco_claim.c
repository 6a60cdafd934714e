/* SPDX-License-Identifier: MIT */
/*
 * draco_claim.c - what a Draco stream says of its size, read before Draco is.
 *
 * Draco's decoder takes memory for the counts in its header, whatever the
 * stream holds: 61 bytes can ask for 3.4 GB.
 */
#include "tools/draco.h"

#include <string.h>

#define FLAG_METADATA 0x8000u
#define VERSION(major, minor) ((major) << 8 | (minor))

typedef struct reader {
    const uint8_t *next, *end;
    bool overrun; /* sticky */
} reader;

static uint64_t get(reader *in, unsigned bytes)
{
    uint64_t value = 0;
    if ((size_t)(in->end - in->next) < bytes) {
        in->overrun = true;
        in->next = in->end;
        return 0;
    }
    for (unsigned i = 0; i < bytes; i++)
        value |= (uint64_t)*in->next++ << (8 * i);
    return value;
}

static uint64_t get_varint(reader *in)
{
    uint64_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
        const uint64_t byte = get(in, 1);
        value |= (byte & 0x7F) << shift;
        if (!(byte & 0x80))
            return value;
    }
    in->overrun = true;
    return 0;
}

static void skip(reader *in, uint64_t bytes)
{
    if (bytes > (uint64_t)(in->end - in->next)) {
        in->overrun = true;
        in->next = in->end;
        return;
    }
    in->next += bytes;
}

/* One block and all blocks in it: they follow in pre-order, so a number of
 * outstanding ones is all the state there is. */
static void skip_block(reader *in)
{
    uint64_t outstanding = 1;

    for (bool first = true; outstanding > 0 && !in->overrun; first = false) {
        outstanding--;
        if (!first)
            skip(in, get(in, 1)); /* its name */
        for (uint64_t n = get_varint(in); n > 0 && !in->overrun; n--) {
            skip(in, get(in, 1));
            skip(in, get_varint(in));
        }
        outstanding += get_varint(in);
    }
}

static void skip_metadata(reader *in)
{
    for (uint64_t n = get_varint(in); n > 0 && !in->overrun; n--) {
        get_varint(in); /* attribute id */
        skip_block(in);
    }
    skip_block(in);
}

static uint64_t get_count(reader *in, bool varint)
{
    return varint ? get_varint(in) : get(in, 4);
}

bool draco_claim_read(const uint8_t *data, size_t size, draco_claim *out)
{
    reader in = { data, data + size, false };

    *out = (draco_claim){ 0 };
    if (size < 11 || memcmp(data, "DRACO", 5) != 0)
        return false;
    skip(&in, 5);
    const unsigned major = (unsigned)get(&in, 1);
    const unsigned version = VERSION(major, (unsigned)get(&in, 1));
    out->mesh = get(&in, 1) == 1;
    const bool edgebreaker = get(&in, 1) == 1;
    const unsigned flags = (unsigned)get(&in, 2);
    if (!out->mesh)
        return true;
    if (version >= VERSION(1, 3) && (flags & FLAG_METADATA))
        skip_metadata(&in);
    if (edgebreaker) {
        get(&in, 1); /* traversal */
        if (version < VERSION(2, 2))
            get_count(&in, version >= VERSION(2, 0));
        out->points = get_count(&in, version >= VERSION(2, 0));
        out->faces = get_count(&in, version >= VERSION(2, 0));
    } else {
        out->faces = get_count(&in, version >= VERSION(2, 2));
        out->points = get_count(&in, version >= VERSION(2, 2));
    }
    return !in.overrun;
}
