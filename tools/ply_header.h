/* SPDX-License-Identifier: MIT */
/*
 * ply_header.h - what the header of a PLY file says about its data.
 */
#ifndef PLY_HEADER_H
#define PLY_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tools/asset.h"
#include "tools/text.h"

typedef enum ply_type {
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT,
    PLY_DOUBLE,
    PLY_NO_TYPE
} ply_type;

/* Where a value goes. */
typedef enum ply_slot {
    SLOT_X,
    SLOT_Y,
    SLOT_Z,
    SLOT_NX,
    SLOT_NY,
    SLOT_NZ,
    SLOT_U,
    SLOT_V,
    SLOT_RED,
    SLOT_GREEN,
    SLOT_BLUE,
    SLOT_ALPHA,
    SLOT_QUALITY,
    SLOT_COUNT,
    SLOT_CORNERS, /* the list of a face or strip */
    SLOT_NONE
} ply_slot;

typedef struct ply_property {
    ply_type type;
    ply_type count_type; /* PLY_NO_TYPE: a scalar */
    ply_slot slot;
} ply_property;

typedef enum ply_role {
    ROLE_VERTICES,
    ROLE_FACES,
    ROLE_STRIPS,
    ROLE_NONE
} ply_role;

typedef struct ply_element {
    ply_role role;
    uint64_t count;
    size_t first, property_count;
} ply_element;

typedef struct ply_header {
    bool ascii, big_endian;
    ply_element *elements;
    size_t element_count, element_capacity;
    ply_property *properties; /* of all elements, one behind the other */
    size_t property_count, property_capacity;
    uint64_t vertex_count; /* as announced */
} ply_header;

/* Bytes of a binary value. */
size_t ply_size_of(ply_type type);

/* Reads up to the first byte of the data. Counts are not checked. In any case
 * ply_header_free() is due. */
bool ply_header_read(ply_header *header, text_cursor *in, asset_error *error);
void ply_header_free(ply_header *header);

#endif
