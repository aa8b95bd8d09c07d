/* traits/tube_fit.h: robust fit of a tube (curved axis, linear radius, flared or not) to points of its surface. Internal. */
#ifndef PLANTIMETER_TRAITS_TUBE_FIT_H
#define PLANTIMETER_TRAITS_TUBE_FIT_H

#include "cloud/cloud.h"
#include "cloud/trust_region.h"
#include "traits/axis_curve.h"
#include "traits/traits.h"

enum { PLM_TUBE_PARAMETERS = 2 * PLM_CURVE_BASIS + 4, PLM_TUBE_SECTORS = 24 };

/** What the radius may do along the axis. */
typedef enum plm_tube_form {
    PLM_TUBE_EVEN = 0,
    PLM_TUBE_TAPERED, /**< linear */
    PLM_TUBE_FLARED   /**< linear, and wider towards t = -1: the foot of a petiole */
} plm_tube_form;

/** A fitted tube. Parameters are, in this order, the coefficients of u, those of v, and the form's of the radius: its value
 * at t = 0 without the flare, its slope, the flare and the logarithm of the flare's length. */
typedef struct plm_tube {
    plm_curve axis;
    plm_tube_form form;
    double radius[2]; /**< radius at parameter t: radius[0] + radius[1] t + flare exp(-(t + 1) / flare_length),
                          the exponent at most 1 */
    double flare, flare_length; /**< 0 and 1 where it is not flared */
    double robust_sd;           /**< robust SD of the residuals, all points */
    double spread;              /**< SD of the inlying residuals (within 3 robust SD) */
    size_t inlier_count;
    double coverage; /**< share of the directions around the axis in which inlying points lie */
    double
        condition; /**< of the normal matrix with unit diagonal (1-norm): large where short arcs leave radius and axis
                           undetermined */
    int iteration_count;
    bool converged;
    plm_fit_end end; /**< of the last round */
    int parameter_count;
    double covariance[PLM_TUBE_PARAMETERS][PLM_TUBE_PARAMETERS]; /**< of the parameters, from inlying residuals */
} plm_tube;

/** Fits a tube to count points. start gives the chord, the degree and spans of the axis, and its first shape.
 *
 * Residual: distance to the axis, at right angles to its local tangent, minus the radius there. Minimised: the sum of
 * soft-L1 losses 2 f^2 (sqrt(1 + (residual / f)^2) - 1) with f = 1.5 robust SD, found again in five rounds, by
 * the scaled trust region of cloud/trust_region.h with analytic derivatives; from two starts (the given axis, and an algebraic circle about it), of which the better is kept.
 * PLM_E_DEGENERATE  fewer points than twice the parameters, or points that determine no tube. */
plm_status plm_tube_fit(const double (*xyz)[3], size_t count, const plm_curve *start, plm_tube_form form,
                        plm_tube *tube, plm_error *error);

/** What an estimate tells of the fit. */
plm_fit_note plm_tube_note(const plm_tube *tube);

/** Radius at t, and its standard error by the covariance. */
double plm_tube_radius(const plm_tube *tube, double t, double *std_error);

/** Standard error of the direction of the axis' chord from parameter a to parameter b, radians: the mean over the two
 * directions across it. */
double plm_tube_direction_error(const plm_tube *tube, double a, double b);

#endif
