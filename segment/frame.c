/* segment/frame.c: zenith. Ground speaks first, then how the plant stands; where neither is clear, z, as files are nearly
 * always z-up. */
#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "segment/frame.h"
#include "segment/ground_scene.h"
#include "segment/segment.h"

enum { Z_AXIS = 2, DIRECTIONS = 400 };

static const double fine = 200, coarse = 100; /* voxels along the diagonal, for z and for the other directions */
static const double sure_ground = 0.9;  /* confidence that ends the search along z, and that no plant contradicts */
static const double clear_ground = 0.6; /* confidence that overrules z, if it is also by a margin above that of z */
static const double margin = 0.1;
static const double snap = 25; /* degrees: ground tilted by more is no tilted table but another frame */
/* Log-odds of an axis, by its signs (in their order); learnt from virtual plants by bench/accuracy/train_posture.py. */
static const double weight[PLM_POSTURE_SIGNS] = {-18.4, 7.4, 5.7, 5.2, -4.9};
/* Log-odds that the signs must speak for another axis with, as nearly all files are z-up: of 400 virtual and 40 real plants
 * that stand along z none is turned. */
static const double head_start = 3;
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

/* Confidence that ground lies below a plant that stands along up, whether it is that of a pot, and the ground's own normal. */
static plm_status ground_along(const plm_surfels *surfels, const double up[3], double *confidence, bool *has_pot,
                               double direction[3], plm_error *error)
{
    plm_ground_scene scene;
    const plm_status status = plm_ground_look(surfels, up, &scene, error);
    if (status != PLM_OK) return status;
    *confidence = scene.confidence;
    *has_pot = scene.has_pot;
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
static plm_status try_ground(const plm_surfels *surfels, const double up[3], double *best, bool *has_pot,
                             plm_frame *frame, plm_error *error)
{
    double direction[3], confidence, degrees;
    bool is_pot;
    const plm_status status = ground_along(surfels, up, &confidence, &is_pot, direction, error);
    if (status != PLM_OK || confidence < clear_ground || confidence <= *best) return status;
    *best = confidence;
    *has_pot = is_pot;
    const int axis = nearest_axis(direction, &degrees);
    if (degrees <= snap)
        frame_of_axis(axis, confidence, "ground", frame);
    else
        frame_of_direction(direction, confidence, "ground", frame);
    return PLM_OK;
}

/* Ground along z, then along the other axes, then along the commonest normal. The frame is left alone where there is none. */
static plm_status by_ground(const plm_cloud *cloud, bool *has_pot, plm_frame *frame, plm_error *error)
{
    plm_surfels surfels = {0};
    double up[3], direction[3], along_z = 0, best;
    plm_axis_direction(Z_AXIS, up);
    plm_status status = plm_surfels_make(cloud, fine, &surfels, error);
    if (status == PLM_OK) status = ground_along(&surfels, up, &along_z, has_pot, direction, error);
    plm_surfels_free(&surfels);
    if (status != PLM_OK) return status;
    if (along_z > 0) frame_of_axis(Z_AXIS, along_z, "ground", frame);
    best = along_z > 0 ? along_z + margin : 0;
    if (along_z < sure_ground) status = plm_surfels_make(cloud, coarse, &surfels, error);
    for (int axis = 0; axis < PLM_AXES && status == PLM_OK && along_z < sure_ground; axis++) {
        plm_axis_direction(axis, up);
        if (axis != Z_AXIS) status = try_ground(&surfels, up, &best, has_pot, frame, error);
    }
    if (status == PLM_OK && best == 0) {
        commonest_normal(&surfels, up);
        for (int way = 0; way < 2 && status == PLM_OK; way++) {
            for (int i = 0; i < 3 && way; i++) up[i] = -up[i];
            status = try_ground(&surfels, up, &best, has_pot, frame, error);
        }
    }
    plm_surfels_free(&surfels);
    return status;
}

/* ---- Posture -------------------------------------------------------------------------------------------------- */

static double score(const double sign[PLM_POSTURE_SIGNS])
{
    double sum = 0;
    for (int k = 0; k < PLM_POSTURE_SIGNS; k++) sum += weight[k] * sign[k];
    return sum;
}

/* The axis with the best score, where z and the one that ground speaks for (-1: none) have a head start. The confidence is
 * what the signs alone give the axis; where they leave more to the other axes together, they tell nothing. */
static void by_posture(const plm_posture *p, int ground, plm_frame *frame)
{
    double value[PLM_AXES], best_value = -INFINITY, largest = -INFINITY, total = 0;
    int best = Z_AXIS;
    for (int a = 0; a < PLM_AXES; a++) {
        value[a] = score(p->sign[a]);
        largest = fmax(largest, value[a]);
        const double raised = value[a] + (a == Z_AXIS || a == ground ? head_start : 0);
        if (raised > best_value) best_value = raised, best = a;
    }
    for (int a = 0; a < PLM_AXES; a++) total += exp(value[a] - largest);
    const double confidence = exp(value[best] - largest) / total;
    if (p->is_known && (confidence > 0.5 || (best != Z_AXIS && best != ground)))
        frame_of_axis(best, confidence, "posture", frame);
    else
        frame_of_axis(best, fmin(confidence, default_confidence), "default", frame);
}

/* ---- All together --------------------------------------------------------------------------------------------- */

/* A rough level along another axis than z may be a canopy seen upside down: the plant must not contradict it. Pots and smooth
 * levels are sure, and with them the signs of the plant are worth little. */
static plm_status find_automatically(const plm_cloud *cloud, plm_frame *frame, plm_error *error)
{
    plm_posture posture;
    plm_frame draft = {0}, stand;
    bool has_pot = false;
    plm_status status = by_ground(cloud, &has_pot, &draft, error);
    if (status != PLM_OK) return status;
    const bool found = draft.confidence > 0;
    const bool along_other_axis = draft.up != PLM_UP_Z && draft.up != PLM_UP_AUTO;
    if (!found || (along_other_axis && !has_pot && draft.confidence < sure_ground)) {
        status = plm_find_posture(cloud, &posture, error);
        if (status != PLM_OK) return status;
        by_posture(&posture, found ? (int)draft.up - PLM_UP_X : -1, &stand);
        if (!found || (posture.is_known && stand.up != draft.up)) draft = stand;
    }
    *frame = draft;
    return PLM_OK;
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
