/* traits/stem_traits.c: diameter, length and inclination of stems, from their fitted axes. */
#include "traits/axis.h"
#include "traits/families.h"
#include "traits/tube_diameter.h"

#include <math.h>

static plm_status without_axis(const plm_organ *organ, plm_estimate *out)
{
    return plm_trait_failed(out, "no axis was found: %s", organ->axis_reason);
}

/* At the option's height along the axis, or half way up a stem that is shorter than twice that; from points within half
 * of the height (three radii where the stem is thick) to both sides. */
plm_status plm_trait_stem_diameter(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    const plm_axis *axis = organ->axis;
    if (!axis) return without_axis(organ, out);
    const double height = fmin(scene->options->stem_height, 0.5 * axis->length);
    const double reach = fmin(fmax(0.5 * height, 3 * axis->radius), 0.6 * height);
    const double along = axis->end < axis->begin ? -height : height;
    return plm_tube_diameter(scene, organ, plm_curve_walk(&axis->line, axis->begin, along), reach, out, error);
}

plm_status plm_trait_stem_length(const plm_scene *scene, const plm_organ *organ, plm_estimate *out, plm_error *error)
{
    (void)scene, (void)error;
    const plm_axis *axis = organ->axis;
    if (!axis) return without_axis(organ, out);
    out->value = axis->length;
    out->std_error = axis->length_error;
    out->point_count = axis->point_count;
    out->flags |= axis->flags;
    out->method = axis->method;
    out->fit = axis->fit;
    return PLM_OK;
}

plm_status plm_trait_stem_inclination(const plm_scene *scene, const plm_organ *organ, plm_estimate *out,
                                      plm_error *error)
{
    (void)scene, (void)error;
    const plm_axis *axis = organ->axis;
    if (!axis) return without_axis(organ, out);
    out->value = atan2(hypot(axis->direction[0], axis->direction[1]), axis->direction[2]);
    out->std_error = axis->direction_error;
    out->point_count = axis->point_count;
    out->flags |= axis->flags;
    out->method = axis->method;
    out->fit = axis->fit;
    return PLM_OK;
}
