/* simulate/view.h: one depth camera's view of a stage. Internal. */
#ifndef PLANTIMETER_SIMULATE_VIEW_H
#define PLANTIMETER_SIMULATE_VIEW_H

#include "simulate/scan.h"

/** A pinhole camera. Rows of rotation are its x (right), y (down) and z (forward) axes in the world. */
typedef struct plm_camera {
    double position[3], rotation[3][3];
    int width, height;          /* pixels */
    double focal[2], centre[2]; /* pixels */
} plm_camera;

/** A depth image: one entry a pixel, row after row. Pixels that the sensor lost have depth 0. */
typedef struct plm_view {
    plm_camera camera;  /* where it stood */
    plm_camera assumed; /* where the calibration says it stood */
    float *depth;       /* along the optical axis, m, with noise; 0: nothing */
    uint32_t *face;     /* that the pixel's ray met; PLM_NO_FACE: none */
    uint8_t *is_ghost;  /* depth lies between foreground and background */
    size_t pixels, ghosts;
} plm_view;

/** Takes view number `number` of options->views. The view is the caller's (plm_view_free). */
plm_status plm_view_take(const plm_stage_set *stage, const plm_scan_options *options, int number, plm_view *view,
                         plm_error *error);
void plm_view_free(plm_view *view);

/** Writes folder/view_NN.depth.png (16 bits, units of 0.1 mm along the optical axis, 0: nothing), .colour.png, .mask.png (255: plant)
 * and .json (intrinsics, calibrated and true pose) of view number `number`. The folder is made where it is missing. */
plm_status plm_view_write(const plm_stage_set *stage, const plm_scan_options *options, int number, const plm_view *view,
                          plm_error *error);

/** The world point of a pixel at a depth. */
void plm_camera_unproject(const plm_camera *camera, double column, double row, double depth, double point[3]);

#endif
