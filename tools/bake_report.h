/* SPDX-License-Identifier: MIT */
/*
 * bake_report.h - what pmesh bake tells about its work.
 */
#ifndef BAKE_REPORT_H
#define BAKE_REPORT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "encoder/pmesh_encode.h"
#include "tools/report.h"

typedef struct bake_report {
    const char *input, *output;
    uint64_t input_bytes;
    pmesh_profile profile;
    pmesh_placement placement;
    uint32_t meshes; /* of a scene, whose sums `encode` holds; 0: no scene */
    uint64_t bytes_document, bytes_resources; /* of a scene */
    pmesh_encode_report encode;
    double seconds_read, seconds_write, seconds_total;
    report_notes notes;
} bake_report;

/* Adds a note for everything of the input that the encoder left out or
 * repaired, with its count. */
void bake_report_note_losses(bake_report *r);

/* Two or three lines; `verbose` adds the parts and the level table. */
void bake_report_print(const bake_report *r, FILE *out, bool verbose);

void bake_report_json(const bake_report *r, FILE *out);

#endif
