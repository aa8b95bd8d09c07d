/* traits/counts.c: how many organs a plant has. Counts carry no standard error: a miscounted leaf is not a deviation in
 * a continuous value; the flags merged_leaf and uncertain say where a count is in doubt. */
#include "traits/families.h"
#include "traits/scene.h"

#include <stdlib.h>
#include <string.h>

plm_status plm_trait_leaf_count(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ, (void)error;
    size_t count = 0;
    for (size_t i = 0; i < scene->organ_count; i++)
        if (scene->organ[i].label == PLM_LABEL_LEAF) {
            count++;
            out->flags |= scene->organ[i].flags & (PLM_FLAG_MERGED_LEAF | PLM_FLAG_UNCERTAIN);
        }
    out->value = (double)count;
    out->method = "organs labelled leaf";
    return PLM_OK;
}

static int compare_numbers(const void *a, const void *b)
{
    const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* How many different leaflet numbers a leaf's points have. */
static plm_status count_leaflets(const plm_organ *leaf, size_t *count, plm_error *error)
{
    int32_t *number = plm_alloc(leaf->count, sizeof *number, error);
    if (!number) return PLM_E_MEMORY;
    memcpy(number, leaf->leaflet, leaf->count * sizeof *number);
    qsort(number, leaf->count, sizeof *number, compare_numbers);
    for (size_t i = 0; i < leaf->count; i++) *count += number[i] >= 0 && (i == 0 || number[i] != number[i - 1]);
    plm_free(number);
    return PLM_OK;
}

plm_status plm_trait_leaflet_count(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ;
    size_t count = 0;
    for (size_t i = 0; i < scene->organ_count; i++) {
        if (!scene->organ[i].leaflet) continue;
        const plm_status status = count_leaflets(&scene->organ[i], &count, error);
        if (status != PLM_OK) return status;
    }
    if (count == 0) return plm_not_applicable(out, "no compound leaves were found");
    out->value = (double)count;
    out->method = "blades of compound leaves";
    return PLM_OK;
}
