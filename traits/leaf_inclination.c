/* traits/leaf_inclination.c: how a leaf is tilted: as one plane, and facet by facet (seedling paper, Eq. 24). z is zenith
 * once the frame stage has run. */
#include "traits/families.h"
#include "traits/leaf_surfaces.h"

#include <math.h>

/* Facets on noisy leaves: what the smoothing leaves of the noise tilts them. Measured on virtual plants. */
static const double facet_spread_share = 0.05, facet_noise_share = 0.03;

plm_status plm_trait_leaf_inclination(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out,
                                      plm_error *error)
{
    (void)scene, (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    const double *normal = leaf->surface.plane.normal;
    /* atan2, not acos: near 0 degrees acos turns a rounding of 1e-16 into 1e-8 rad. */
    out->value = atan2(hypot(normal[0], normal[1]), fabs(normal[2]));
    out->std_error = leaf->surface.plane_std_error;
    out->method = "area-weighted plane";
    return PLM_OK;
}

static double facet_error(const plm_leaf_surface *surface)
{
    const double spread = facet_spread_share * surface->facet_inclination_sd;
    const double noise = facet_noise_share * surface->noise / surface->spacing;
    return sqrt(surface->plane_std_error * surface->plane_std_error + spread * spread + noise * noise);
}

plm_status plm_trait_facet_inclination_mean(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out,
                                            plm_error *error)
{
    (void)scene, (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    out->value = leaf->surface.facet_inclination_mean;
    out->std_error = facet_error(&leaf->surface);
    out->method = "area-weighted facets";
    return PLM_OK;
}

plm_status plm_trait_facet_inclination_sd(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out,
                                          plm_error *error)
{
    (void)scene, (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    out->value = leaf->surface.facet_inclination_sd;
    out->std_error = facet_error(&leaf->surface);
    out->method = "area-weighted facets";
    return PLM_OK;
}

plm_status plm_trait_leaf_flatness(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out, plm_error *error)
{
    (void)scene, (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    const plm_leaf_surface *surface = &leaf->surface;
    const double middle = surface->plane.eigenvalue[1];
    out->value = fmax(surface->plane.eigenvalue[2], 0) / middle;
    /* Heights know the smallest eigenvalue to about 2 sqrt(value) times their own error, plus 2 % of the ratio. */
    const double height = surface->noise / sqrt((double)leaf->count) + 0.02 * surface->spacing;
    out->std_error = hypot(2 * sqrt(out->value / middle) * height, 0.02 * out->value);
    out->method = "area-weighted plane";
    return PLM_OK;
}
