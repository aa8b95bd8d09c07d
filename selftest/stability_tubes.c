/* selftest/stability_tubes.c: stems seen over 10 to 360 degrees of their circumference, in noise of up to 0.3 of the
 * radius, along and across zenith, and shorter than wide.
 *
 * The condition is that of the circle's normal matrix; the bound of a seen arc is four standard errors at the Cramer-Rao
 * limit, which no method can be better than, and a part of the radius for the bias that noise brings. */
#include "cloud/linear.h"
#include "selftest/checks.h"

#include <stdio.h>

enum { POINTS = 2000 };

static const double radius = 0.003;

/* Standard error of the radius in noise of one radius, by the inverse of the normal matrix of (cos a, sin a, 1) over the
 * arc, for one point; and its condition. */
static double arc_error(double arc, double *condition)
{
    const double c1 = sin(arc) / arc, s1 = (1 - cos(arc)) / arc;                     /* means of cos and sin */
    const double c2 = sin(2 * arc) / (2 * arc), s2 = (1 - cos(2 * arc)) / (2 * arc); /* of cos 2a and sin 2a */
    const double m[6] = {0.5 * (1 + c2), 0.5 * s2, c1, 0.5 * (1 - c2), s1, 1};
    double value[3], vector[3][3], variance = 0;
    plm_eigen3(m, value, vector);
    for (int i = 0; i < 3; i++) variance += vector[i][2] * vector[i][2] / value[i];
    *condition = value[0] / value[2];
    return sqrt(variance);
}

static void check_stem(plm_checker *checker, const double along[3], double length, double arc, double noise)
{
    plm_maker maker;
    plm_measurement plant;
    const double begin[3] = {0, 0, 0}, end[3] = {length * along[0], length * along[1], length * along[2]};
    double condition;
    plm_maker_start(&maker, checker, POINTS, 3);
    plm_maker_tube(&maker, begin, end, radius, arc, POINTS, noise * radius, PLM_LABEL_STEM, 0);
    const double expected = noise * arc_error(arc, &condition) / sqrt(POINTS * fmin(1, 0.012 / length));
    if (!plm_check_measure(checker, &maker.cloud, "stem_diameter,stem_inclination", &plant)) return;
    /* A stem that is shorter than the height at which it is measured, or seen so narrowly that its radius may as well be
     * half or double, need not have a diameter. */
    const bool must = length >= 0.04 && expected < 0.05;
    plm_bound bound = {.error = 4 * expected + 0.02, .condition = condition, .note = "4 Cramer-Rao errors and 2 %"};
    if (!must) bound = (plm_bound){.error = -4, .condition = condition, .note = "4 of its own standard errors"};
    plm_check_trait(checker, &plant, "stem_diameter", 0, 2 * radius, bound, must);
    const double inclination = atan2(hypot(along[0], along[1]), fabs(along[2])); /* the lower end is the base */
    plm_check_trait(
        checker, &plant, "stem_inclination", 0, inclination,
        (plm_bound){
            .error = 0.05 * radius / 0.003 * fmax(1, 0.04 / length), .condition = 1, .scale = 1, .note = "radians"},
        length >= 0.012);
    plm_measurement_free(&plant);
}

void plm_stability_tubes(plm_checker *checker)
{
    static const double arcs[] = {10, 20, 45, 90, 180, 270, 360}, noises[] = {0, 0.001, 0.01, 0.1, 0.3};
    static const double up[3] = {0, 0, 1}, across[3] = {1, 0, 0}, down[3] = {0, 0, -1};
    for (size_t a = 0; a < sizeof arcs / sizeof *arcs; a++)
        for (size_t n = 0; n < sizeof noises / sizeof *noises; n++) {
            plm_check_scene(checker, "stem, arc of %g deg, noise %g radii", arcs[a], noises[n]);
            check_stem(checker, up, 0.06, plm_radians(arcs[a]), noises[n]);
        }
    plm_check_scene(checker, "stem exactly across zenith");
    check_stem(checker, across, 0.06, 2 * PLM_PI, 0.01);
    plm_check_scene(checker, "stem exactly down");
    check_stem(checker, down, 0.06, 2 * PLM_PI, 0.01);
    static const double lengths[] = {0.5, 1, 2, 4};
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        plm_check_scene(checker, "stem of %g radii in length", lengths[i]);
        check_stem(checker, up, lengths[i] * radius, 2 * PLM_PI, 0.01);
    }
}
