/* traits/leaf_inclination.c: how a leaf is tilted: as one plane, and facet by facet (seedling paper, Eq. 24). z is zenith
 * once the frame stage has run. */
#include "traits/families.h"
#include "traits/leaf_midrib.h"
#include "traits/leaf_surfaces.h"

#include <math.h>

/* Facets on noisy leaves: what the smoothing leaves of the noise tilts them. Measured on virtual plants. */
static const double facet_spread_share = 0.05, facet_noise_share = 0.03;

/* Where the label of the blade was found and is off by a part of the leaf's length, a piece is missing or too many whose area
 * goes with the square of that, and which is tilted otherwise as the facets are. On virtual plants: 10 to 30 times the
 * product. */
static const double border_share = 20;

static double border_error(const plm_organ *leaf)
{
    if (!leaf->midrib || !(leaf->midrib->length > 0)) return 0;
    const double part = leaf->midrib->junction_error / leaf->midrib->length;
    return border_share * leaf->surface.facet_inclination_sd * part * part;
}

plm_status plm_trait_leaf_inclination(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out,
                                      plm_error *error)
{
    (void)scene, (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    const double *normal = leaf->surface.plane.normal;
    /* atan2, not acos: near 0 degrees acos turns a rounding of 1e-16 into 1e-8 rad. */
    out->value = atan2(hypot(normal[0], normal[1]), fabs(normal[2]));
    out->std_error = hypot(leaf->surface.plane_std_error, border_error(leaf));
    out->method = "area-weighted plane";
    return PLM_OK;
}

static double facet_error(const plm_organ *leaf)
{
    const plm_leaf_surface *surface = &leaf->surface;
    const double spread = facet_spread_share * surface->facet_inclination_sd;
    const double noise = facet_noise_share * surface->noise / surface->spacing;
    return hypot(hypot(surface->plane_std_error, border_error(leaf)), hypot(spread, noise));
}

plm_status plm_trait_facet_inclination_mean(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out,
                                            plm_error *error)
{
    (void)scene, (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    out->value = leaf->surface.facet_inclination_mean;
    out->std_error = facet_error(leaf);
    out->method = "area-weighted facets";
    return PLM_OK;
}

plm_status plm_trait_facet_inclination_sd(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out,
                                          plm_error *error)
{
    (void)scene, (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    out->value = leaf->surface.facet_inclination_sd;
    out->std_error = facet_error(leaf);
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
