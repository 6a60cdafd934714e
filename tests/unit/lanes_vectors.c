/* SPDX-License-Identifier: MIT */
#if defined(__SSE2__)
#define PMESH_LANES 1 /* elsewhere it is the usual way, or there is none */
#endif
#define WAY lanes_vectors
#include "tests/unit/lanes_way.h"
