/* traits/evaluate.h: from a finished scene to the rows of traits.csv. Internal. */
#ifndef PLANTIMETER_TRAITS_EVALUATE_H
#define PLANTIMETER_TRAITS_EVALUATE_H

#include "traits/scene.h"

/** Runs the chosen rows of the trait table over the scene. Values come by level (plant, stems, petioles, leaves), organ
 * and row of the table, whatever the number of threads. A level without organs gives one not_applicable row a trait.
 * Centroids are in the frame of scene->cloud, origin added. *values is the caller's (plm_free). late: out, set where values are
 * missing because of the deadline, of traits that need no organs and of those that do. */
plm_status plm_evaluate(const plm_scene *scene, const bool *chosen, plm_trait_value **values, size_t *value_count,
                        bool late[2], plm_error *error);

#endif
