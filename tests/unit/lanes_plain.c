/* SPDX-License-Identifier: MIT */
#define PMESH_LANES 0
#define WAY         lanes_plain
#include "tests/unit/lanes_way.h"
