/* SPDX-License-Identifier: MIT */
/* enc_eigen.h - the axes of a symmetric matrix. */
#ifndef ENC_EIGEN_H
#define ENC_EIGEN_H

/* m: xx xy xz yy yz zz. The values descend; the axes are unit vectors at right
 * angles, right-handed. The same on every machine. */
void enc_eigen(const double m[6], double value[3], double axis[3][3]);

#endif
