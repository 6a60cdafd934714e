/* SPDX-License-Identifier: MIT */
/*
 * faces.h - is what comes out what went in?
 */
#ifndef FACES_H
#define FACES_H

#include <stdbool.h>

#include "decoder/pmesh_decode.h"
#include "encoder/pmesh_encode.h"

/* Refines the decoder to full detail and compares: the set of faces with the
 * grid points, coded attributes and orientation of their corners and their
 * material must equal that of the quantised input, less the faces with two
 * corners at one position; the numbers of faces must agree up to copies. */
bool faces_match(const pmesh_mesh_input *mesh, pmesh_decoder *dec);

#endif
