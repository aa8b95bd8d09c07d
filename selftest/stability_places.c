/* selftest/stability_places.c: coordinates on the earth: at the poles, across the date line, along a central meridian. A
 * square of 2 m must come out as one, and go back to where it was.
 *
 * Closed forms on WGS 84 (a = 6378137 m, f = 1 / 298.257223563): a step of longitude at the equator is a radians of it; a
 * step of latitude b^2 / a there and a^2 / b at the poles; on the central meridian a metre of UTM is 1 / 0.9996 m. */
#include "cloud/linear.h"
#include "io/io.h"
#include "selftest/checks.h"

#include <stdio.h>

static const double a = 6378137, flattening = 1 / 298.257223563;

/* Cloud of the corners of a square about (x, y), steps dx and dy to each side. */
static void square(plm_cloud *cloud, const double at[3], double dx, double dy)
{
    for (int k = 0; k < 3; k++) cloud->origin[k] = at[k];
    for (int i = 0; i < 4; i++) {
        cloud->xyz[i][0] = (float)(i & 1 ? dx : -dx);
        cloud->xyz[i][1] = (float)(i & 2 ? dy : -dy);
        cloud->xyz[i][2] = 0;
    }
}

static double side(const plm_cloud *cloud, int i, int j)
{
    double gap[3];
    for (int k = 0; k < 3; k++) gap[k] = (double)cloud->xyz[i][k] - (double)cloud->xyz[j][k];
    return plm_norm(gap);
}

typedef struct place {
    plm_cloud cloud; /* the square, where status is PLM_OK georeferenced */
    plm_georeference reference;
    plm_status status;
    plm_error why;
} place;

/* False where there is nothing to check (and nothing to free). */
static bool put_square(plm_checker *checker, const char *crs_text, const double at[3], double dx, double dy, place *p)
{
    plm_crs crs;
    *p = (place){0};
    if (checker->status == PLM_OK) checker->status = plm_cloud_create(4, 0, &p->cloud, checker->error);
    if (checker->status != PLM_OK) return false;
    square(&p->cloud, at, dx, dy);
    p->status = plm_crs_parse(crs_text, &crs, &p->why);
    if (p->status == PLM_OK) p->status = plm_cloud_georeference(&p->cloud, &crs, &p->reference, &p->why);
    return true;
}

/* A step in the file's numbers is rounded to float (2^-24 of it), and there is the double's step at the origin. */
static void check_square(plm_checker *checker, const char *crs_text, const double at[3], double dx, double dy,
                         double width, double height, double bound)
{
    place p;
    if (!put_square(checker, crs_text, at, dx, dy, &p)) return;
    if (plm_check_ran(checker, "georeference", p.status, &p.why)) {
        const plm_bound held = {.error = bound, .condition = 1, .note = "float steps in the file and in the result"};
        plm_check_value(checker, "width of the square", side(&p.cloud, 0, 1), width, held);
        plm_check_value(checker, "height of the square", side(&p.cloud, 0, 2), height, held);
        for (int i = 0; i < 4 && checker->status == PLM_OK; i += 3) {
            const double local[3] = {p.cloud.xyz[i][0], p.cloud.xyz[i][1], p.cloud.xyz[i][2]};
            double back[3] = {NAN, NAN, NAN};
            const plm_status status = plm_georeference_restore(&p.reference, local, back, &p.why);
            if (!plm_check_ran(checker, "way back", status, &p.why)) break;
            const double in_file = (float)(i & 2 ? dy : -dy);
            plm_check_value(checker, "way back, northing or latitude", back[1] - at[1] - in_file, 0,
                            (plm_bound){.error = 4 * bound, .condition = 1, .scale = dy});
        }
    }
    plm_cloud_free(&p.cloud);
}

