/* traits/soil_base.c: where a stem comes out of soil, the plant's lowest surface is the soil's height there, whatever labels, given or
 * found, call the stem's end. The border between the two is drawn in their noise: it leaves some of the stem to the soil, or some of
 * the soil to the plant, several millimetres of a large plant. The soil about the foot is wide, and its height there is known to a
 * fraction of the noise. */
#include "traits/soil_base.h"

#include "cloud/order.h"

#include <math.h>
#include <stdlib.h>

/* Shares of the plant's height. */
static const double foot_share = 0.03;  /* over the soil, and near_share more: points so low are the foot, ... */
static const double widest_foot = 0.04; /* ... where half of them lie within so much of its middle */
static const double near_share = 0.015; /* from the base to the soil, at most, and so many times the noise: */
static const double near_noise = 4;
static const double reach_share = 0.1; /* soil that is asked, ... */
static const double clear_of_foot = 2; /* ... from so many widths of the foot on: nearer ones have the border's bias */
/* Parts of the soil's own scatter, and of the foot's width, by which the soil is told wrong: it is no plane, and a stem that
 * leans is cut aslant. */
static const double uneven = 0.25, aslant = 0.1;
enum { FEWEST_FOOT = 5, FEWEST_SOIL = 12, MOST_SOIL = 100 };

/** The plant's foot, seen from above: its middle, and within how far of it half of its points lie. */
typedef struct foot_print {
    double middle[2], width;
} foot_print;

/* false: the plant has hardly a point between the heights, or what it has is not narrow. value: room for all of its points. */
static bool find_foot(const plm_scene *scene, double low, double high, double widest, double *value, foot_print *foot)
{
    size_t count = 0;
    for (int k = 0; k < 3; k++) {
        count = 0;
        for (size_t i = 0; i < scene->plant_count; i++) {
            const float *p = scene->plant[i];
            if (!(p[2] > low && p[2] < high)) continue;
            value[count++] = k < 2 ? (double)p[k] : hypot(p[0] - foot->middle[0], p[1] - foot->middle[1]);
        }
        if (count < FEWEST_FOOT) return false;
        const double median = plm_order_median(value, count);
        if (k < 2)
            foot->middle[k] = median;
        else
            foot->width = median;
    }
    return foot->width < widest;
}

/** A point of the soil. */
typedef struct soil_point {
    double off, height;
} soil_point;

static int nearer(const void *a, const void *b)
{
    const soil_point *p = a, *q = b;
    if (p->off != q->off) return p->off < q->off ? -1 : 1;
    return (p->height > q->height) - (p->height < q->height);
}

/* The soil nearest to the foot, at the front of point (room for all of the cloud's): ground between two heights, as walls, rims and what
 * lies below a pot are ground too. Gives the number of its points. */
static size_t soil_about(const plm_scene *scene, const foot_print *foot, double low, double high, double reach,
                         soil_point *point)
{
    const plm_cloud *cloud = scene->cloud;
    size_t count = 0;
    for (size_t i = 0; i < cloud->count; i++) {
        const double z = cloud->xyz[i][2];
        if (scene->ground_label[i] != PLM_LABEL_GROUND || !(z > low && z < high)) continue;
        const double off = hypot(cloud->xyz[i][0] - foot->middle[0], cloud->xyz[i][1] - foot->middle[1]);
        if (off > clear_of_foot * foot->width && off < reach) point[count++] = (soil_point){off, z};
    }
    qsort(point, count, sizeof *point, nearer);
    return count < MOST_SOIL ? count : MOST_SOIL;
}

/* Height of the soil that the points show, and its standard error. */
static double height_of_soil(const soil_point *point, size_t count, const foot_print *foot, double *value,
                             double *std_error)
{
    for (size_t i = 0; i < count; i++) value[i] = point[i].height;
    const double soil = plm_order_median(value, count);
    for (size_t i = 0; i < count; i++) value[i] = point[i].height;
    const double scatter = plm_order_robust_sd(value, count, soil);
    *std_error = hypot(scatter * sqrt(acos(-1) / 2 / (double)count + uneven * uneven), aslant * foot->width);
    return soil;
}

/* How far from the ground's plane its points lie, and a foot at the most. */
static double tolerance_of(double height, double noise)
{
    return near_share * height + near_noise * noise;
}

static bool has_soil(const plm_scene *scene)
{
    return scene->ground_label && scene->ground->found && scene->options->ground != PLM_GROUND_HEIGHT;
}

static double plane_of(const plm_scene *scene)
{
    return scene->ground->soil_height - scene->cloud->origin[2];
}

/* NAN where hardly a point of the ground is near. soil and value: room for all of the cloud's points. */
static double soil_at(const plm_scene *scene, const foot_print *foot, double tolerance, double reach, soil_point *soil,
                      double *value, double *std_error)
{
    const double plane = plane_of(scene);
    const size_t count = soil_about(scene, foot, plane - tolerance, plane + tolerance, reach, soil);
    return count < FEWEST_SOIL ? NAN : height_of_soil(soil, count, foot, value, std_error);
}

plm_status plm_soil_height(const plm_scene *scene, const double place[2], double width, double reach, double height,
                           double noise, double *soil, double *std_error, bool *told, plm_error *error)
{
    *told = false;
    if (!has_soil(scene)) return PLM_OK;
    soil_point *point = plm_alloc(scene->cloud->count, sizeof *point, error);
    double *value = plm_alloc(scene->cloud->count, sizeof *value, error);
    const plm_status status = point && value ? PLM_OK : PLM_E_MEMORY;
    const foot_print foot = {{place[0], place[1]}, width};
    if (status == PLM_OK) {
        *soil = soil_at(scene, &foot, tolerance_of(height, noise), reach, point, value, std_error);
        *told = !isnan(*soil);
    }
    plm_free(point);
    plm_free(value);
    return status;
}

plm_status plm_soil_base(const plm_scene *scene, double height, plm_extreme *base, bool *changed, plm_error *error)
{
    *changed = false;
    if (!has_soil(scene)) return PLM_OK;
    const double plane = plane_of(scene), tolerance = tolerance_of(height, base->sampling.noise);
    soil_point *soil = plm_alloc(scene->cloud->count, sizeof *soil, error);
    double *value = plm_alloc(scene->cloud->count, sizeof *value, error);
    const plm_status status = soil && value ? PLM_OK : PLM_E_MEMORY;
    foot_print foot = {.width = 0};
    if (status == PLM_OK && find_foot(scene, plane - tolerance, plane + tolerance + foot_share * height,
                                      widest_foot * height, value, &foot)) {
        double std_error = NAN;
        const double told = soil_at(scene, &foot, tolerance, reach_share * height, soil, value, &std_error);
        *changed = fabs(-base->value - told) < tolerance;
        if (*changed) base->value = -told, base->std_error = std_error;
    }
    plm_free(soil);
    plm_free(value);
    return status;
}
