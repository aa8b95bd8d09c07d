/* tests/support/found_ground.h: how well ground is told from a plant. */
#ifndef PLANTIMETER_TESTS_SUPPORT_FOUND_GROUND_H
#define PLANTIMETER_TESTS_SUPPORT_FOUND_GROUND_H

#include "segment/segment.h"
#include "simulate/simulate.h"

typedef struct found_ground {
    double iou, kept, left; /**< of ground; share of the plant's points that stay, and of the ground's */
    double lower;           /**< how much lower than the plant what is called plant reaches, in the cloud's unit */
    plm_ground ground;
} found_ground;

/** What is found in a cloud with true labels. A failure is one of the test. */
found_ground ground_in(const plm_cloud *cloud);

/** What is found in the scan of a virtual plant of the options' seed, with its colours or without. */
found_ground ground_in_grown(const char *kind, bool is_arched, const plm_scan_options *options, bool coloured);

/** The same of a plant as it comes. */
found_ground ground_in_plant(const char *kind, const plm_scan_options *options, bool coloured);

#endif
