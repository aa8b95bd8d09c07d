/* traits/leaf_inclination.c: how a leaf is tilted: as one plane, and facet by facet (seedling paper, Eq. 24). z is zenith
 * once the frame stage has run. */
#include "cloud/linear.h"
#include "traits/families.h"
#include "traits/leaf_midrib.h"
#include "traits/leaf_surfaces.h"

#include <math.h>

/* Facets on noisy leaves: what the smoothing leaves of the noise tilts them. Measured on virtual plants. */
static const double facet_spread_share = 0.04, facet_noise_share = 0.02;

/* Where the label of the blade was found and is off by a part of the leaf's length, a piece is missing or too many whose area
 * goes with the square of that, and which is tilted otherwise as the facets are. Likeliest on virtual plants, as in
 * mesh/leaf_surface.c. */
static const double border_share = 7;

/* Of a normal against zenith. atan2, not acos: near 0 degrees acos turns a rounding of 1e-16 into 1e-8 rad. */
static double tilt_of(const double normal[3])
{
    return atan2(hypot(normal[0], normal[1]), fabs(normal[2]));
}

static double border_error(const plm_organ *leaf)
{
    if (!leaf->midrib || !(leaf->midrib->length > 0)) return 0;
    const double part = leaf->midrib->junction_error / leaf->midrib->length;
    return border_share * leaf->surface.facet_inclination_sd * part * part;
}

/* Length of an end that sampling and noise leave out at most, and the share of its turn that is usual. Of 180 virtual leaves whose middle
 * moment is less than twice the smallest 0.97 are within two standard errors so. */
static const double lost_spacings = 2, lost_noise = 4, lost_unsure = 0.85;

/* Offset along the long axis of the plane. */
static double along(const plm_plane *plane, const double at[3])
{
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = at[k] - plane->centroid[k];
    return plm_dot(d, plane->axis[0]);
}

/* Area-weighted products of the offsets along the plane's middle axis and across it, of the facets within reach of the lower
 * and of the upper end of the long axis. */
static void end_moments(const plm_leaf_surface *surface, const double reach[2], double moment[2])
{
    const plm_mesh *mesh = &surface->mesh;
    const plm_plane *plane = &surface->plane;
    double area = 0, low = INFINITY, high = -INFINITY;
    moment[0] = moment[1] = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            const double at = along(plane, mesh->vertex[mesh->triangle[t][i]]);
            low = fmin(low, at);
            high = fmax(high, at);
        }
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const double *p = mesh->vertex[mesh->triangle[t][0]], *q = mesh->vertex[mesh->triangle[t][1]];
        const double *r = mesh->vertex[mesh->triangle[t][2]];
        double a[3], b[3], middle[3], across[3];
        for (int k = 0; k < 3; k++) {
            a[k] = q[k] - p[k];
            b[k] = r[k] - p[k];
            middle[k] = (p[k] + q[k] + r[k]) / 3;
        }
        plm_cross(a, b, across);
        const double part = 0.5 * plm_norm(across), at = along(plane, middle);
        area += part;
        for (int k = 0; k < 3; k++) middle[k] -= plane->centroid[k];
        const double product = part * plm_dot(middle, plane->axis[1]) * plm_dot(middle, plane->normal);
        if (at - low < reach[0]) moment[0] += product;
        if (high - at < reach[1]) moment[1] += product;
    }
    for (int i = 0; i < 2 && area > 0; i++) moment[i] /= area;
}

/* What is missing or too much at the ends of a leaf, far from its middle, turns a plane whose two smaller moments are nearly
 * alike (an arched strap) about its long axis: by up to 45 degrees where they are not told apart. */
