/* simulate/curve.h: space curves with a frame: the axes of tubes and the midribs of blades. Internal. */
#ifndef PLANTIMETER_SIMULATE_CURVE_H
#define PLANTIMETER_SIMULATE_CURVE_H

#include <math.h>

enum { PLM_CURVE_STEPS = 96 };

/** Orthonormal frame along a curve: tangent, side (left of the tangent seen along the normal) and normal (the upper
 * side of a blade). side = normal x tangent. */
typedef struct plm_frame_at {
    double tangent[3], side[3], normal[3];
} plm_frame_at;

/** A curve sampled at equal steps of arc length. */
typedef struct plm_curve {
    double length;
    double point[PLM_CURVE_STEPS + 1][3];
    plm_frame_at frame[PLM_CURVE_STEPS + 1];
} plm_curve;

/** How a curve bends over its length, radians. At the share t of the length the curve has turned by pitch * t^power
 * towards -normal (drooping), by yaw * t^power towards side, has rolled by roll * t, and wanders sinusoidally. */
typedef struct plm_bend {
    double pitch, pitch_power;
    double yaw, yaw_power;
    double roll;
    double wander[2];    /* amplitude of direction, pitch and yaw */
    double wander_count; /* periods over the length */
    double wander_phase[2];
} plm_bend;

/** Frame of a direction that leaves the zenith by `zenith` towards azimuth, its normal upwards (towards the axis for an
 * upright direction). Defined for all angles. */
plm_frame_at plm_frame_of_direction(double zenith, double azimuth);

/** Turns a frame: pitch about its side (positive: tangent towards -normal), yaw about its normal (towards side), roll
 * about its tangent. */
void plm_frame_pitch(plm_frame_at *frame, double angle);
void plm_frame_yaw(plm_frame_at *frame, double angle);
void plm_frame_roll(plm_frame_at *frame, double angle);

/** Grows a curve from start. */
void plm_curve_grow(const double start[3], const plm_frame_at *frame, double length, const plm_bend *bend,
                    plm_curve *curve);

/** Point and frame (either may be NULL) at distance s along the curve; before 0 and beyond the length it goes on
 * straight. */
void plm_curve_at(const plm_curve *curve, double s, double point[3], plm_frame_at *frame);

#endif
