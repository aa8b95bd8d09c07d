/* segment/frame.c: zenith. Ground speaks first, then the direction of stems; where both are silent, z, as files are
 * nearly always z-up. What the stem says must be clear to overrule that. */
#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "segment/frame.h"
#include "segment/ground_scene.h"
#include "segment/segment.h"

enum { Z_AXIS = 2, DIRECTIONS = 400 };

static const double fine = 200, coarse = 100; /* voxels along the diagonal, for z and for the other directions */
static const double sure_ground = 0.9;        /* confidence along z that ends the search */
static const double clear_ground = 0.6; /* confidence that overrules z, if it is also by a margin above that of z */
static const double margin = 0.1;
static const double snap = 25;         /* degrees: ground tilted by more is no tilted table but another frame */
static const double clear_stem = 0.58; /* share of the tubes along another axis than z that overrules z ... */
static const double clearer = 2.5;     /* ... if it is this many times the share along z, and the low end is ... */
static const double clear_foot = 0.1; /* ... bare over this share of the height: all plants with stems seen have 0.12 or
                                          more, rosettes, whose petioles happen to run along an axis, 0.06 or less */
static const double upside_down = 0.2; /* what must speak for -z against z */
static const double default_confidence = 0.3;

static void frame_of_axis(int axis, double confidence, const char *evidence, plm_frame *frame)
{
    *frame = (plm_frame){.up = (plm_up)(PLM_UP_X + axis), .confidence = confidence, .evidence = evidence};
    const double sign = axis < 3 ? 1 : -1; /* cyclic, so proper; turned over about x for the negative axes */
    frame->rotation[0][(axis + 1) % 3] = 1;
    frame->rotation[1][(axis + 2) % 3] = sign;
    frame->rotation[2][axis % 3] = sign;
}

static void frame_of_direction(const double up[3], double confidence, const char *evidence, plm_frame *frame)
{
    *frame = (plm_frame){.up = PLM_UP_AUTO, .confidence = confidence, .evidence = evidence};
    memcpy(frame->rotation[2], up, sizeof frame->rotation[2]);
    plm_frame_of_axis(up, frame->rotation[0], frame->rotation[1]);
}

/* ---- Ground --------------------------------------------------------------------------------------------------- */

/* Confidence that ground lies below a plant that stands along up; direction: out, the ground's own normal. */
static plm_status ground_along(const plm_surfels *surfels, const double up[3], double *confidence, double direction[3],
                               plm_error *error)
{
    plm_ground_scene scene;
    const plm_status status = plm_ground_look(surfels, up, &scene, error);
    if (status != PLM_OK) return status;
    *confidence = scene.confidence;
    memcpy(direction, scene.stand.rotation[2], 3 * sizeof *direction);
    plm_ground_scene_free(&scene);
    return PLM_OK;
}

/* The direction that most normals of the patches keep to within some 12 degrees, either way. */
static void commonest_normal(const plm_surfels *s, double direction[3])
{
    double best = -1;
    for (int d = 0; d < DIRECTIONS; d++) { /* a spiral over the half sphere */
        const double z = (d + 0.5) / DIRECTIONS, r = sqrt(1 - z * z), a = d * PLM_PI * (3 - sqrt(5));
        const double to[3] = {r * cos(a), r * sin(a), z};
        double n = 0, sum[3] = {0};
        for (size_t k = 0; k < s->count; k++) {
            const double normal[3] = {s->normal[k][0], s->normal[k][1], s->normal[k][2]}, c = plm_dot(normal, to);
            if (fabs(c) < 0.978) continue;
            n++;
            for (int i = 0; i < 3; i++) sum[i] += c < 0 ? -normal[i] : normal[i];
        }
        if (n > best) {
            best = n;
            memcpy(direction, n > 0 ? sum : to, 3 * sizeof *direction);
        }
    }
    plm_normalise(direction);
}

static int nearest_axis(const double direction[3], double *degrees)
{
    int best = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(direction[i]) > fabs(direction[best])) best = i;
    *degrees = plm_degrees(acos(fmin(fabs(direction[best]), 1)));
    return direction[best] > 0 ? best : best + 3;
}

/* What is found along one direction; better than best by a margin, it becomes best and frame. */
static plm_status try_ground(const plm_surfels *surfels, const double up[3], double *best, plm_frame *frame,
                             plm_error *error)
{
    double direction[3], confidence, degrees;
    const plm_status status = ground_along(surfels, up, &confidence, direction, error);
    if (status != PLM_OK || confidence < clear_ground || confidence <= *best) return status;
    *best = confidence;
    const int axis = nearest_axis(direction, &degrees);
    if (degrees <= snap)
        frame_of_axis(axis, confidence, "ground", frame);
    else
        frame_of_direction(direction, confidence, "ground", frame);
    return PLM_OK;
}

