/* traits/leaf_midrib.h: where a leaf begins and ends, and how long and wide it is along its surface. Internal. */
#ifndef PLANTIMETER_TRAITS_LEAF_MIDRIB_H
#define PLANTIMETER_TRAITS_LEAF_MIDRIB_H

#include "traits/scene.h"

/** The line from a leaf's junction to its tip. Offsets as the organ's points, metres. */
typedef struct plm_midrib {
    double base[3];    /**< blade junction; compound leaves: base of the petiole */
    double tip[3];     /**< of the blade; compound leaves: of the last leaflet */
    double end_error;  /**< standard error of either end, along any direction */
    double tip_spread; /**< RMS extent across the leaf of what is as far out as the tip: large where it is round */
    double length, length_error; /**< arc from the junction (compound: of the first leaflet) to the tip */
    double width, width_error; /**< largest section along the surface; compound: extent across the leaf in its plane */
    double thickness;          /**< of the organ that the leaf hangs on, from its points */
    double junction_error;     /**< standard error of where that organ ends, where its label was found; else 0 */
    bool compound, on_stem;    /**< on_stem: that organ is a stem */
    const char *method;        /**< static text */
} plm_midrib;

/** Finds the midrib of a leaf that has a surface, from the organ it hangs on (its petiole, or else the nearest stem).
 * *midrib is the caller's (plm_free). PLM_E_DEGENERATE: there is neither petiole nor stem. */
plm_status plm_midrib_find(const plm_scene *scene, const plm_organ *leaf, plm_midrib **midrib, plm_error *error);

/* ---- Shared by its files --------------------------------------------------------------------------------------- */

enum { PLM_MIDRIB_STATIONS = 49 };

/** Points along the midrib, at equal parameters, and the length of the line. */
typedef struct plm_midrib_line {
    double at[PLM_MIDRIB_STATIONS][3];
    double length;
} plm_midrib_line;

/** Largest width of a mesh across a line: length of the cuts of the mesh with the planes across the line, those parts
 * left out that are nearer to another part of the line. */
plm_status plm_midrib_width(const plm_mesh *mesh, const plm_midrib_line *line, double *width, plm_error *error);

#endif
