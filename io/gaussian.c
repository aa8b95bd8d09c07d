/* io/gaussian.c: decoding gaussians. */
#include "io/gaussian.h"

#include <float.h>
#include <math.h>

/* Columns of the rotation matrix of a unit quaternion. */
static void rotation_axes(const double q[4], double axes[3][3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double columns[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
                                  {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
                                  {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) axes[i][j] = columns[i][j];
}

bool plm_gaussian_decode(double logit, const double log_scale[3], const double rotation[4], plm_gaussian *gaussian)
{
    double largest = 0, length = 0, unit[4];
    for (int i = 0; i < 4; i++) {
        if (!isfinite(rotation[i])) return false;
        largest = fmax(largest, fabs(rotation[i]));
    }
    if (largest == 0 || isnan(logit)) return false;
    for (int i = 0; i < 4; i++) length += rotation[i] / largest * (rotation[i] / largest);
    for (int i = 0; i < 4; i++) unit[i] = rotation[i] / largest / sqrt(length);

    int order[3] = {0, 1, 2}; /* longest first; equal ones keep their order */
    for (int i = 0; i < 3; i++)
        if (isnan(log_scale[i])) return false;
    for (int i = 1; i < 3; i++)
        for (int j = i; j > 0 && log_scale[order[j]] > log_scale[order[j - 1]]; j--) {
            const int swap = order[j];
            order[j] = order[j - 1];
            order[j - 1] = swap;
        }
    for (int i = 0; i < 2; i++) gaussian->extent[i] = exp(log_scale[order[i]]);
    if (!(gaussian->extent[0] <= FLT_MAX)) return false;

    double axes[3][3];
    rotation_axes(unit, axes);
    for (int j = 0; j < 3; j++) {
        gaussian->axis[0][j] = axes[order[0]][j];
        gaussian->axis[1][j] = axes[order[1]][j];
        gaussian->normal[j] = axes[order[2]][j];
    }
    gaussian->opacity = 1 / (1 + exp(-logit));
    return true;
}

double plm_gaussian_colour(double constant_term)
{
    const double zeroth_harmonic = 0.28209479177387814; /* 1 / (2 sqrt(pi)) */
    return 255 * (0.5 + zeroth_harmonic * constant_term);
}
