/* cloud/linear.h: small dense linear algebra: vectors of three, symmetric 3x3 eigenvectors. Internal. */
#ifndef PLANTIMETER_CLOUD_LINEAR_H
#define PLANTIMETER_CLOUD_LINEAR_H

#include <math.h>

#define PLM_PI 3.14159265358979323846

static inline double plm_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void plm_cross(const double a[3], const double b[3], double out[3])
{
    const double x = a[1] * b[2] - a[2] * b[1];
    const double y = a[2] * b[0] - a[0] * b[2];
    const double z = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

static inline double plm_norm(const double a[3])
{
    return sqrt(plm_dot(a, a));
}

static inline double plm_distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/** Scales a to length 1; a zero vector stays as it is. Gives the length it had. */
static inline double plm_normalise(double a[3])
{
    const double length = plm_norm(a);
    if (length > 0)
        for (int i = 0; i < 3; i++) a[i] /= length;
    return length;
}

static inline double plm_degrees(double radians)
{
    return radians * (180.0 / PLM_PI);
}

static inline double plm_radians(double degrees)
{
    return degrees * (PLM_PI / 180.0);
}

/** Eigenvalues (largest first) and unit eigenvectors (vector[i] belongs to value[i], right-handed set) of a symmetric
 * matrix given as xx, xy, xz, yy, yz, zz. Cyclic Jacobi rotations: stable for equal and nearly equal eigenvalues, and
 * for matrices of any scale. NaN or Inf in gives NaN out. */
void plm_eigen3(const double matrix[6], double value[3], double vector[3][3]);

/** Two unit vectors that with axis (a unit vector) make a right-handed frame u, v, axis. */
void plm_frame_of_axis(const double axis[3], double u[3], double v[3]);

/** Solves the symmetric positive definite system of size n (row-major, overwritten by its Cholesky factor) in place:
 * right becomes the solution. Gives 0 when the matrix is not positive definite to working precision, else 1. */
int plm_solve_spd(int n, double *matrix, double *right);

#endif
