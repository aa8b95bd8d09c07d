/* traits/petiole_course.h: the course of a petiole among what branches off it. Internal. */
#ifndef PLANTIMETER_TRAITS_PETIOLE_COURSE_H
#define PLANTIMETER_TRAITS_PETIOLE_COURSE_H

#include "traits/axis.h"

/** Finds the far end of a petiole whose points hold petiolules, and leaflets taken for such, as well: far (a guess) moves to
 * another end where the line from the base to that is clearly longer on points. Where a seventh of the points or more are off the line,
 * they are taken out of points. PLM_E_MEMORY. */
plm_status plm_petiole_course(plm_tube_points *points, const double base[3], double far[3], plm_error *error);

#endif
