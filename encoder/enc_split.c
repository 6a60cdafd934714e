/* SPDX-License-Identifier: MIT */
#include "encoder/enc_split.h"

#include <string.h>

#include "format/crc32c.h"

typedef struct chunk {
    uint8_t type;
    const uint8_t *payload;
    uint32_t size;
    uint32_t crc; /* as stored */
    size_t end;   /* offset behind the checksum */
} chunk;

/* The chunk at `at`; NEED_DATA if the file ends within it. */
static pmesh_status read_chunk(const enc_split *s, size_t at, chunk *out)
{
    pmesh_cursor in = pmesh_cursor_make(s->data + at, s->size - at);

    out->type = pmesh_get_u8(&in);
    out->size = pmesh_get_count(&in, PMESH_MAX_CHUNK_SIZE);
    if (in.overrun || (size_t)(in.end - in.next) < out->size)
        return PMESH_NEED_DATA;
    out->payload = in.next;
    in.next += out->size;
    out->crc = pmesh_get_u32(&in);
    out->end = (size_t)(in.next - s->data);
    return in.overrun ? PMESH_NEED_DATA : PMESH_OK;
}

/* With the right checksum; `chain` is that of the last which goes on. */
static pmesh_status take_chunk(const enc_split *s, size_t at, uint32_t *chain,
                               chunk *out)
{
    const pmesh_status status = read_chunk(s, at, out);
    if (status != PMESH_OK)
        return status;
    const bool chained = pmesh_chunk_is_chained(out->type);
    const uint32_t crc = pmesh_crc32c(chained ? *chain : 0, s->data + at,
                                      out->end - PMESH_CRC_SIZE - at);
    if (chained)
        *chain = crc;
    return crc == out->crc ? PMESH_OK : PMESH_E_CHECKSUM;
}

static pmesh_status read_header(enc_split *s, uint32_t *chain, chunk *c)
{
    const char *rule;
    const pmesh_status status = take_chunk(s, PMESH_SIGNATURE_SIZE, chain, c);
    if (status != PMESH_OK)
        return status;
    if (c->type != PMESH_CHUNK_HEADER)
        return PMESH_E_CORRUPT;
    pmesh_cursor in = pmesh_cursor_make(c->payload, c->size);
    return pmesh_header_read(&in, &s->header, &rule);
}

pmesh_status enc_split_open(enc_split *s, const void *data, size_t size)
{
    chunk c = { 0 };
    uint32_t chain = 0;

    *s = (enc_split){ .data = data, .size = size };
    if (size < PMESH_SIGNATURE_SIZE ||
        memcmp(data, PMESH_SIGNATURE, PMESH_SIGNATURE_SIZE) != 0)
        return PMESH_E_MAGIC;
    pmesh_status status = read_header(s, &chain, &c);
    s->header_end = c.end;
    while (status == PMESH_OK && c.type != PMESH_CHUNK_END)
        status = take_chunk(s, c.end, &chain, &c);
    if (status == PMESH_OK)
        s->size = c.end; /* bytes behind the end mean nothing */
    return status;
}

bool enc_split_next(enc_split *s, size_t room, const uint8_t **data,
                    size_t *size)
{
    const uint32_t count = s->header.level_count;
    const uint64_t goal =
        s->level + (s->header.exact_size == 0) < count
            ? s->header_end + s->header.levels[s->level].bytes
            : s->size; /* the end chunk goes with the last level */
    size_t end = s->at == 0 ? (size_t)s->header_end : s->at;
    chunk c;

    *data = s->data + s->at;
    while (end < goal && read_chunk(s, end, &c) == PMESH_OK &&
           (end == s->at || c.end - s->at <= room ||
            c.type == PMESH_CHUNK_END))
        end = c.end;
    *size = end - s->at;
    s->at = end;
    while (s->level < count &&
           s->header_end + s->header.levels[s->level].bytes <= end)
        s->level++;
    return *size > 0;
}
