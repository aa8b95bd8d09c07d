/* reports/plant_files.h: what is written of one plant beside the tables, in the input's own coordinates, so that it lies
 * on the input when both are opened. Internal to reports/ and tool/. */
#ifndef PLANTIMETER_REPORTS_PLANT_FILES_H
#define PLANTIMETER_REPORTS_PLANT_FILES_H

#include "reports/reports.h"

/** How the measured cloud came from the input. */
typedef struct plm_input_frame {
    const float (
        *xyz)[3]; /**< the input's coordinates, as many as the measured cloud has points, offsets from origin */
    double origin[3];
    double metres_per_unit;
    const plm_georeference *georeference; /**< NULL: none */
} plm_input_frame;

/** Writes the cloud with its labels and organ numbers: every point that was read, in the order of the input. The
 * measurement must hold labels. */
plm_status plm_write_labelled_cloud(const char *path, const plm_measurement *measurement, const plm_input_frame *frame,
                                    plm_error *error);

/** Writes the leaf surfaces; face_organ is the leaf's number. */
plm_status plm_write_leaf_meshes(const char *path, const plm_measurement *measurement, const plm_input_frame *frame,
                                 plm_error *error);

#endif
