/* traits/unit_scale.c: how many metres a file's unit is: guessed from the size, from a known length, from the pot. Formats of
 * point clouds do not state their unit (only LAS does, as a rule metres). */
#include "traits/traits.h"

#include "cloud/neighbours.h"
#include "cloud/order.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/** Sizes that a plant with its pot may have, metres. Taste: from a large seedling leaf to a small tree. */
static const double smallest_plant = 0.005, largest_plant = 20;

/** Laser arms leave 0.05 mm between points of a seedling (published scans of tomato and maize); what would be much finer
 * in millimetres is in centimetres. */
static const double finest_millimetres = 0.02;

enum { SAMPLE = 65536, QUERIES = 2000 };

/* Largest side of the box that holds all but the outer 0.5 % at each side: a floater must not change the unit. */
static plm_status robust_size(const plm_cloud *cloud, double *size, plm_error *error)
{
    const size_t step = cloud->count / SAMPLE + 1, count = (cloud->count + step - 1) / step;
    float *value = plm_alloc(count, sizeof *value, error);
    if (!value) return PLM_E_MEMORY;
    double largest = 0;
    for (int axis = 0; axis < 3; axis++) {
        for (size_t i = 0; i < count; i++) value[i] = cloud->xyz[i * step][axis];
        plm_order_sort(value, count);
        largest = fmax(largest, (double)value[count - 1 - count / 200] - value[count / 200]);
    }
    plm_free(value);
    *size = largest;
    return PLM_OK;
}

/* Median distance of some points to their nearest neighbour. */
static plm_status nearest_distance(const plm_cloud *cloud, double *distance, plm_error *error)
{
    plm_index *index;
    plm_status status = plm_index_build((const float(*)[3])cloud->xyz, cloud->count, &index, error);
    if (status != PLM_OK) return status;
    const size_t step = cloud->count / QUERIES + 1, count = (cloud->count + step - 1) / step;
    float *value = plm_alloc(count, sizeof *value, error);
    if (value) {
        for (size_t i = 0; i < count; i++) {
            float squared[2];
            plm_index_nearest(index, cloud->xyz[i * step], 2, NULL, squared);
            value[i] = sqrtf(squared[1]);
        }
        plm_order_sort(value, count);
        *distance = value[count / 2];
    }
    plm_free(value);
    plm_index_free(index);
    return value ? PLM_OK : PLM_E_MEMORY;
}

plm_status plm_scale_guess(const plm_cloud *cloud, plm_unit_scale *scale, plm_error *error)
{
    if (cloud->count == 0) return plm_fail(error, PLM_E_DEGENERATE, "the cloud has no points");
    double size, distance = 0;
    plm_status status = robust_size(cloud, &size, error);
    if (status == PLM_OK && size > largest_plant) status = nearest_distance(cloud, &distance, error);
    if (status != PLM_OK) return status;
    *scale = (plm_unit_scale){.metres_per_unit = 1, .unit = "m"};
    if (size > largest_plant) {
        scale->is_doubtful = true;
        const bool is_centimetre = distance < finest_millimetres && size * 1e-2 <= largest_plant;
        scale->metres_per_unit = is_centimetre ? 1e-2 : 1e-3;
        scale->unit = is_centimetre ? "cm" : "mm";
        snprintf(
            scale->evidence, sizeof scale->evidence,
            "the cloud measures %.4g units, too much for a plant in metres: taken as %s (%.3g m); --unit or --scale "
            "says otherwise",
            size, scale->unit, size * scale->metres_per_unit);
    } else if (size < smallest_plant) {
        scale->is_doubtful = true;
        snprintf(scale->evidence, sizeof scale->evidence,
                 "the cloud measures %.3g units, little for a plant in metres, as which it is taken; --unit or --scale "
                 "says otherwise",
                 size);
    } else {
        snprintf(scale->evidence, sizeof scale->evidence, "default: %.3g m is a size that plants have", size);
    }
    return PLM_OK;
}

plm_status plm_scale_of_length(const double a[3], const double b[3], double metres, plm_unit_scale *scale,
                               plm_error *error)
{
    const double length = hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
    if (!(metres > 0) || !isfinite(metres))
        return plm_fail(error, PLM_E_ARGUMENT, "the known length is %g m; expected more than 0", metres);
    if (!(length > 0) || !isfinite(length))
        return plm_fail(error, PLM_E_ARGUMENT, "the ends of the known length are %g units apart; expected more than 0",
                        length);
    *scale = (plm_unit_scale){.metres_per_unit = metres / length, .unit = "?"};
    snprintf(scale->evidence, sizeof scale->evidence, "known length: %.6g units are %.6g m", length, metres);
    return PLM_OK;
}

/* The points that ground is looked for in, turned upright: coordinates and colour alone. */
static plm_status upright_copy(const plm_cloud *cloud, plm_up up, plm_cloud *copy, plm_error *error)
{
    plm_status status = plm_cloud_create(cloud->count, cloud->rgb ? PLM_HAS_RGB : 0, copy, error);
    if (status != PLM_OK) return status;
    memcpy(copy->origin, cloud->origin, sizeof copy->origin);
    memcpy(copy->xyz, cloud->xyz, cloud->count * sizeof *cloud->xyz);
    if (cloud->rgb) memcpy(copy->rgb, cloud->rgb, cloud->count * sizeof *cloud->rgb);
    plm_frame frame;
    status = plm_find_up(copy, up, &frame, error);
    if (status == PLM_OK)
        plm_frame_apply(&frame, copy);
    else
        plm_cloud_free(copy);
    return status;
}

plm_status plm_scale_of_pot(const plm_cloud *cloud, plm_up up, double diameter, plm_unit_scale *scale, plm_error *error)
{
    if (!(diameter > 0) || !isfinite(diameter))
        return plm_fail(error, PLM_E_ARGUMENT, "the pot's diameter is %g m; expected more than 0", diameter);
    plm_cloud copy;
    plm_ground ground;
    plm_status status = upright_copy(cloud, up, &copy, error);
    if (status != PLM_OK) return status;
    uint8_t *label = plm_alloc_zero(copy.count, sizeof *label, error);
    status = label ? plm_find_ground(&copy, PLM_GROUND_AUTO, 0, label, &ground, error) : PLM_E_MEMORY;
    plm_free(label);
    plm_cloud_free(&copy);
    if (status != PLM_OK) return status;
    if (!ground.has_pot || !(ground.pot_diameter > 0))
        return plm_fail(error, PLM_E_DEGENERATE,
                        "no pot was found to take the scale from; --scale or --known-length "
                        "gives it in another way");
    *scale = (plm_unit_scale){.metres_per_unit = diameter / ground.pot_diameter, .unit = "?"};
    snprintf(scale->evidence, sizeof scale->evidence, "pot: %.6g units across its rim are %.6g m", ground.pot_diameter,
             diameter);
    return PLM_OK;
}

void plm_cloud_rescale(plm_cloud *cloud, double factor)
{
    if (factor == 1) return;
    for (int axis = 0; axis < 3; axis++) cloud->origin[axis] *= factor;
    for (size_t i = 0; i < cloud->count; i++)
        for (int axis = 0; axis < 3; axis++) cloud->xyz[i][axis] = (float)(cloud->xyz[i][axis] * factor);
    for (size_t i = 0; cloud->extent && i < cloud->count; i++)
        for (int axis = 0; axis < 2; axis++) cloud->extent[i][axis] = (float)(cloud->extent[i][axis] * factor);
}
