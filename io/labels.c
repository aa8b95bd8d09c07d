/* io/labels.c: labels and organ numbers of files, in their two schemes. */
#include "io/labels.h"

#include <math.h>
#include <string.h>

enum { MOST_ORGANS = 65536 };

bool plm_label_store(plm_label_scheme scheme, double label, double organ, plm_cloud *cloud, size_t at)
{
    const double number = isnan(label) ? (scheme == PLM_LABELS_INSTANCES ? -1 : PLM_LABEL_OTHER) : label;
    if (number != floor(number) || fabs(number) > INT32_MAX) return false;
    if (scheme == PLM_LABELS_INSTANCES) {
        cloud->organ[at] = (int32_t)number;
        return true;
    }
    if (number < 0 || number >= PLM_LABEL_COUNT) return false;
    cloud->label[at] = (uint8_t)number;
    if (!cloud->organ) return true;
    const double organ_number = isnan(organ) || organ < 0 ? -1 : organ;
    if (organ_number != floor(organ_number) || organ_number > INT32_MAX) return false;
    cloud->organ[at] = (int32_t)organ_number;
    return true;
}

/* Where number is, or would be put, among the ascending numbers. */
static size_t place_of(const int32_t *numbers, size_t count, int32_t number)
{
    size_t low = 0, high = count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (numbers[middle] < number)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* The leaves' numbers, ascending. PLM_E_FORMAT when there are more than MOST_ORGANS. */
static plm_status list_leaves(const plm_cloud *cloud, int32_t stem_label, const char *name, int32_t *leaves,
                              size_t *leaf_count, plm_error *error)
{
    size_t count = 0;
    for (size_t i = 0; i < cloud->count; i++) {
        const int32_t number = cloud->organ[i];
        if (number == stem_label || number < 0) continue;
        const size_t at = place_of(leaves, count, number);
        if (at < count && leaves[at] == number) continue;
        if (count == MOST_ORGANS)
            return plm_fail(error, PLM_E_FORMAT,
                            "%s: the label field has more than %d different numbers; one number an organ was expected",
                            name, MOST_ORGANS);
        memmove(leaves + at + 1, leaves + at, (count - at) * sizeof *leaves);
        leaves[at] = number;
        count++;
    }
    *leaf_count = count;
    return PLM_OK;
}

plm_status plm_labels_from_instances(plm_cloud *cloud, int32_t stem_label, const char *name, plm_error *error)
{
    size_t leaf_count = 0;
    int32_t *leaves = plm_alloc(MOST_ORGANS, sizeof *leaves, error);
    plm_status status = leaves ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) status = list_leaves(cloud, stem_label, name, leaves, &leaf_count, error);
    for (size_t i = 0; status == PLM_OK && i < cloud->count; i++) {
        const int32_t number = cloud->organ[i];
        const bool is_stem = number == stem_label, is_none = !is_stem && number < 0;
        cloud->label[i] = is_stem ? PLM_LABEL_STEM : is_none ? PLM_LABEL_OTHER : PLM_LABEL_LEAF;
        cloud->organ[i] = is_stem ? 0 : is_none ? -1 : (int32_t)place_of(leaves, leaf_count, number);
    }
    plm_free(leaves);
    return status;
}
