/* traits/hull_corners.h: what a convex hull of sampled points lacks of that of their surface, at its corners. Internal. */
#ifndef PLANTIMETER_TRAITS_HULL_CORNERS_H
#define PLANTIMETER_TRAITS_HULL_CORNERS_H

#include "cloud/neighbours.h"
#include "traits/projection.h"

/** The volume that the hull of points of a surface lacks, and its standard error (m3): less than 0 where noise makes the hull larger
 * than their sampling makes it smaller.
 * hull      closed, of the points, in their frame
 * index     over xyz
 * onto      of a cloud with noise, how each of xyz was projected to where it is (to onto.place); NULL: without noise
 * sampling  the noise and its kind; of a cloud without noise not looked at
 *
 * A face of the hull moves outwards by how far the surface goes on, along the face's normal, behind the points at each of its three
 * corners (plm_end_of_corner of the points about them; in noise plm_end_of_sample). Of very many faces the largest tell for all.
 * PLM_E_MEMORY. */
plm_status plm_hull_corners(const plm_mesh *hull, const plm_index *index, const float (*xyz)[3],
                            const plm_projection *onto, const plm_sampling *sampling, double *lacking,
                            double *std_error, plm_error *error);

#endif
