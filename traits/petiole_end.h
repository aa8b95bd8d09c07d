/* traits/petiole_end.h: where a petiole ends and its blade begins, by its points alone. Internal. */
#ifndef PLANTIMETER_TRAITS_PETIOLE_END_H
#define PLANTIMETER_TRAITS_PETIOLE_END_H

#include "traits/scene.h"

/** The end of a petiole that is away from its foot: end[3], metres, offsets as the organ's. The foot is what is nearest to stem, or
 * where that is NULL what is farthest from the leaf. found: false where the leaf is nearer to that foot than to the end. A few strays
 * among the points do no harm. PLM_E_MEMORY. */
plm_status plm_petiole_end(const plm_organ *petiole, const plm_organ *stem, const plm_organ *leaf, double end[3],
                           bool *found, plm_error *error);

/** Distance of a place from an organ's nearest point; INFINITY without points. */
double plm_organ_gap(const plm_organ *organ, const double place[3]);

#endif