/* The ring round a pole: longitudes mean nothing there, distances do. */
static void pole(plm_checker *checker, double latitude)
{
    plm_error why = {0};
    plm_cloud cloud;
    const plm_crs crs = {.is_geodetic = true};
    plm_georeference reference;
    const double step = 2.0 / (a / (1 - flattening)) * 180 / PLM_PI; /* 2 m of latitude at the pole: a^2 / b a radian */
    if (checker->status != PLM_OK) return;
    checker->status = plm_cloud_create(4, 0, &cloud, checker->error);
    if (checker->status != PLM_OK) return;
    cloud.origin[0] = 0;
    cloud.origin[1] = latitude;
    for (int i = 0; i < 4; i++) {
        cloud.xyz[i][0] = (float)(90 * i - 180);
        cloud.xyz[i][1] = (float)(latitude > 0 ? -step : step);
        cloud.xyz[i][2] = 0;
    }
    const plm_status status = plm_cloud_georeference(&cloud, &crs, &reference, &why);
    if (plm_check_ran(checker, "georeference", status, &why)) {
        const plm_bound held = {.error = 2e-6, .condition = 1, .note = "a double's step of latitude, 1.6 nm at 90 deg"};
        plm_check_value(checker, "across the pole", side(&cloud, 0, 2), 4, held);
        plm_check_value(checker, "a quarter round the pole", side(&cloud, 0, 1), 2 * sqrt(2), held);
    }
    plm_cloud_free(&cloud);
}

/* Longitudes that jump from 180 to -180 are 360 degrees apart: float offsets cannot hold them, and that is said. */
static void jump(plm_checker *checker)
{
    place p;
    const double at[3] = {0, 10, 0};
    if (!put_square(checker, "geodetic", at, 179.99999, 1e-5, &p)) return;
    plm_check_refused(checker, "georeference", p.status, &p.why);
    plm_cloud_free(&p.cloud);
}

/* Beyond 84 degrees there is no UTM. */
static void beyond_utm(plm_checker *checker, const char *crs_text, double northing)
{
    place p;
    const double at[3] = {500000, northing, 0};
    if (!put_square(checker, crs_text, at, 1, 1, &p)) return;
    plm_check_refused(checker, "georeference", p.status, &p.why);
    plm_cloud_free(&p.cloud);
}

void plm_stability_places(plm_checker *checker)
{
    const double b = a * (1 - flattening), degree = PLM_PI / 180, metre = 1 / (degree * a);
    static const double meridian[] = {1e-6, 4e6, 9.3e6};
    const double equator[3] = {10, 0, 100}, date_line[3] = {180, 0, 0};
    plm_check_scene(checker, "geodetic, on the equator");
    /* at 100 m height circles are larger by 100 m over their radius */
    check_square(checker, "geodetic", equator, metre, metre, 2 * (a + 100) / a, 2 * (b * b / a + 100) / a, 1e-6);
    plm_check_scene(checker, "geodetic, across the date line");
    check_square(checker, "geodetic", date_line, metre, metre, 2, 2 * b * b / a / a, 1e-6);
    plm_check_scene(checker, "geodetic, date line crossed by a jump");
    jump(checker);
    plm_check_scene(checker, "geodetic, round the north pole");
    pole(checker, 90);
    plm_check_scene(checker, "geodetic, round the south pole");
    pole(checker, -90);
    for (size_t i = 0; i < sizeof meridian / sizeof *meridian; i++) {
        const double north[3] = {500000, meridian[i] + 2, 0},
                     south[3] = {500000, 1e7 - fmin(meridian[i], 9.0e6) - 2, 0};
        plm_check_scene(checker, "UTM, central meridian, %.0f km north", meridian[i] / 1000);
        check_square(checker, "utm:33N", north, 1, 1, 2 / 0.9996, 2 / 0.9996, 1e-6);
        plm_check_scene(checker, "UTM, central meridian, %.0f km south", meridian[i] / 1000);
        check_square(checker, "utm:60S", south, 1, 1, 2 / 0.9996, 2 / 0.9996, 1e-6);
    }
    plm_check_scene(checker, "UTM, at the north pole");
    beyond_utm(checker, "utm:33N", 9997964.943);
    plm_check_scene(checker, "UTM, at the south pole");
    beyond_utm(checker, "utm:33S", 2035.057);
}
