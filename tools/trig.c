/* SPDX-License-Identifier: MIT */
#include "tools/trig.h"

#include <math.h>

#define TURN 6.283185307179586

double trig_sin(double turns)
{
    double r = turns - floor(turns + 0.5); /* -0.5 .. 0.5 */
    if (r > 0.25)
        r = 0.5 - r;
    else if (r < -0.25)
        r = -0.5 - r;

    /* The power series: at pi/2 its first missing term is below 1e-15. */
    const double x = r * TURN;
    double term = x;
    double sum = x;
    for (int n = 2; n < 20; n += 2) {
        term *= -x * x / (n * (n + 1));
        sum += term;
    }
    return sum;
}

double trig_cos(double turns)
{
    return trig_sin(turns + 0.25);
}
