/* SPDX-License-Identifier: MIT */
#define WAY lanes_usual
#include "tests/unit/lanes_way.h"
