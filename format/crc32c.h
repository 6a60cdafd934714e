/* SPDX-License-Identifier: MIT */
/*
 * crc32c.h - CRC-32C (Castagnoli), as in iSCSI: polynomial 0x1EDC6F41,
 * reflected, initial and final value all ones. Detects every burst of up to 32
 * bits, so every single-bit flip.
 */
#ifndef PMESH_CRC32C_H
#define PMESH_CRC32C_H

#include <stddef.h>
#include <stdint.h>

/* The CRC of `size` more bytes after those that gave `crc`; start with 0. */
uint32_t pmesh_crc32c(uint32_t crc, const void *data, size_t size);

#endif
