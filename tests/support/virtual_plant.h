/* tests/support/virtual_plant.h: a virtual plant, its scan, and what segmentation makes of that. */
#ifndef PLANTIMETER_TESTS_VIRTUAL_PLANT_H
#define PLANTIMETER_TESTS_VIRTUAL_PLANT_H

#include "segment/segment.h"
#include "simulate/simulate.h"

typedef struct virtual_plant {
    plm_virtual_plant plant;
    plm_scan scan;
    plm_segmentation found;
} virtual_plant;

/** Grows a plant of the seed of the options, scans it, takes floaters and ghosts off, and finds its organs; a failure is one of
 * the test. resolution: as plm_plant_options. Freed by virtual_plant_free. */
virtual_plant virtual_plant_make(const char *kind, double resolution, const plm_scan_options *options);

/** The organs of the same points as found by who says what plant it is. The caller's: plm_segmentation_free. */
plm_segmentation virtual_plant_as(const virtual_plant *made, plm_habit habit);

/** Fails the test unless all of the leaves are found and no more (leaves: how many there are), F1 is 0.99 and more, and less than a tenth of
 * the points that are of no organ (tassels, fruit) are in leaves. The plant's resolution is 0.3. */
void virtual_plant_assert_leaves(const char *kind, const plm_scan_options *options, size_t leaves);

/** Fails the test unless all of the leaves are found and no more, F1 is 1, and the stem's IoU is above so much. Gives the habit that was
 * found. The plant's resolution is the default. */
plm_habit virtual_plant_assert_stem(const char *kind, double stem, const plm_scan_options *options);

void virtual_plant_free(virtual_plant *made);

#endif
