/* Longitude and latitude, and UTM, become metres around the plant, and come back. */
#include "support/test.h"

#include "io/io.h"

static plm_cloud make_cloud(const double (*place)[3], size_t count)
{
    plm_error error = {0};
    plm_cloud cloud;
    assert_ok(plm_cloud_create(count, PLM_HAS_NORMAL, &cloud, &error));
    for (int k = 0; k < 3; k++) cloud.origin[k] = place[0][k];
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            cloud.xyz[i][k] = (float)(place[i][k] - place[0][k]);
            cloud.normal[i][k] = k == 1;
        }
    return cloud;
}

static plm_crs crs_of(const char *text)
{
    plm_error error = {0};
    plm_crs crs;
    assert_ok(plm_crs_parse(text, &crs, &error));
    return crs;
}

static void names_of_coordinate_systems_are_read_or_refused(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_crs crs = crs_of("geodetic");
    assert_true(crs.is_geodetic);
    crs = crs_of("utm:32N");
    assert_true(!crs.is_geodetic && crs.utm_zone == 32 && !crs.is_south);
    crs = crs_of("UTM:7s");
    assert_true(crs.utm_zone == 7 && crs.is_south);
    crs = crs_of("utm:60");
    assert_true(crs.utm_zone == 60 && !crs.is_south);
    static const char *const wrong[] = {"",        "utm",     "utm:",  "utm:N",   "utm:0",
                                        "utm:61N", "utm:32Q", "wgs84", "utm:3 2", "utm:-1"};
    for (size_t i = 0; i < COUNT(wrong); i++) {
        assert_int_equal(plm_crs_parse(wrong[i], &crs, &error), PLM_E_ARGUMENT);
        assert_non_null(strstr(error.message, wrong[i]));
        assert_int_equal(crs.utm_zone, 60); /* untouched */
    }
}

/* Metres of a degree on WGS 84 near 50 N: radii of curvature M and N of the ellipsoid. */
static void degrees_become_metres_east_north_and_up(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const double degree = 3.14159265358979323846 / 180, a = 6378137, e2 = 0.0066943799901413165, latitude = 50.7;
    const double s = sin(latitude * degree), w = sqrt(1 - e2 * s * s);
    const double north = degree * (a * (1 - e2) / (w * w * w) + 60),
                 east = degree * (a / w + 60) * cos(latitude * degree);
    const double step = 1e-5;
    const double place[][3] = {
        {7.1, latitude, 60}, {7.1 + step, latitude, 60}, {7.1, latitude + step, 60}, {7.1, latitude, 61}};
    plm_cloud cloud = make_cloud(place, 4);
    plm_georeference reference;
    const plm_crs crs = crs_of("geodetic");
    assert_ok(plm_cloud_georeference(&cloud, &crs, &reference, &error));
    for (int k = 0; k < 3; k++) assert_near(cloud.origin[k], 0, 0);
    const double tolerance = 1e-6; /* offsets of 1 m in float, and the curvature over 1 m */
    assert_near((double)cloud.xyz[1][0] - (double)cloud.xyz[0][0], east * step, tolerance);
    assert_near((double)cloud.xyz[2][1] - (double)cloud.xyz[0][1], north * step, tolerance);
    assert_near((double)cloud.xyz[3][2] - (double)cloud.xyz[0][2], 1, tolerance);
    assert_near(reference.latitude, latitude, step);
    for (int i = 0; i < 4; i++) {
        double local[3], longitude, found, height, file[3];
        for (int k = 0; k < 3; k++) local[k] = (double)cloud.xyz[i][k];
        assert_ok(plm_georeference_locate(&reference, local, &longitude, &found, &height, &error));
        assert_ok(plm_georeference_restore(&reference, local, file, &error));
        assert_near(longitude, place[i][0], 1e-12 * 360); /* 0.4 um */
        assert_near(found, place[i][1], 1e-12 * 360);
        assert_near(height, place[i][2], 1e-6);
        for (int k = 0; k < 3; k++) assert_near(file[k], place[i][k], k < 2 ? 1e-11 : 1e-6);
    }
    plm_cloud_free(&cloud);
}

