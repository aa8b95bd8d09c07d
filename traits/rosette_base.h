/* traits/rosette_base.h: the lowest surface of a rosette, which its own leaves hide. Internal. */
#ifndef PLANTIMETER_TRAITS_ROSETTE_BASE_H
#define PLANTIMETER_TRAITS_ROSETTE_BASE_H

#include "traits/extreme.h"
#include "traits/scene.h"

/** Whether a plant is so low against its width that it may be a rosette. Of the points alone: the same whatever is asked for. */
bool plm_may_be_rosette(const plm_scene *scene);

/** Lowers (in scans without noise: mends) the base of what may be a rosette (base: of plm_extreme_along down the zenith: minus a
 * height) to where its petioles meet, as far as they tell: their lines are prolonged to the plant's foot, their radii taken off.
 * Where the ground about the foot is seen, that it stands on it counts as well. Other plants keep theirs. height: of the plant as
 * seen, metres. Needs axes; within a time budget, whose passes may lack them, the base stays as it was seen. lowered: whether it
 * changed; on_soil: by the ground, too. PLM_E_MEMORY. */
plm_status plm_rosette_base(const plm_scene *scene, double height, plm_extreme *base, bool *lowered, bool *on_soil,
                            plm_error *error);

#endif
