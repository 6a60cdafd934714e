/* SPDX-License-Identifier: MIT */
/*
 * cursor.h - little-endian fields and varints in a block of bytes, with a
 * sticky overrun on reading and a sticky overflow on writing: test once per
 * record.
 *
 * A varint holds 7 bits a byte, least significant first; the top bit says that
 * another byte follows. Non-canonical forms (a last byte of 0 after others)
 * and values of 2^63 and above are overruns.
 */
#ifndef PMESH_CURSOR_H
#define PMESH_CURSOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef struct pmesh_cursor {
    const uint8_t *next, *end;
    bool overrun; /* some read went past `end` and gave 0 */
} pmesh_cursor;

static inline pmesh_cursor pmesh_cursor_make(const uint8_t *data, size_t size)
{
    return (pmesh_cursor){ data, data + size, false };
}

static inline uint64_t pmesh_get(pmesh_cursor *in, unsigned bytes)
{
    if ((size_t)(in->end - in->next) < bytes) {
        in->overrun = true;
        in->next = in->end;
        return 0;
    }
    uint64_t value = 0;
    for (unsigned i = 0; i < bytes; i++)
        value |= (uint64_t)in->next[i] << (8 * i);
    in->next += bytes;
    return value;
}

static inline uint8_t pmesh_get_u8(pmesh_cursor *in)
{
    return (uint8_t)pmesh_get(in, 1);
}

static inline uint32_t pmesh_get_u32(pmesh_cursor *in)
{
    return (uint32_t)pmesh_get(in, 4);
}

static inline float pmesh_get_f32(pmesh_cursor *in)
{
    const uint32_t bits = pmesh_get_u32(in);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline double pmesh_get_f64(pmesh_cursor *in)
{
    const uint64_t bits = pmesh_get(in, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline uint64_t pmesh_get_varint(pmesh_cursor *in)
{
    uint64_t value = 0;
    for (unsigned shift = 0; shift < 63; shift += 7) {
        const uint8_t byte = pmesh_get_u8(in);
        value |= (uint64_t)(byte & 0x7f) << shift;
        if (byte < 0x80) {
            if (byte == 0 && shift > 0)
                break;
            return value;
        }
    }
    in->overrun = true;
    return 0;
}

/* A varint that must be at most `limit`; larger ones count as overrun. */
static inline uint32_t pmesh_get_count(pmesh_cursor *in, uint32_t limit)
{
    const uint64_t value = pmesh_get_varint(in);
    if (value <= limit)
        return (uint32_t)value;
    in->overrun = true;
    return 0;
}

typedef struct pmesh_writer {
    uint8_t *data;
    size_t size, capacity;
    bool overflow; /* some write did not fit and was dropped */
} pmesh_writer;

static inline void pmesh_put(pmesh_writer *out, uint64_t value, unsigned bytes)
{
    if (out->capacity - out->size < bytes) {
        out->overflow = true;
        return;
    }
    for (unsigned i = 0; i < bytes; i++)
        out->data[out->size++] = (uint8_t)(value >> (8 * i));
}

static inline void pmesh_put_f32(pmesh_writer *out, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    pmesh_put(out, bits, 4);
}

static inline void pmesh_put_f64(pmesh_writer *out, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    pmesh_put(out, bits, 8);
}

static inline void pmesh_put_varint(pmesh_writer *out, uint64_t value)
{
    for (; value >= 0x80; value >>= 7)
        pmesh_put(out, (value & 0x7f) | 0x80, 1);
    pmesh_put(out, value, 1);
}

#endif
