/* io/labels.h: labels and organ numbers of files. Internal to io/. */
#ifndef PLANTIMETER_IO_LABELS_H
#define PLANTIMETER_IO_LABELS_H

#include "io/io.h"

/** Stores what a file has in its label and organ fields at point `at`. label NaN is "other"; organ NaN is -1.
 * Under PLM_LABELS_INSTANCES the raw number goes into cloud->organ, for plm_labels_from_instances.
 * False where the numbers are not of the scheme. */
bool plm_label_store(plm_label_scheme scheme, double label, double organ, plm_cloud *cloud, size_t at);

/** Turns raw instance numbers in cloud->organ into labels and organ numbers within their class: stem_label is the stem
 * (organ 0), every other number from 0 on a leaf, numbered in ascending order, negative numbers are "other".
 * PLM_E_FORMAT when there are so many numbers that they cannot be organs. */
plm_status plm_labels_from_instances(plm_cloud *cloud, int32_t stem_label, const char *name, plm_error *error);

#endif
