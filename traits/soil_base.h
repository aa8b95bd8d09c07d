/* traits/soil_base.h: the base of a plant that stands in seen soil, or on a seen table. Internal. */
#ifndef PLANTIMETER_TRAITS_SOIL_BASE_H
#define PLANTIMETER_TRAITS_SOIL_BASE_H

#include "traits/extreme.h"
#include "traits/scene.h"

/** Puts the base of a plant (base: of plm_extreme_along down the zenith: minus a height) to the surface of the ground about its
 * foot, where the ground was found there, what the plant has just above it is as narrow as a foot, and the base was seen
 * near it. Of the points alone: the same whatever else is asked for. changed: whether it did. PLM_E_MEMORY. */
plm_status plm_soil_base(const plm_scene *scene, double height, plm_extreme *base, bool *changed, plm_error *error);

/** Height of the ground (metres, offset as the plant's points) about a place seen from above and its standard error: of the nearest points
 * of the ground, but not of those within twice width of the place, where something stands. height: of the plant; what is off the
 * ground's plane by more than a share of it and by four times the noise is no ground here. told: false where no ground was found,
 * or hardly a point of it lies within reach; the two others mean nothing then. PLM_E_MEMORY. */
plm_status plm_soil_height(const plm_scene *scene, const double place[2], double width, double reach, double height,
                           double noise, double *soil, double *std_error, bool *told, plm_error *error);

#endif
