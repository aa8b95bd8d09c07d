/* simulate/curve.c: curves by turning a frame step by step. Rotations are exact, so frames stay orthonormal; a half
 * turn before and after each step makes the position second order. */
#include "simulate/curve.h"

#include "cloud/linear.h"

/* a = a cos + b sin, b = b cos - a sin */
static void turn(double a[3], double b[3], double angle)
{
    const double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++) {
        const double old = a[i];
        a[i] = old * c + b[i] * s;
        b[i] = b[i] * c - old * s;
    }
}

void plm_frame_pitch(plm_frame_at *frame, double angle)
{
    turn(frame->tangent, frame->normal, -angle);
}

void plm_frame_yaw(plm_frame_at *frame, double angle)
{
    turn(frame->tangent, frame->side, angle);
}

void plm_frame_roll(plm_frame_at *frame, double angle)
{
    turn(frame->side, frame->normal, angle);
}

plm_frame_at plm_frame_of_direction(double zenith, double azimuth)
{
    const double out[3] = {cos(azimuth), sin(azimuth), 0};
    plm_frame_at frame;
    for (int i = 0; i < 3; i++) {
        frame.tangent[i] = sin(zenith) * out[i] + (i == 2 ? cos(zenith) : 0);
        frame.normal[i] = -cos(zenith) * out[i] + (i == 2 ? sin(zenith) : 0);
    }
    plm_cross(frame.normal, frame.tangent, frame.side);
    return frame;
}

/* Angles turned so far at the share t of the length. */
static void turned(const plm_bend *bend, double t, double angle[3])
{
    const double phase = 2 * PLM_PI * bend->wander_count * t;
    angle[0] = bend->pitch * pow(t, bend->pitch_power > 0 ? bend->pitch_power : 1) +
               bend->wander[0] * (sin(phase + bend->wander_phase[0]) - sin(bend->wander_phase[0]));
    angle[1] = bend->yaw * pow(t, bend->yaw_power > 0 ? bend->yaw_power : 1) +
               bend->wander[1] * (sin(phase + bend->wander_phase[1]) - sin(bend->wander_phase[1]));
    angle[2] = bend->roll * t;
}

static void turn_by(plm_frame_at *frame, const double from[3], const double to[3])
{
    plm_frame_pitch(frame, to[0] - from[0]);
    plm_frame_yaw(frame, to[1] - from[1]);
    plm_frame_roll(frame, to[2] - from[2]);
}

void plm_curve_grow(const double start[3], const plm_frame_at *frame, double length, const plm_bend *bend,
                    plm_curve *curve)
{
    const double step = length / PLM_CURVE_STEPS;
    plm_frame_at now = *frame;
    double before[3], middle[3];
    turned(bend, 0, before);
    curve->length = length;
    for (int k = 0; k <= PLM_CURVE_STEPS; k++) {
        curve->frame[k] = now;
        for (int i = 0; i < 3; i++) curve->point[k][i] = k ? curve->point[k][i] : start[i];
        if (k == PLM_CURVE_STEPS) break;
        turned(bend, (k + 0.5) / PLM_CURVE_STEPS, middle);
        turn_by(&now, before, middle);
        for (int i = 0; i < 3; i++) curve->point[k + 1][i] = curve->point[k][i] + step * now.tangent[i];
        turned(bend, (k + 1.0) / PLM_CURVE_STEPS, before);
        turn_by(&now, middle, before);
    }
}

static void orthonormalise(plm_frame_at *frame)
{
    plm_normalise(frame->tangent);
    plm_cross(frame->normal, frame->tangent, frame->side);
    plm_normalise(frame->side);
    plm_cross(frame->tangent, frame->side, frame->normal);
}

void plm_curve_at(const plm_curve *curve, double s, double point[3], plm_frame_at *frame)
{
    const double step = curve->length / PLM_CURVE_STEPS;
    const double inside = s < 0 ? 0 : s > curve->length ? curve->length : s;
    int k = step > 0 ? (int)(inside / step) : 0;
    if (k >= PLM_CURVE_STEPS) k = PLM_CURVE_STEPS - 1;
    const double t = step > 0 ? inside / step - k : 0;
    const plm_frame_at *a = &curve->frame[k], *b = &curve->frame[k + 1];
    /* cubic Hermite with the tangents as derivatives: the arc of a circle to fourth order */
    const double h0 = (1 + 2 * t) * (1 - t) * (1 - t), h1 = t * (1 - t) * (1 - t), h2 = t * t * (3 - 2 * t),
                 h3 = t * t * (t - 1);
    plm_frame_at here;
    for (int i = 0; i < 3; i++) {
        here.tangent[i] = a->tangent[i] * (1 - t) + b->tangent[i] * t;
        here.normal[i] = a->normal[i] * (1 - t) + b->normal[i] * t;
    }
    orthonormalise(&here);
    if (point)
        for (int i = 0; i < 3; i++)
            point[i] = h0 * curve->point[k][i] + h2 * curve->point[k + 1][i] +
                       step * (h1 * a->tangent[i] + h3 * b->tangent[i]) + (s - inside) * here.tangent[i];
    if (frame) *frame = here;
}
