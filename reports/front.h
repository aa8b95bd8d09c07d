/* reports/front.h: which of several settings are worth having: the Pareto front of cost and error. Internal. */
#ifndef PLANTIMETER_REPORTS_FRONT_H
#define PLANTIMETER_REPORTS_FRONT_H

#include <stdbool.h>
#include <stddef.h>

/** Marks the settings that no other one beats: none costs no more and errs no more, and less in one of the two. Equal ones
 * are on the front together. Rows with takes_part false, or whose cost or error is no number, are neither on the front nor do they
 * beat others. cost, error, takes_part, is_on: count rows. O(count^2): tables of settings are short. */
void plm_front_mark(const double *cost, const double *error, const bool *takes_part, size_t count, bool *is_on);

/** The row of least cost among those that take part and err at most by `most`; of equally cheap ones the one of least error, then
 * the first. count where there is none. */
size_t plm_front_cheapest(const double *cost, const double *error, const bool *takes_part, size_t count, double most);

#endif