static double ends_error(const plm_organ *leaf)
{
    const plm_leaf_surface *surface = &leaf->surface;
    const plm_plane *plane = &surface->plane;
    if (!(plane->eigenvalue[1] > 0)) return 0;
    const double lost = lost_spacings * surface->spacing + lost_noise * surface->noise;
    double reach[2] = {lost, lost}, moment[2];
    if (leaf->midrib) {
        double *base = &reach[along(plane, leaf->midrib->base) > 0];
        *base = hypot(lost, leaf->midrib->junction_error);
    }
    end_moments(surface, reach, moment);
    const double turn = 0.5 * atan2(2 * hypot(moment[0], moment[1]), plane->eigenvalue[1] - plane->eigenvalue[2]);
    double most = 0;
    for (int side = -1; side <= 1; side += 2) {
        double turned[3];
        for (int k = 0; k < 3; k++) turned[k] = cos(turn) * plane->normal[k] + side * sin(turn) * plane->axis[1][k];
        most = fmax(most, fabs(tilt_of(turned) - tilt_of(plane->normal)));
    }
    return most;
}

/* Noise of a fifth of the blade's width and more hides how the leaf is turned about its length, as the points may lie farther
 * off its plane than across it. Leaves of plants with petioles are level across: of 594 virtual ones the SD of that turn is 6 to
 * 22 degrees by kind, of the 17 shorter than 5 mm 6. Less noise hides little: what of a radian is unknown goes with the fourth
 * power of its variance over the moment across (half of the weight is the level's at 0.4). */
static const double level_sd = 12 * PLM_PI / 180, hidden = 8;

static bool has_petioles(const plm_scene *scene)
{
    bool any = false;
    for (size_t k = 0; k < scene->organ_count; k++) any |= scene->organ[k].label == PLM_LABEL_PETIOLE;
    return any;
}

static void turn_by(double angle, const double lying[3], const double upright[3], const double across[3], double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = lying[k] + cos(angle) * upright[k] + sin(angle) * across[k];
}

/* The likeliest normal, given what noise hides of the turn about the way from base to tip, and that leaves are level across it (a
 * round leaf's longest axis may lie across). error: of its tilt. Gives the weight of being level. */
static double level_normal(const plm_leaf_surface *surface, const double way[3], double normal[3], double *error)
{
    const plm_plane *plane = &surface->plane;
    double across[3], upright[3], moment = 0, weight = 0;
    const double lean = plm_dot(plane->normal, way);
    for (int k = 0; k < 3; k++) upright[k] = plane->normal[k] - lean * way[k];
    plm_cross(way, upright, across);
    for (int k = 0; k < 3; k++)
        moment += plane->eigenvalue[k] * pow(plm_dot(k < 2 ? plane->axis[k] : plane->normal, across), 2);
    const double squared = plm_dot(across, across);
    if (moment > 0) {
        const double ratio = surface->noise * surface->noise * squared / moment;
        const double unknown = fmin(hidden * pow(ratio, 4), PLM_PI / 2);
        weight = unknown * unknown / (unknown * unknown + level_sd * level_sd);
    }
    const double slope = upright[2] < 0 ? -across[2] : across[2];
    const double turn = weight * atan2(slope, fabs(upright[2]));
    double lying[3];
    for (int k = 0; k < 3; k++) lying[k] = lean * way[k];
    turn_by(turn, lying, upright, across, normal);
    *error = 0;
    for (int side = -1; side <= 1; side += 2) {
        double turned[3];
        turn_by(turn + side * sqrt(weight) * level_sd, lying, upright, across, turned);
        *error = fmax(*error, fabs(tilt_of(turned) - tilt_of(normal)));
    }
    return weight;
}

plm_status plm_trait_leaf_inclination(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out,
                                      plm_error *error)
{
    (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    const plm_leaf_surface *surface = &leaf->surface;
    double normal[3], weight = 0, turn_error = 0;
    for (int k = 0; k < 3; k++) normal[k] = surface->plane.normal[k];
    if (leaf->midrib && has_petioles(scene)) {
        double way[3];
        for (int k = 0; k < 3; k++) way[k] = leaf->midrib->tip[k] - leaf->midrib->base[k];
        if (plm_normalise(way) > 0) weight = level_normal(surface, way, normal, &turn_error);
    }
    out->value = tilt_of(normal);
    out->std_error =
        hypot(hypot(surface->plane_std_error, border_error(leaf)), /* ends turn what is not taken as level */
              hypot((1 - weight) * lost_unsure * ends_error(leaf), turn_error));
    out->method = weight > 0.5 ? "area-weighted plane, taken as level across" : "area-weighted plane";
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
