/* traits/line_blend.c: the mean of two lines by their covariances. Where one side of a tube is seen better than the other, or
 * by more points, its centroids lie off its axis, and by unlike amounts at its ends; a fitted tube knows the axis better where the
 * noise is well below its radius. Where it is not, the two come apart by more than their covariances allow (splats with a noise
 * of half of the radius: 4 times as much on the mean; fused depth images with 0.37 of it: 0.8 times). */
#include "traits/line_blend.h"

#include "cloud/linear.h"

#include <math.h>
#include <string.h>

static const double TUBE_VARIANCE = 1.5; /* times what the tube's fit tells: its residuals are not independent */
static const double ONE_SIDED = 0.15;    /* of the radius: centroids may be off the axis as a whole */
static const double MOST_UNLIKE = 1.5;   /* mean square of the differences over their variances */

bool plm_line_blend(plm_centre_line *line, const plm_tube *tube)
{
    const int n = plm_curve_basis_count(&line->curve);
    const double shift = ONE_SIDED * tube->radius[0], scatter = line->scatter;
    double moved[2][PLM_CURVE_BASIS] = {{0}}, unlike = 0;
    for (int c = 0; c < 2; c++) {
        double own[PLM_CURVE_BASIS * PLM_CURVE_BASIS], sum[PLM_CURVE_BASIS * PLM_CURVE_BASIS];
        double gap[PLM_CURVE_BASIS] = {0};
        for (int a = 0; a < n; a++) {
            gap[a] = tube->axis.offset[c][a] - line->curve.offset[c][a];
            for (int b = 0; b < n; b++) {
                /* coefficients of B-splines: the same in all is a shift */
                own[a * n + b] = scatter * scatter * line->covariance[a][b] + shift * shift;
                sum[a * n + b] = own[a * n + b] + TUBE_VARIANCE * tube->covariance[c * n + a][c * n + b];
            }
        }
        double weighed[PLM_CURVE_BASIS];
        memcpy(weighed, gap, sizeof weighed);
        if (!plm_solve_spd(n, sum, weighed)) return false;
        for (int a = 0; a < n; a++) {
            unlike += gap[a] * weighed[a] / (2 * n);
            for (int b = 0; b < n; b++) moved[c][a] += own[a * n + b] * weighed[b];
        }
    }
    if (!(unlike <= MOST_UNLIKE)) return false;
    for (int c = 0; c < 2; c++)
        for (int a = 0; a < n; a++) line->curve.offset[c][a] += moved[c][a];
    return true;
}
