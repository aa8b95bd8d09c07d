/* traits/leaf_size.c: length and width of leaves, and the directions in which they point. */
#include "traits/families.h"
#include "traits/leaf_midrib.h"
#include "traits/leaf_surfaces.h"
#include "traits/plant_foot.h"

#include "cloud/linear.h"

#include <math.h>

/* Share of the spread of a round end by which its tip is unsure across the leaf (virtual cucumbers, okras and rosettes). */
static const double round_tip = 0.5;

static bool has_midrib(const plm_organ *leaf, plm_estimate *out)
{
    if (!plm_leaf_has_surface(leaf, out)) return false;
    if (leaf->midrib) {
        out->method = leaf->midrib->method;
        return true;
    }
    plm_not_applicable(out, "neither a petiole nor a stem tells where the leaf begins");
    return false;
}

plm_status plm_trait_leaf_length(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out, plm_error *error)
{
    (void)scene, (void)error;
    if (!has_midrib(leaf, out)) return PLM_OK;
    out->value = leaf->midrib->length;
    out->std_error = leaf->midrib->length_error;
    return PLM_OK;
}

plm_status plm_trait_leaf_width(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out, plm_error *error)
{
    (void)scene, (void)error;
    if (!has_midrib(leaf, out)) return PLM_OK;
    out->value = leaf->midrib->width;
    out->std_error = leaf->midrib->width_error;
    return PLM_OK;
}

/* Direction of (x, y) from +x towards +y, 0 to 2 pi, and its standard error for an error e of each end. */
static plm_status point_azimuth(double x, double y, double e, plm_estimate *out)
{
    const double length = hypot(x, y);
    if (!(length > 2 * e))
        return plm_not_applicable(out, "seen from above, the two ends are only %.2g mm apart", 1e3 * length);
    const double angle = atan2(y, x);
    out->value = angle < 0 ? angle + 2 * PLM_PI : angle;
    out->std_error = e / length;
    return PLM_OK;
}

plm_status plm_trait_leaf_azimuth(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out, plm_error *error)
{
    (void)scene, (void)error;
    if (!has_midrib(leaf, out)) return PLM_OK;
    const plm_midrib *midrib = leaf->midrib;
    const double e = hypot(hypot(midrib->end_error * sqrt(2), 0.015 * midrib->length), round_tip * midrib->tip_spread);
    return point_azimuth(midrib->tip[0] - midrib->base[0], midrib->tip[1] - midrib->base[1], e, out);
}

plm_status plm_trait_leaf_azimuth_from_stem(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out,
                                            plm_error *error)
{
    double base[2], of_base;
    bool found;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    const plm_status status = plm_plant_foot(scene, base, &of_base, &found, error);
    if (status != PLM_OK) return status;
    if (!found) return plm_not_applicable(out, "neither a stem nor petioles tell where the plant stands");
    const double *centroid = leaf->surface.plane.centroid;
    const double of_leaf = 0.5 * leaf->surface.spacing + 0.2 * leaf->surface.noise;
    out->method = "plant base to area centroid";
    return point_azimuth(centroid[0] - base[0], centroid[1] - base[1], hypot(of_base, of_leaf), out);
}
