/* traits/tube_diameter.h: the diameter of a stem or petiole at a place along its axis, noise taken off. Internal. */
#ifndef PLANTIMETER_TRAITS_TUBE_DIAMETER_H
#define PLANTIMETER_TRAITS_TUBE_DIAMETER_H

#include "traits/axis.h"

/** What noise adds to a fitted tube: noise across the normal and points beyond the surface move the fitted circle out.
 * Of voxel means the spread tells the noise; of points as they were seen the plant's noise does (sampling->noise, m), where it comes
 * near to the radius. fit, fit_error: fitted diameter and its standard error; spread: SD of the inlying residuals. Gives the diameter without
 * it and its standard error. sampling: the plant's: voxel means weigh a voxel that one stray pixel hit like one that fifty
 * hit, and so inflate more, the more pixels there are. */
void plm_tube_deflate(double fit, double fit_error, double spread, const plm_sampling *sampling, double *diameter,
                      double *std_error);

/** Diameter at parameter t of an organ's axis, from a tube (quadratic axis, linear radius) fitted to its points within
 * reach (m along the axis) to both sides; of stems of voxel means whose ring noise blurs, by plm_tube_moment. Fills value,
 * std_error, point_count, method, flags, or a reason to fail. */
plm_status plm_tube_diameter(const plm_scene *scene, const plm_organ *organ, double t, double reach, plm_estimate *out,
                             plm_error *error);

#endif
