/* traits/petiole_traits.c: inclination, length and diameter of petioles, their angle to the stem, and the internodes
 * between them, from fitted axes. */
#include "traits/axis.h"
#include "traits/families.h"
#include "traits/tube_diameter.h"

#include "cloud/linear.h"

#include <math.h>

enum { FIRST_POINTS = 3, FEWEST_SHARP = 24 };

static const double petiolule_radii =
    8; /* off the rachis, within which leaf points are a leaflet's that stands there */
/* Noise over the radius below which half of the window tells the diameter as well, which flares and tapers within it. */
static const double sharp = 0.03;
static const double round_error = 0.01; /* of a petiole's diameter: it is no perfect circle */

static plm_status without_axis(const plm_organ *organ, plm_estimate *out)
{
    return plm_trait_failed(out, "no axis was found: %s", organ->axis_reason);
}

static void rests_on(const plm_axis *axis, plm_estimate *out)
{
    out->point_count = axis->point_count;
    out->flags |= axis->flags;
    out->method = axis->method;
    out->fit = axis->fit;
    if (axis->noise > axis->radius || axis->point_count < 100) out->flags |= PLM_FLAG_LOW_DENSITY;
}

plm_status plm_trait_petiole_inclination(const plm_scene *scene, const plm_organ *organ, plm_estimate *out,
                                         plm_error *error)
{
    (void)scene, (void)error;
    const plm_axis *axis = organ->axis;
    if (!axis) return without_axis(organ, out);
    out->value = atan2(hypot(axis->direction[0], axis->direction[1]), axis->direction[2]);
    out->std_error = axis->direction_error;
    rests_on(axis, out);
    return PLM_OK;
}

plm_status plm_trait_petiole_length(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)scene, (void)error;
    const plm_axis *axis = organ->axis;
    if (!axis) return without_axis(organ, out);
    out->value = axis->length;
    out->std_error = axis->length_error;
    rests_on(axis, out);
    return PLM_OK;
}

/* Length along the petiole to where its leaf begins: the whole length for a simple leaf, less for a compound one, whose
 * leaflets stand along the rachis, on petiolules of their own: leaf points nearer than eight radii count, but for the first two, which
 * may be strays. */
static double length_to_blade(const plm_scene *scene, const plm_organ *petiole)
{
    const plm_axis *axis = petiole->axis;
    const plm_organ *leaf = plm_scene_organ(scene, PLM_LABEL_LEAF, petiole->id);
    if (!leaf || !leaf->leaflet) return axis->length;
    double first[FIRST_POINTS];
    for (int k = 0; k < FIRST_POINTS; k++) first[k] = axis->length;
    for (size_t i = 0; i < leaf->count; i++) {
        const double point[3] = {leaf->xyz[i][0], leaf->xyz[i][1], leaf->xyz[i][2]};
        const double t = plm_curve_foot(&axis->line, point);
        if (t <= axis->begin || t >= axis->end) continue;
        double at[3];
        plm_curve_point(&axis->line, t, at);
        if (plm_distance(at, point) >= petiolule_radii * axis->radius) continue;
        double length = plm_curve_length(&axis->line, axis->begin, t);
        for (int k = 0; k < FIRST_POINTS; k++)
            if (length < first[k]) {
                const double later = first[k];
                first[k] = length;
                length = later;
            }
    }
    return first[FIRST_POINTS - 1];
}

plm_status plm_trait_petiole_diameter(const plm_scene *scene, const plm_organ *organ, plm_estimate *out,
                                      plm_error *error)
{
    const plm_axis *axis = organ->axis;
    if (!axis) return without_axis(organ, out);
    const double length = length_to_blade(scene, organ);
    const double reach = fmin(0.4 * length, 12 * axis->radius);
    const double place = plm_curve_walk(&axis->line, axis->begin, 0.5 * length);
    plm_status status = PLM_OK;
    const plm_estimate blank = *out;
    const bool is_sharp = axis->noise < sharp * axis->radius;
    if (is_sharp) status = plm_tube_diameter(scene, organ, place, 0.5 * reach, out, error);
    if (status == PLM_OK && (!is_sharp || out->state != PLM_STATE_OK || out->point_count < FEWEST_SHARP)) {
        *out = blank;
        status = plm_tube_diameter(scene, organ, place, reach, out, error);
    }
    if (status == PLM_OK && out->state == PLM_STATE_OK)
        out->std_error = hypot(out->std_error, round_error * out->value);
    return status;
}

/* Of a leaf: the angle of its petiole's chord against the stem's axis at the node. */
plm_status plm_trait_leaf_insertion_angle(const plm_scene *scene, const plm_organ *organ, plm_estimate *out,
                                          plm_error *error)
{
    (void)error;
    const plm_organ *petiole = plm_scene_organ(scene, PLM_LABEL_PETIOLE, organ->id);
    if (!petiole) return plm_not_applicable(out, "the leaf has no petiole");
    if (!petiole->axis) return without_axis(petiole, out);
    if (petiole->axis->carrier < 0) return plm_not_applicable(out, "the petiole stands on no stem that was found");
    out->value = petiole->axis->insertion;
    out->std_error = petiole->axis->insertion_error;
    rests_on(petiole->axis, out);
    return PLM_OK;
}

/* Mean position of the node that the petiole belongs to: petioles of one stem whose feet lie within reach of each other,
 * one after the other, share a node (opposite leaves, whorls). */
static double node_of(const plm_scene *scene, const plm_axis *petiole, double reach, double *lowest)
{
    double low = petiole->node, high = petiole->node, sum = 0;
    for (bool grown = true; grown;) {
        grown = false;
        size_t count = 0;
        sum = 0;
        for (size_t i = 0; i < scene->organ_count; i++) {
            const plm_axis *other = scene->organ[i].axis;
            if (scene->organ[i].label != PLM_LABEL_PETIOLE || !other || other->carrier != petiole->carrier) continue;
            if (other->node < low - reach || other->node > high + reach) continue;
            grown = grown || other->node < low || other->node > high;
            low = fmin(low, other->node);
            high = fmax(high, other->node);
            sum += other->node;
            count++;
        }
        sum /= (double)count;
    }
    *lowest = low;
    return sum;
}

/* Length along the stem from the next lower node to the node of this petiole. */
plm_status plm_trait_internode_length(const plm_scene *scene, const plm_organ *organ, plm_estimate *out,
                                      plm_error *error)
{
    (void)error;
    const plm_axis *axis = organ->axis;
    if (!axis) return without_axis(organ, out);
    const plm_organ *stem = axis->carrier < 0 ? NULL : plm_scene_organ(scene, PLM_LABEL_STEM, axis->carrier);
    if (!stem || !stem->axis) return plm_not_applicable(out, "the petiole stands on no stem that was found");
    const double reach = fmax(stem->axis->radius, 2 * axis->node_error);
    double lowest;
    const double node = node_of(scene, axis, reach, &lowest);
    const plm_axis *below = NULL;
    for (size_t i = 0; i < scene->organ_count; i++) {
        const plm_axis *other = scene->organ[i].axis;
        if (scene->organ[i].label != PLM_LABEL_PETIOLE || !other || other->carrier != axis->carrier) continue;
        if (other->node < lowest && (!below || other->node > below->node)) below = other;
    }
    if (!below) return plm_not_applicable(out, "the petiole stands at the lowest node");
    double unused;
    out->value = node - node_of(scene, below, reach, &unused);
    out->std_error = hypot(axis->node_error, below->node_error);
    rests_on(axis, out);
    return PLM_OK;
}
