/* traits/leaf_area.c: area of leaves, and how it depends on alpha. */
#include "traits/families.h"
#include "traits/leaf_midrib.h"
#include "traits/leaf_surfaces.h"

#include <math.h>

static const char *const method = "smoothed triangulation, local alpha";

/* A found junction that is off takes a piece of the petiole to the leaf or the other way: some three thicknesses wide, as it
 * widens into the blade. */
static const double junction_width = 3.0;

static double error_of_area(const plm_organ *leaf)
{
    const plm_midrib *midrib = leaf->midrib;
    return hypot(leaf->surface.area_std_error,
                 midrib ? junction_width * midrib->thickness * midrib->junction_error : 0);
}

plm_status plm_trait_leaf_area(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out, plm_error *error)
{
    (void)scene, (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    out->value = leaf->surface.area;
    out->std_error = error_of_area(leaf);
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
        const double error_of_leaf = error_of_area(leaf);
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
