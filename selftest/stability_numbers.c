/* selftest/stability_numbers.c: numbers that files hold: NaN, Inf, denormals, the limits of float, coordinates far from
 * the origin; through the reader, as a user's file would come. */
#include "cloud/linear.h"
#include "io/io.h"
#include "selftest/checks.h"

#include <float.h>
#include <stdio.h>

enum { EDGE = 12, LINE = 100 };

/* The faces of a cube of edge 0.11 as grids of 12^2 points, as text, each coordinate times unit and beside offset; then
 * the lines of trouble. */
static char *cube_text(plm_checker *checker, double unit, double offset, const char *trouble, size_t *length)
{
    const size_t room = (size_t)(EDGE * EDGE * EDGE + 8) * LINE;
    char *text = plm_alloc(room, 1, checker->error);
    *length = 0;
    if (!text) {
        checker->status = PLM_E_MEMORY;
        return NULL;
    }
    for (int i = 0; i < EDGE * EDGE * EDGE; i++) {
        const int at[3] = {i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE};
        if (at[0] % (EDGE - 1) && at[1] % (EDGE - 1) && at[2] % (EDGE - 1)) continue; /* inside */
        *length += (size_t)snprintf(text + *length, LINE, "%.17g %.17g %.17g\n", offset + unit * 0.01 * at[0],
                                    unit * 0.01 * at[1] - offset, offset + unit * 0.01 * at[2]);
    }
    *length += (size_t)snprintf(text + *length, room - *length, "%s", trouble);
    return text;
}

static void through_the_reader(plm_checker *checker, double unit, double offset, const char *trouble, plm_bound bound)
{
    plm_error why = {0};
    plm_cloud cloud;
    plm_measurement plant;
    size_t length;
    if (checker->status != PLM_OK) return;
    char *text = cube_text(checker, unit, offset, trouble, &length);
    if (!text) return;
    const plm_status status = plm_cloud_parse(text, length, "cube", NULL, &cloud, NULL, &why);
    plm_free(text);
    if (!plm_check_ran(checker, "reading", status, &why)) return;
    double volume = NAN, area;
    if (plm_check_ran(checker, "hull",
                      plm_convex_hull((const float(*)[3])cloud.xyz, cloud.count, &volume, &area, NULL, &why), &why))
        plm_check_value(checker, "hull volume", volume, pow(unit * 0.01 * (EDGE - 1), 3), bound);
    if (plm_check_measure(checker, &cloud, NULL, &plant)) {
        plm_check_trait(checker, &plant, "bounding_box_z", -1, unit * 0.01 * (EDGE - 1),
                        (plm_bound){.error = fmax(0.2, bound.error), .condition = NAN, .note = "a spacing at each end"},
                        false);
        plm_measurement_free(&plant);
    }
}

/* A cloud that a program hands over, not a file: a number that is none must be refused, whatever is asked for. */
static void handed_over(plm_checker *checker, float bad)
{
    plm_maker maker;
    plm_measurement plant;
    plm_error why = {0};
    const double begin[3] = {0}, end[3] = {0, 0, 0.1};
    plm_maker_start(&maker, checker, 500, 9);
    plm_maker_tube(&maker, begin, end, 0.003, 2 * PLM_PI, 500, 0, PLM_LABEL_STEM, 0);
    plm_maker_unlabel(&maker);
    if (checker->status != PLM_OK) {
        plm_cloud_free(&maker.cloud);
        return;
    }
    maker.cloud.xyz[250][1] = bad;
    plm_measure_options options;
    plm_measure_defaults(&options);
    const plm_status status = plm_measure(&maker.cloud, &options, &plant, &why);
    plm_check_refused(checker, "all values", status, &why);
    if (status == PLM_OK) plm_measurement_free(&plant);
}

void plm_stability_numbers(plm_checker *checker)
{
    const plm_bound of_float = {.error = 12 * FLT_EPSILON, .condition = 3, .note = "float offsets, three factors"};
    plm_check_scene(checker, "file with NaN, Inf and 1e300");
    through_the_reader(checker, 1, 0, "nan 0 0\n0 inf 0\n0 0 -inf\n1e300 0 0\n0 -1e39 0\n", of_float);
    plm_check_scene(checker, "file with denormal numbers");
    through_the_reader(checker, 1, 0, "1e-42 0 0\n0 4e-320 0\n0 0 -1e-45\n1e-310 1e-310 1e-310\n", of_float);
    for (int digits = -6; digits <= 6; digits += 3) {
        plm_check_scene(checker, "cube in units of 1e%d", digits);
        through_the_reader(checker, pow(10, digits), 0, "", of_float);
    }
    for (int digits = 3; digits <= 9; digits += 3) {
        const double offset = pow(10, digits), condition = 3 * 2 * offset / 0.11;
        plm_check_scene(checker, "cube of 0.11 m, 1e%d m away", digits);
        through_the_reader(checker, 1, offset, "",
                           (plm_bound){.error = 12 * FLT_EPSILON + DBL_EPSILON * condition,
                                       .condition = condition,
                                       .note = "float offsets, and a double's step so far away"});
    }
    plm_check_scene(checker, "cube in units of 1e18, the largest read");
    through_the_reader(checker, 1e18, 0, "", of_float);
    plm_check_scene(checker, "cube in units of 1e-18");
    through_the_reader(checker, 1e-18, 0, "", of_float);
    static const struct {
        const char *name;
        float value;
    } bad[] = {{"NaN", NAN}, {"Inf", INFINITY}, {"-Inf", -INFINITY}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        plm_check_scene(checker, "a coordinate handed over is %s", bad[i].name);
        handed_over(checker, bad[i].value);
    }
}
