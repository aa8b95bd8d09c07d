/* cloud/trust_region.h: nonlinear least squares by a scaled trust region, for fits of few parameters to many points, whose
 * parameters may differ by orders of magnitude and may be nearly undetermined. Internal. */
#ifndef PLANTIMETER_CLOUD_TRUST_REGION_H
#define PLANTIMETER_CLOUD_TRUST_REGION_H

enum { PLM_FIT_MOST_PARAMETERS = 36 };

/** Why a fit ended. */
typedef enum plm_fit_end {
    PLM_FIT_STEPS_SPENT = 0, /**< the most steps were taken: not converged */
    PLM_FIT_SMALL_STEP,      /**< the last step was below the tolerance in every parameter: converged */
    PLM_FIT_SMALL_GAIN, /**< what the model promised was below the rounding of the cost: converged as far as numbers go */
    PLM_FIT_NO_DESCENT /**< no step, however short, lowered the cost: stuck */
} plm_fit_end;

/** The name of an end in words, static text. */
const char *plm_fit_end_name(plm_fit_end end);

/** A cost to minimise: half of a sum of squares, or of robust losses of residuals. */
typedef struct plm_least_squares {
    int size; /**< parameters, at most PLM_FIT_MOST_PARAMETERS */
    void *context;
    /** Moves to x and gives the cost there; NAN or INFINITY where x is no model. */
    double (*move)(void *context, const double *x);
    /** The normal matrix J'WJ (size x size, symmetric) and the gradient J'Wr at x, to which the last accepted move led. */
    void (*normal)(void *context, const double *x, double *matrix, double *gradient);
    /** What a change of each parameter that is as large as the thing itself is (of a radius: the radius): scales the
     * tolerance and the first region. */
    const double *typical;
} plm_least_squares;

typedef struct plm_fit_report {
    double cost;
    int iteration_count; /**< steps tried */
    plm_fit_end end;
} plm_fit_report;

/** Minimises from x, in place. Steps of a Gauss-Newton model within an ellipsoid whose axes are the columns' norms, the
 * largest met so far (so units do not matter); the multiplier is found by Newton's method on 1 / |step| (J. J. More, The
 * Levenberg-Marquardt algorithm: implementation and theory, 1978). It ends with PLM_FIT_SMALL_STEP when an undamped or
 * accepted step is below tolerance times typical in every parameter. The context stands at x in the end. work: room for
 * 2 size^2 doubles. */
void plm_trust_region(const plm_least_squares *problem, double *x, double tolerance, int most_steps, double *work,
                      plm_fit_report *report);

/** Condition of a normal matrix (size x size, row-major) brought to unit diagonal, in the 1-norm, and its inverse, unscaled.
 * Of the Jacobian with columns of length 1 it is about the square of the condition. INFINITY where it is singular to
 * working precision; inverse then holds nothing of use. work: room for size^2 doubles. */
double plm_normal_condition(int size, const double *matrix, double *inverse, double *work);

#endif