static void utm_is_scaled_turned_and_restored_in_both_hemispheres(void **unused)
{
    (void)unused;
    plm_error error = {0};
    static const struct {
        const char *crs;
        double easting, northing, scale; /* scale: of the projection there, from its definition */
    } cases[] = {
        {"utm:32N", 500000, 5427032, 0.9996}, {"utm:32S", 500000, 5427032, 0.9996}, {"utm:1N", 500000, 100, 0.9996}};
    for (size_t c = 0; c < COUNT(cases); c++) {
        const double place[][3] = {{cases[c].easting, cases[c].northing, 318},
                                   {cases[c].easting + 1, cases[c].northing, 318},
                                   {cases[c].easting, cases[c].northing + 1, 318},
                                   {cases[c].easting, cases[c].northing, 319}};
        plm_cloud cloud = make_cloud(place, 4);
        plm_georeference reference;
        const plm_crs crs = crs_of(cases[c].crs);
        assert_ok(plm_cloud_georeference(&cloud, &crs, &reference, &error));
        const double metre = (1 + 318 / 6.37e6) / cases[c].scale; /* a metre of the grid, 318 m above the ellipsoid */
        assert_near((double)cloud.xyz[1][0] - (double)cloud.xyz[0][0], metre, 2e-6);
        assert_near((double)cloud.xyz[2][1] - (double)cloud.xyz[0][1], metre, 2e-6);
        assert_near((double)cloud.xyz[3][2] - (double)cloud.xyz[0][2], 1, 1e-6);
        assert_near((double)cloud.normal[0][1], 1, 1e-6);
        for (int i = 0; i < 4; i++) {
            double local[3], file[3];
            for (int k = 0; k < 3; k++) local[k] = (double)cloud.xyz[i][k];
            assert_ok(plm_georeference_restore(&reference, local, file, &error));
            for (int k = 0; k < 3; k++) assert_near(file[k], place[i][k], 1e-6);
        }
        plm_cloud_free(&cloud);
    }
}

/* Off the central meridian, grid north is not north: normals turn with the points. */
static void normals_turn_by_the_meridian_convergence(void **unused)
{
    (void)unused;
    plm_error error = {0};
    const double place[][3] = {{700000, 5400000, 0}, {700000, 5400001, 0}};
    plm_cloud cloud = make_cloud(place, 2);
    plm_georeference reference;
    const plm_crs crs = crs_of("utm:32N");
    assert_ok(plm_cloud_georeference(&cloud, &crs, &reference, &error));
    const double x = (double)cloud.xyz[1][0] - (double)cloud.xyz[0][0],
                 y = (double)cloud.xyz[1][1] - (double)cloud.xyz[0][1];
    assert_true(fabs(atan2(x, y)) > 0.03); /* about 2 degrees there */
    assert_near(atan2((double)cloud.normal[0][0], (double)cloud.normal[0][1]), atan2(x, y), 1e-6);
    plm_cloud_free(&cloud);
}

static void date_line_and_poles_do_not_tear_a_cloud_apart(void **unused)
{
    (void)unused;
    plm_error error = {0};
    static const double places[][2][3] = {{{179.99999, 10, 0}, {180.00001, 10, 0}},
                                          {{0, 89.99999, 0}, {180, 89.99999, 0}},
                                          {{12, -90, 0}, {200, -89.99999, 0}}};
    const double degree = 3.14159265358979323846 / 180;
    const double far[] = {2e-5 * degree * 6378137 * cos(10 * degree), 2e-5 * degree * 6399594, 1e-5 * degree * 6399594};
    for (size_t c = 0; c < COUNT(places); c++) {
        plm_cloud cloud = make_cloud(places[c], 2);
        plm_georeference reference;
        const plm_crs crs = crs_of("geodetic");
        assert_ok(plm_cloud_georeference(&cloud, &crs, &reference, &error));
        double squared = 0;
        for (int k = 0; k < 3; k++) {
            const double step = (double)cloud.xyz[1][k] - (double)cloud.xyz[0][k];
            squared += step * step;
        }
        assert_near(sqrt(squared), far[c], 0.01 * far[c]);
        plm_cloud_free(&cloud);
    }
}

static void coordinates_that_cannot_be_are_refused_with_the_point(void **unused)
{
    (void)unused;
    plm_error error = {0};
    static const struct {
        const char *crs, *message;
        double place[2][3];
    } cases[] = {
        {"geodetic", "point 2: longitude 478751 and latitude 5427032", {{7, 50, 0}, {478751, 5427032, 0}}},
        {"geodetic", "point 1: longitude 50 and latitude 95", {{50, 95, 0}, {7, 50, 0}}},
        {"geodetic", "both sides of the date line", {{179.99999, 10, 0}, {-179.99999, 10, 0}}},
        {"utm:32N", "point 1: easting -0.1 and northing 0.2", {{-0.1, 0.2, 0}, {0, 0, 0}}},
        {"utm:32N", "point 2: easting 478751 and northing 10000001", {{478751, 5427032, 0}, {478751, 10000001, 0}}},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        plm_cloud cloud = make_cloud(cases[i].place, 2);
        const float x = cloud.xyz[1][0];
        plm_georeference reference;
        const plm_crs crs = crs_of(cases[i].crs);
        assert_int_equal(plm_cloud_georeference(&cloud, &crs, &reference, &error), PLM_E_ARGUMENT);
        assert_non_null(strstr(error.message, cases[i].message));
        assert_true(cloud.xyz[1][0] == x); /* unchanged */
        plm_cloud_free(&cloud);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_of_coordinate_systems_are_read_or_refused),
        cmocka_unit_test(degrees_become_metres_east_north_and_up),
        cmocka_unit_test(utm_is_scaled_turned_and_restored_in_both_hemispheres),
        cmocka_unit_test(normals_turn_by_the_meridian_convergence),
        cmocka_unit_test(date_line_and_poles_do_not_tear_a_cloud_apart),
        cmocka_unit_test(coordinates_that_cannot_be_are_refused_with_the_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
