/* traits/leaf_area.c: area of leaves, and how it depends on alpha. */
#include "traits/families.h"
#include "traits/leaf_midrib.h"
#include "traits/leaf_surfaces.h"

#include <math.h>

static const char *const method = "smoothed triangulation, local alpha";

/* A found junction that is off takes a piece of the petiole to the leaf or the other way: hardly as wide as that is thick where a
 * large blade begins, up to three times where a young one does, which is a few times as wide as its petiole; of a leaf on the stem
 * itself a tenth of the stem. Shares as in mesh/leaf_surface.c. */
static const double junction_width = 0.6, young_width = 12, youngest = 0.2, junction_on_stem = 0.1;

double plm_leaf_area_error(const plm_organ *leaf)
{
    const plm_midrib *midrib = leaf->midrib;
    if (!midrib) return leaf->surface.area_std_error;
    const double young = midrib->width > 0 ? fmin(midrib->thickness / midrib->width, youngest) : youngest;
    const double width = midrib->on_stem ? junction_on_stem : junction_width + young_width * young;
    return hypot(leaf->surface.area_std_error, width * midrib->thickness * midrib->junction_error);
}

plm_status plm_trait_leaf_area(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out, plm_error *error)
{
    (void)scene, (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    out->value = leaf->surface.area;
    out->std_error = plm_leaf_area_error(leaf);
    out->method = method;
    return PLM_OK;
}

/* Errors of the leaves of one plant have much in common (the rim's bias): a part that adds up, a part that does not. */
plm_status plm_trait_total_leaf_area(const plm_scene *scene, const plm_organ *organ, plm_estimate *out,
                                     plm_error *error)
{
    (void)organ, (void)error;
    static const double shared = 0.5;
    double sum = 0, errors = 0, squares = 0;
    size_t points = 0, leaves = 0;
    for (size_t i = 0; i < scene->organ_count; i++) {
        const plm_organ *leaf = &scene->organ[i];
        if (leaf->label != PLM_LABEL_LEAF) continue;
        if (!(leaf->surface.mesh.triangle_count > 0)) {
            out->flags |= PLM_FLAG_UNCERTAIN; /* a leaf without a surface is missing in the sum */
            continue;
        }
        sum += leaf->surface.area;
        const double error_of_leaf = plm_leaf_area_error(leaf);
        errors += error_of_leaf;
        squares += error_of_leaf * error_of_leaf;
        points += leaf->count;
        leaves++;
    }
    if (leaves == 0) return plm_not_applicable(out, "no leaf with a surface was found");
    out->value = sum;
    out->std_error = sqrt(shared * errors * errors + (1 - shared) * squares);
    out->point_count = points;
    out->method = "sum over leaves";
    return PLM_OK;
}

plm_status plm_trait_leaf_alpha(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out, plm_error *error)
{
    (void)scene, (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    out->value = leaf->surface.alpha;
    out->method = method;
    return PLM_OK;
}

plm_status plm_trait_leaf_alpha_sensitivity(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out,
                                            plm_error *error)
{
    (void)scene, (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    out->value = leaf->surface.alpha_sensitivity;
    out->method = method;
    return PLM_OK;
}