/* Ground along z, then along the other axes, then along the commonest normal. confidence is 0 where there is none. */
static plm_status by_ground(const plm_cloud *cloud, double *confidence, plm_frame *frame, plm_error *error)
{
    plm_surfels surfels = {0};
    double up[3], direction[3], along_z = 0, best;
    plm_axis_direction(Z_AXIS, up);
    plm_status status = plm_surfels_make(cloud, fine, &surfels, error);
    if (status == PLM_OK) status = ground_along(&surfels, up, &along_z, direction, error);
    plm_surfels_free(&surfels);
    if (status != PLM_OK) return status;
    if (along_z > 0) frame_of_axis(Z_AXIS, along_z, "ground", frame);
    best = along_z > 0 ? along_z + margin : 0;
    if (along_z < sure_ground) status = plm_surfels_make(cloud, coarse, &surfels, error);
    for (int axis = 0; axis < PLM_AXES && status == PLM_OK && along_z < sure_ground; axis++) {
        plm_axis_direction(axis, up);
        if (axis != Z_AXIS) status = try_ground(&surfels, up, &best, frame, error);
    }
    if (status == PLM_OK && best == 0) {
        commonest_normal(&surfels, up);
        for (int way = 0; way < 2 && status == PLM_OK; way++) {
            for (int i = 0; i < 3 && way; i++) up[i] = -up[i];
            status = try_ground(&surfels, up, &best, frame, error);
        }
    }
    plm_surfels_free(&surfels);
    *confidence = best;
    return status;
}

/* ---- Stem ----------------------------------------------------------------------------------------------------- */

/* What speaks for an axis against its opposite: leaves over stems, a bare foot below. */
static double sign_evidence(const plm_posture *p, int axis)
{
    const int opposite = (axis + 3) % PLM_AXES;
    return p->leafward[axis] + 0.5 * (p->foot[axis] - p->foot[opposite]);
}

static void by_posture(const plm_posture *p, plm_frame *frame)
{
    int best = Z_AXIS;
    for (int a = 0; a < 3; a++)
        if (p->along[a] > p->along[best]) best = a;
    const double share = p->along[best];
    const int side = sign_evidence(p, best) >= 0 ? best : best + 3;
    if (best != Z_AXIS && share >= clear_stem && share >= clearer * p->along[Z_AXIS] && p->foot[side] >= clear_foot) {
        frame_of_axis(side, 0.8 * share * fmin(1, 0.6 + 2 * fabs(sign_evidence(p, best))), "tubes", frame);
    } else if (best == Z_AXIS && share >= clear_stem) {
        const double evidence = sign_evidence(p, Z_AXIS);
        const int axis = evidence < -upside_down ? Z_AXIS + 3 : Z_AXIS;
        frame_of_axis(axis, share * fmin(1, 0.8 + 2 * fabs(evidence)), "tubes", frame);
    } else {
        frame_of_axis(Z_AXIS, default_confidence, "default", frame);
    }
}

/* ---- All together --------------------------------------------------------------------------------------------- */

static plm_status find_automatically(const plm_cloud *cloud, plm_frame *frame, plm_error *error)
{
    plm_posture posture;
    plm_frame draft;
    double confidence;
    plm_status status = by_ground(cloud, &confidence, &draft, error);
    if (status == PLM_OK && confidence == 0) {
        status = plm_find_posture(cloud, &posture, error);
        if (status == PLM_OK) by_posture(&posture, &draft);
    }
    if (status == PLM_OK) *frame = draft;
    return status;
}

plm_status plm_find_up(const plm_cloud *cloud, plm_up up, plm_frame *frame, plm_error *error)
{
    if (cloud->count == 0) return plm_fail(error, PLM_E_DEGENERATE, "a cloud without points has no zenith");
    if (up == PLM_UP_AUTO) return find_automatically(cloud, frame, error);
    if (up < PLM_UP_X || up > PLM_UP_MINUS_Z)
        return plm_fail(error, PLM_E_ARGUMENT, "up is %d; %d to %d name the axes", (int)up, (int)PLM_UP_X,
                        (int)PLM_UP_MINUS_Z);
    frame_of_axis((int)up - PLM_UP_X, 1, "given", frame);
    return PLM_OK;
}

static void turn(const double rotation[3][3], const double in[3], double out[3])
{
    for (int i = 0; i < 3; i++) out[i] = plm_dot(rotation[i], in);
}

void plm_frame_apply(const plm_frame *frame, plm_cloud *cloud)
{
    double out[3];
    turn(frame->rotation, cloud->origin, out);
    memcpy(cloud->origin, out, sizeof cloud->origin);
#pragma omp parallel for schedule(static) private(out)
    for (size_t i = 0; i < cloud->count; i++) {
        const double place[3] = {cloud->xyz[i][0], cloud->xyz[i][1], cloud->xyz[i][2]};
        turn(frame->rotation, place, out);
        for (int a = 0; a < 3; a++) cloud->xyz[i][a] = (float)out[a];
        if (!cloud->normal) continue;
        const double normal[3] = {cloud->normal[i][0], cloud->normal[i][1], cloud->normal[i][2]};
        turn(frame->rotation, normal, out);
        for (int a = 0; a < 3; a++) cloud->normal[i][a] = (float)out[a];
    }
}
