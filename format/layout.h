/* SPDX-License-Identifier: MIT */
/*
 * layout.h - every constant of SPEC.md, in its order. A change here is a
 * change of the format.
 */
#ifndef PMESH_LAYOUT_H
#define PMESH_LAYOUT_H

#include <stdint.h>

#define PMESH_NONE UINT32_MAX

/* 5.1 Signature: the first byte is no text, CR LF and ^Z show damage by text
 * transfers, as in PNG. */
#define PMESH_SIGNATURE "\x89PMSH\r\n\x1a"
#define PMESH_SIGNATURE_SIZE 8

/* 5.2 Chunks: type u8, size varint, payload, crc u32. Types from 0x80 on may
 * be skipped by a decoder that does not know them. */
#define PMESH_CHUNK_HEADER 1
#define PMESH_CHUNK_BASE 2
#define PMESH_CHUNK_BLOCK 3      /* splits; more blocks of the level follow */
#define PMESH_CHUNK_BLOCK_LAST 4 /* splits; the level is complete after it */
#define PMESH_CHUNK_END 5
#define PMESH_CHUNK_NAMES 6
#define PMESH_CHUNK_POSITIONS 7  /* exact ones, behind the last level */
#define PMESH_CHUNK_SCENE 8 /* the header of a scene */
#define PMESH_CHUNK_PART 9  /* of a scene: bytes of one of its parts */
#define PMESH_CHUNK_SKIPPABLE 0x80
#define PMESH_CRC_SIZE 4

/* 5.3 Header: the bits of `modes`. */
#define PMESH_MODES_PROFILE 3u     /* mask */
#define PMESH_MODES_MOVES 4u       /* parents move */
#define PMESH_MODES_DRACO_BASE 8u  /* the base mesh is a Draco buffer */
#define PMESH_MODES_LOSSLESS 16u   /* exact positions at the end */
#define PMESH_MODES_JOINED 32u     /* vertices may have several fans */
#define PMESH_MODES_MEASURED 64u   /* levels tell their measured distances, */
#define PMESH_MODES_ALL 127u
#define PMESH_MEASURE_UNIT 16      /* in so many parts of a step */
#define PMESH_MAX_MEASURED (1u << 30)

#define PMESH_MAX_HEADER_SIZE 4096
#define PMESH_MAX_CHUNK_SIZE (1u << 28)
#define PMESH_MAX_NAMES_SIZE (1u << 20)
#define PMESH_MAX_FACES (1u << 28)
#define PMESH_MAX_WEDGES (1u << 30)
#define PMESH_MAX_MOVED (1u << 31)
#define PMESH_MAX_MATERIALS 65536
#define PMESH_MAX_FILE ((uint64_t)1 << 48)

/* 6.2 Blocks. An encoder keeps block chunks at or below 64 KiB. */
#define PMESH_BLOCK_CHUNK_SIZE 65536
#define PMESH_MAX_BLOCK_SPLITS 32768

/* 6.3 The ring of a vertex that splits, the ghost across a boundary included,
 * has at most this many members. */
#define PMESH_MAX_RING 48

/* Of joined files. A vertex has at most so many fans; one that splits has few
 * enough for all its rings together to keep the bound above (a closed ring of
 * two faces is the smallest), and gets at most so many lone faces. */
#define PMESH_MAX_FANS 48
#define PMESH_MAX_PARTS (PMESH_MAX_RING / 2)
#define PMESH_MAX_LONE 16

/* 6.6 A wedge that is used again lies this close in its vertex' ring. */
#define PMESH_MAX_PLACE 4096

/* 11 Scenes. The header grows with the number of parts. */
#define PMESH_SCENE_VERSION 0
#define PMESH_MAX_SCENE_HEADER (1u << 22)
#define PMESH_MAX_SCENE_PARTS 65536 /* meshes; and as many resources */

#endif
