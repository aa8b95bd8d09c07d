/* traits/hull_corners.h: what a convex hull of sampled points lacks of that of their surface, at its corners. Internal. */
#ifndef PLANTIMETER_TRAITS_HULL_CORNERS_H
#define PLANTIMETER_TRAITS_HULL_CORNERS_H

#include "cloud/neighbours.h"
#include "traits/projection.h"

/** The volume that the hull of points of a surface, sampled without noise, lacks, and its standard error (m3).
 * hull   closed, of the points, in their frame
 * index  over xyz
 *
 * A face of the hull moves outwards by how far the surface goes on, along the face's normal, behind the points at each of its three
 * corners (plm_end_of_corner of the points about them). Of very many faces the largest tell for all. PLM_E_MEMORY. */
plm_status plm_hull_corners(const plm_mesh *hull, const plm_index *index, const float (*xyz)[3], double *lacking,
                            double *std_error, plm_error *error);

/** The volume that the hull of projected points lacks in noise, less than 0 where noise makes it larger than gaps make it smaller, and the
 * standard error of that by chance alone (m3): what the noise is like along the surface is not known to a third of it, and rims come
 * out 2 to 3 % too large at a noise of an eightieth of the hull's width.
 * hull      closed, of points that were projected to their surface
 * points    that surfaces are fitted to (plm_fit_points): those about the corners are projected, and tell where it ends with the noise
 *           that is left in them (plm_end_of_sample)
 * use       one a row of what points were taken of: false for what is no point of the surface
 * sampling  its noise, and whether it is of voxel means
 * PLM_E_MEMORY. */
plm_status plm_hull_noisy_corners(const plm_mesh *hull, const plm_subset *points, const bool *use,
                                  const plm_sampling *sampling, double *lacking, double *std_error, plm_error *error);

#endif
