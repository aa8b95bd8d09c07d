/* reports/picture_view.h: a measured plant drawn from one side: points as discs, leaf surfaces as shaded triangles. Internal to
 * reports/. */
#ifndef PLANTIMETER_REPORTS_PICTURE_VIEW_H
#define PLANTIMETER_REPORTS_PICTURE_VIEW_H

#include "reports/canvas.h"
#include "traits/traits.h"

/** A parallel projection onto a box of the canvas. */
typedef struct plm_view {
    double right[3], up[3];  /**< unit vectors of the plant's frame along the picture's axes */
    double centre[3];        /**< the point in the middle of the box, as offset from the cloud's origin */
    double scale;            /**< pixels a metre */
    int x, y, width, height; /**< the box */
} plm_view;

/** Where a point (offset from the cloud's origin) lies on the canvas. */
void plm_view_project(const plm_view *view, const double point[3], double *x, double *y);

/** How near a point is to the viewer, in metres from anywhere: more is nearer. */
double plm_view_nearness(const plm_view *view, const double point[3]);

/** Colours of organs: told apart by colour-blind people too (M. Okabe and K. Ito, Color Universal Design, 2008, and P. Tol,
 * Colour Schemes, 2021). */
plm_rgb plm_organ_colour(plm_label label, int32_t organ);

/** Draws the plant into the view's box. Deterministic. PLM_E_MEMORY. */
plm_status plm_view_draw(plm_canvas *canvas, const plm_view *view, const plm_measurement *measurement,
                         plm_error *error);

#endif
