/* traits/counts.c: how many organs a plant has. Counts carry no standard error: a miscounted leaf is not a deviation in
 * a continuous value; the flags merged_leaf and uncertain say where a count is in doubt. */
#include "traits/families.h"
#include "traits/scene.h"

#include <math.h>

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

/* Leaflets are numbered from 0 within their leaf. */
static size_t leaflets_of(const plm_organ *leaf)
{
    int32_t highest = -1;
    for (size_t i = 0; i < leaf->count; i++)
        if (leaf->leaflet[i] > highest) highest = leaf->leaflet[i];
    return (size_t)(highest + 1);
}

plm_status plm_trait_leaflet_count(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)organ, (void)error;
    size_t count = 0;
    for (size_t i = 0; i < scene->organ_count; i++)
        if (scene->organ[i].leaflet) count += leaflets_of(&scene->organ[i]);
    if (count == 0) return plm_not_applicable(out, "no compound leaves were found");
    out->value = (double)count;
    out->method = "blades of compound leaves";
    return PLM_OK;
}
