/* cloud/local_plane.c: through the mean, across the direction in which the points spread least. */
#include "cloud/local_plane.h"

#include "cloud/linear.h"

#include <math.h>

double plm_local_plane_distance(const float (*xyz)[3], const uint32_t *row, size_t count, const float place[3],
                                double *scatter)
{
    double mean[3] = {0}, moment[6] = {0}, value[3], vector[3][3], d[3];
    for (size_t k = 0; k < count; k++)
        for (int a = 0; a < 3; a++) mean[a] += xyz[row[k]][a];
    for (int a = 0; a < 3; a++) mean[a] /= (double)count;
    for (size_t k = 0; k < count; k++) {
        for (int a = 0; a < 3; a++) d[a] = xyz[row[k]][a] - mean[a];
        for (int a = 0, m = 0; a < 3; a++)
            for (int b = a; b < 3; b++) moment[m++] += d[a] * d[b] / (double)count;
    }
    plm_eigen3(moment, value, vector);
    for (int a = 0; a < 3; a++) d[a] = place[a] - mean[a];
    if (scatter) *scatter = count > 3 ? sqrt(fmax(value[2], 0) * (double)count / (double)(count - 3)) : 0;
    return fabs(plm_dot(d, vector[2]));
}
