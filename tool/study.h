/* tool/study.h: what the parts of the `study` sub-command share. */
#ifndef PLANTIMETER_TOOL_STUDY_H
#define PLANTIMETER_TOOL_STUDY_H

#include "simulate/simulate.h"

enum { STUDY_PLANTS = 4, STUDY_STEPS_MOST = 100, STUDY_PATH = 4096 };

/** A plant of the laser-scanning paper: its name there, our kind, the resolution that gives about the paper's number of faces,
 * and the paper's Tables 1 and 2. */
typedef struct study_plant {
    const char *name, *kind;
    double resolution;
    int leaves, internodes, faces;
    double height, radius, face_area_mm2;
    double visible_faces, visible_area; /* shares */
} study_plant;

extern const study_plant study_plants[STUDY_PLANTS];

/** What was grown, for Table 1. */
typedef struct study_model {
    bool is_there;
    size_t leaves, nodes, vertices, faces;
    double height, radius, area;
} study_model;

/** All results: value[plant][loss][step][trait]; step is the loss in percent. */
typedef struct study {
    const char *folder;
    int max_loss;
    bool has_plant[STUDY_PLANTS], has_loss[PLM_LOSS_COUNT];
    study_model model[STUDY_PLANTS];
    double value[STUDY_PLANTS][PLM_LOSS_COUNT][STUDY_STEPS_MOST][PLM_THIN_COUNT];
} study;

/** Writes thinning.csv, relative.csv, table1, table2 and table3 (CSV and Markdown) and visibility_correction.csv. */
plm_status study_write_tables(const study *all, plm_error *error);

/** Writes ellipsoid_PLANT.csv: area and hits of the faces of the half ellipsoid that visibility is judged by (figure 8). */
plm_status study_write_ellipsoid(const study *all, int plant, const plm_thinning *thinning, plm_error *error);

/** Writes a gnuplot script beside each picture and runs it. Gives false when gnuplot cannot be run: the scripts are there. */
bool study_plot(const study *all, plm_status *status, plm_error *error);

/** `study light`: the error of absorbed light against the number of rays, on the intact plant: runs of 1000 rays, four times as many, and
 * so on up to `most`, each with 8 seeds, against the mean of all runs of the most rays and three more of them. Writes light_error.csv
 * (rays, and for the plant and for its leaves: RMS error and reported standard error, relative) and figure light_error. */
plm_status study_light(const study *all, int plant, uint64_t most, uint64_t seed, bool *is_drawn, plm_error *error);

/** Runs the script folder/NAME.gp with gnuplot: ending is svg or png. False when it does not draw. */
bool study_run_gnuplot(const char *folder, const char *name, const char *ending);

/** folder/name. */
plm_status study_path(const study *all, const char *name, char path[STUDY_PATH], plm_error *error);

#endif
