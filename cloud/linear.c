/* cloud/linear.c: symmetric 3x3 eigenvectors by cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations,
 * section 8.5). The closed cubic form is faster but loses half of the digits where eigenvalues are nearly equal (round
 * stems, square leaves), which is the common case here. */
#include "cloud/linear.h"

enum { MAXIMUM_SWEEPS = 32 }; /* quadratic convergence: 6 to 8 sweeps are the rule */

static void rotate(double a[3][3], double v[3][3], int p, int q)
{
    /* Small beside both diagonals: the eigenvalues keep their relative accuracy without this turn (J. Demmel and
     * K. Veselic, SIAM J. Matrix Anal. Appl. 13, 1992). */
    if (a[p][q] * a[p][q] <= 1e-34 * fabs(a[p][p] * a[q][q])) {
        a[p][q] = a[q][p] = 0.0;
        return;
    }
    const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    const double root = fabs(theta) < 1e8 ? sqrt(theta * theta + 1.0) : fabs(theta);
    const double t = (theta >= 0 ? 1.0 : -1.0) / (fabs(theta) + root);
    const double c = 1.0 / sqrt(t * t + 1.0);
    const double s = t * c;
    const int r = 3 - p - q;
    const double apq = a[p][q], arp = a[r][p], arq = a[r][q];
    a[p][p] -= t * apq;
    a[q][q] += t * apq;
    a[p][q] = a[q][p] = 0.0;
    a[r][p] = a[p][r] = c * arp - s * arq;
    a[r][q] = a[q][r] = s * arp + c * arq;
    for (int i = 0; i < 3; i++) {
        const double vp = v[i][p], vq = v[i][q];
        v[i][p] = c * vp - s * vq;
        v[i][q] = s * vp + c * vq;
    }
}

void plm_eigen3(const double matrix[6], double value[3], double vector[3][3])
{
    double scale = 0;
    for (int i = 0; i < 6; i++) scale = fmax(scale, fabs(matrix[i]));
    if (!(scale > 0) || !isfinite(scale)) scale = 1.0;
    double a[3][3] = {{matrix[0] / scale, matrix[1] / scale, matrix[2] / scale},
                      {matrix[1] / scale, matrix[3] / scale, matrix[4] / scale},
                      {matrix[2] / scale, matrix[4] / scale, matrix[5] / scale}};
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int sweep = 0; sweep < MAXIMUM_SWEEPS; sweep++) {
        const double off = fabs(a[0][1]) + fabs(a[0][2]) + fabs(a[1][2]);
        if (!(off > 1e-300)) break;
        rotate(a, v, 0, 1);
        rotate(a, v, 0, 2);
        rotate(a, v, 1, 2);
    }
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 2; i++)
        for (int j = i + 1; j < 3; j++)
            if (a[order[j]][order[j]] > a[order[i]][order[i]]) {
                const int other = order[i];
                order[i] = order[j];
                order[j] = other;
            }
    for (int i = 0; i < 3; i++) {
        value[i] = a[order[i]][order[i]] * scale;
        for (int k = 0; k < 3; k++) vector[i][k] = v[k][order[i]];
    }
    plm_cross(vector[0], vector[1], vector[2]); /* right-handed, whatever the order of the columns was */
}

void plm_frame_of_axis(const double axis[3], double u[3], double v[3])
{
    int least = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(axis[i]) < fabs(axis[least])) least = i;
    double helper[3] = {0, 0, 0};
    helper[least] = 1.0;
    plm_cross(helper, axis, u);
    plm_normalise(u);
    plm_cross(axis, u, v);
}

int plm_solve_spd(int n, double *matrix, double *right)
{
    for (int j = 0; j < n; j++) {
        double diagonal = matrix[j * n + j];
        const double before = diagonal;
        for (int k = 0; k < j; k++) diagonal -= matrix[j * n + k] * matrix[j * n + k];
        if (!(diagonal > 1e-14 * fabs(before))) return 0;
        const double root = sqrt(diagonal);
        matrix[j * n + j] = root;
        for (int i = j + 1; i < n; i++) {
            double sum = matrix[i * n + j];
            for (int k = 0; k < j; k++) sum -= matrix[i * n + k] * matrix[j * n + k];
            matrix[i * n + j] = sum / root;
        }
    }
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++) right[i] -= matrix[i * n + k] * right[k];
        right[i] /= matrix[i * n + i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) right[i] -= matrix[k * n + i] * right[k];
        right[i] /= matrix[i * n + i];
    }
    return 1;
}
