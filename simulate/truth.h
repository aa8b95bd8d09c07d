/* simulate/truth.h: the truth that is taken from the faces of a plant. Internal. */
#ifndef PLANTIMETER_SIMULATE_TRUTH_H
#define PLANTIMETER_SIMULATE_TRUTH_H

#include "simulate/simulate.h"

/** Area, area centroid and area-weighted second moments of a set of faces, summed face by face. */
typedef struct plm_moments {
    double area;
    double first[3];  /* integral of the position */
    double second[6]; /* integral of xx, xy, xz, yy, yz, zz */
} plm_moments;

/** Adds a triangle's exact moments. */
void plm_moments_add(plm_moments *moments, const double a[3], const double b[3], const double c[3]);

/** Centroid and the principal axes about it: variances (largest first) and unit axes. */
void plm_moments_axes(const plm_moments *moments, double centroid[3], double variance[3], double axis[3][3]);

/** Fills everything of the truth that follows from faces: organs' areas, planes and centroids, and the whole plant
 * (silhouettes in silhouette.c, crossings in crossings.c). hull_volume and hull_area become NAN. */
plm_status plm_truth_from_faces(plm_virtual_plant *plant, plm_error *error);

/** Area of the silhouette seen along axis (0, 1, 2), and the share of the leaves' silhouettes lost to overlap; on a
 * raster of 1500 cells along the longer side. PLM_E_MEMORY. */
plm_status plm_silhouette(const plm_virtual_plant *plant, int axis, double *area, double *leaf_overlap,
                          plm_error *error);

#endif
