/* io/gaussian.h: what one gaussian of a 3DGS file is as a piece of surface. Internal to io/. */
#ifndef PLANTIMETER_IO_GAUSSIAN_H
#define PLANTIMETER_IO_GAUSSIAN_H

#include <stdbool.h>

/** A flat gaussian: its two long axes span the surface, its shortest is the surface's normal. */
typedef struct plm_gaussian {
    double opacity;    /* 0 to 1 */
    double axis[2][3]; /* unit vectors along the two long axes, longest first */
    double normal[3];
    double extent[2]; /* standard deviations along the axes */
} plm_gaussian;

/** From the numbers of the file: opacity as a logit, natural logarithms of the scales, rotation w x y z of any length
 * (B. Kerbl et al., 3D Gaussian Splatting for Real-Time Radiance Field Rendering, 2023, Eq. 6: the axes are the columns
 * of the rotation). False where they give no finite gaussian. */
bool plm_gaussian_decode(double logit, const double log_scale[3], const double rotation[4], plm_gaussian *gaussian);

/** A colour channel, 0 to 255, from the constant term of its spherical harmonics. */
double plm_gaussian_colour(double constant_term);

#endif
