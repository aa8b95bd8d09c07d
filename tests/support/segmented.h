/* tests/support/segmented.h: how well the organs of virtual plants are found. */
#ifndef PLANTIMETER_TESTS_SUPPORT_SEGMENTED_H
#define PLANTIMETER_TESTS_SUPPORT_SEGMENTED_H

#include "segment/segment.h"
#include "simulate/simulate.h"
#include "support/label_score.h"

/** Grows a plant, scans it, takes floaters and ghosts off and finds its organs. habit: out, what it was taken for. A failure is one of
 * the test, and so is a stem of a rosette. */
label_score segmented_grown(const char *kind, const plm_plant_options *growth, const plm_scan_options *options,
                            plm_habit *habit);

/** The same of a plant at half of the usual resolution. */
label_score segmented(const char *kind, uint64_t seed, const plm_scan_options *options, plm_habit *habit);

/** The same; fails the test unless the plant is taken for what it is, has as many leaves as are there, and has such F1 and mean IoU at
 * least. */
label_score segmented_as(const char *kind, plm_habit habit, uint64_t seed, const plm_scan_options *options, double f1,
                         double iou);

#endif
