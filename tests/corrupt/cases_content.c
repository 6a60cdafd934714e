/* SPDX-License-Identifier: MIT */
#include "tests/corrupt/corrupt.h"
void content_cases(void) {}
