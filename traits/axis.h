/* traits/axis.h: the fitted centre lines of stems and petioles, from which their traits follow. Internal. */
#ifndef PLANTIMETER_TRAITS_AXIS_H
#define PLANTIMETER_TRAITS_AXIS_H

#include "traits/axis_curve.h"
#include "traits/scene.h"

/** The fitted line of a stem or petiole. Offsets from the scene's origin, metres, radians. */
typedef struct plm_axis {
    plm_curve line;
    double begin, end;      /**< parameters of the base and of the far end (stem: tip, petiole: junction) on the line */
    double base[3], tip[3]; /**< the points there */
    double length, length_error;          /**< along the line from base to tip */
    double direction[3], direction_error; /**< unit vector from base to tip; standard error of its angle to any axis */
    double radius,
        radius_error;        /**< stem: median over its length, good for scales; petiole: half way along it (compound
                                      leaves: half way to the first leaflet); 0 and INFINITY where no tube was found */
    double taper;            /**< change of the radius by the line's parameter; 0 where no tube was found */
    double noise;            /**< robust SD of the points off the tube; off the mean distance where no tube was found */
    size_t point_count;      /**< points that the line rests on */
    unsigned flags;          /**< PLM_FLAG_... */
    const char *method;      /**< "tube fit" or "centre line": static text */
    plm_fit_note fit;        /**< of the tube that radius and line are from, or were tried to be from */
    int32_t carrier;         /**< petiole: number of the stem it stands on; branch: of the stem it leaves; -1: none */
    double node, node_error; /**< length along the carrier from its base to here; NAN without carrier */
    double insertion, insertion_error; /**< angle of direction against the carrier's axis at the node; NAN without */
} plm_axis;

/** Fits the axes of all stems and then of all petioles of a scene: fills plm_organ.axis (freed by plm_axis_free) and,
 * where an axis is impossible, axis_reason. Needs the organs' points, nothing else. Parallel over organs; the same
 * digits for any number of threads. PLM_E_MEMORY leaves organs with or without axes. */
plm_status plm_scene_fit_axes(plm_scene *scene, plm_error *error);

/** Radius of the tube at a parameter of its line, without correction for noise; not below a quarter of the typical one. */
double plm_axis_radius(const plm_axis *axis, double t);

/** NULL is allowed. */
void plm_axis_free(plm_axis *axis);

/* ---- Parts of it, for the files that share the work ----------------------------------------------------------- */

/** Points of an organ as doubles, in no order; large organs give a sample that is chosen by coordinates, so that the
 * order of rows does not matter. */
typedef struct plm_tube_points {
    size_t count;
    double (*xyz)[3];
} plm_tube_points;

/** About wanted points of an organ, at most. The caller frees points->xyz with plm_free. */
plm_status plm_tube_points_gather(const plm_organ *organ, size_t wanted, plm_tube_points *points, plm_error *error);

/** Fits a stem's axis. PLM_E_DEGENERATE: the message says why there is none. */
plm_status plm_stem_axis_fit(const plm_scene *scene, const plm_organ *stem, plm_axis *axis, plm_error *error);

/** Fits a petiole's axis; the axes of stems are there. PLM_E_DEGENERATE: the message says why there is none. */
plm_status plm_petiole_axis_fit(const plm_scene *scene, const plm_organ *petiole, plm_axis *axis, plm_error *error);

#endif
