/* SPDX-License-Identifier: MIT */
#include "tests/corrupt/corrupt.h"
void scene_cases(void) {}
