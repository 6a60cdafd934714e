/* SPDX-License-Identifier: MIT */
/*
 * header.h - the header chunk, read and written in one place (SPEC 5.3).
 */
#ifndef PMESH_HEADER_H
#define PMESH_HEADER_H

#include "format/codec.h"
#include "format/cursor.h"
#include "format/ordinal.h"

/* Of a level, with byte offsets from the end of the header chunk. */
typedef struct pmesh_level_entry {
    uint64_t bytes;
    uint32_t faces, vertices, wedges;
    float error;
    uint8_t inflation; /* see inflate.h; 0 at the last */
    uint32_t rms, most; /* measured; 0 unless the header has them */
} pmesh_level_entry;

typedef struct pmesh_header_chunk {
    uint64_t content_hash;
    pmesh_profile profile;
    pmesh_base_coder base_coder;
    pmesh_grid grid;
    int32_t bounds[3];
    pmesh_codec_sizes sizes;
    uint32_t base_vertices, base_wedges;
    uint32_t chunk_size;    /* largest payload behind the header */
    uint32_t moved_corners; /* of all splits together: see dec_view.c */
    uint32_t names_size;    /* payload of the names chunk, 0: none */
    uint64_t exact_size;    /* bytes of the positions chunks, 0: none */
    pmesh_form exact_form[3];
    uint32_t attribute_count;
    pmesh_attribute attributes[PMESH_MAX_ATTRIBUTES];
    bool measured;
    uint32_t level_count;
    pmesh_level_entry levels[PMESH_MAX_LEVELS];
} pmesh_header_chunk;

void pmesh_header_write(pmesh_writer *out, const pmesh_header_chunk *h);

/* Reads and checks every rule of SPEC 5.3. Returns PMESH_OK, E_VERSION or
 * E_CORRUPT with *rule set. */
pmesh_status pmesh_header_read(pmesh_cursor *in, pmesh_header_chunk *h,
                               const char **rule);

/* Whether a chunk's checksum goes on from that of the chained one before it
 * (SPEC 5.2), as those of critical chunks behind the header do. One that is
 * missing, or stands in another's place, is noticed at once, not at the end. */
bool pmesh_chunk_is_chained(uint8_t type);

/* The content hash is FNV-1a, 64 bits, over the CRCs of the critical chunks
 * between header and end, in file order. */
#define PMESH_HASH_START 0xcbf29ce484222325u
uint64_t pmesh_hash_crc(uint64_t hash, uint32_t crc);

#endif
