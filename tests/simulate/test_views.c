/* Views written as files: depth, put back through the pose of its file, lies on the plant's faces but for the noise that was asked for. */
#include "support/test.h"

#include <jansson.h>
#include <png.h>

#include "cloud/linear.h"
#include "simulate/simulate.h"

enum { WIDTH = 320, HEIGHT = 180, VIEWS = 4 };

static const double noise = 3e-4;

/* The pixels of a PNG of this size, 16 bits each. */
static void read_depth(const char *path, uint16_t pixel[HEIGHT][WIDTH])
{
    FILE *file = fopen(path, "rb");
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    assert_non_null(file);
    assert_int_equal(setjmp(png_jmpbuf(png)), 0);
    png_init_io(png, file);
    png_read_info(png, info);
    assert_int_equal(png_get_image_width(png, info), WIDTH);
    assert_int_equal(png_get_image_height(png, info), HEIGHT);
    assert_int_equal(png_get_bit_depth(png, info), 16);
    assert_int_equal(png_get_channels(png, info), 1);
    for (int row = 0; row < HEIGHT; row++) {
        unsigned char bytes[2 * WIDTH];
        png_read_row(png, bytes, NULL);
        for (int k = 0; k < WIDTH; k++) pixel[row][k] = (uint16_t)(bytes[2 * k] << 8 | bytes[2 * k + 1]);
    }
    png_destroy_read_struct(&png, &info, NULL);
    fclose(file);
}

static double number_at(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    assert_true(json_is_number(value));
    return json_number_value(value);
}

/* Distance of a point from a triangle (Ericson, Real-Time Collision Detection, 2005, 5.1.5). */
static double distance_to(const double p[3], const double a[3], const double b[3], const double c[3])
{
    double ab[3], ac[3], n[3], ap[3], best = INFINITY;
    for (int i = 0; i < 3; i++) {
        ab[i] = b[i] - a[i];
        ac[i] = c[i] - a[i];
        ap[i] = p[i] - a[i];
    }
    plm_cross(ab, ac, n);
    const double square = plm_dot(n, n);
    if (square > 0) { /* inside: barycentric weights of the foot */
        double q[3];
        plm_cross(ap, ac, q);
        const double v = plm_dot(q, n) / square;
        plm_cross(ab, ap, q);
        const double w = plm_dot(q, n) / square;
        if (v >= 0 && w >= 0 && v + w <= 1) return fabs(plm_dot(ap, n)) / sqrt(square);
    }
    const double *const end[3][2] = {{a, b}, {b, c}, {c, a}};
    for (int k = 0; k < 3; k++) {
        double along[3], gap[3], from[3];
        for (int i = 0; i < 3; i++) {
            along[i] = end[k][1][i] - end[k][0][i];
            from[i] = p[i] - end[k][0][i];
        }
        const double length = plm_dot(along, along);
        const double t = length > 0 ? fmin(fmax(plm_dot(from, along) / length, 0), 1) : 0;
        for (int i = 0; i < 3; i++) gap[i] = from[i] - t * along[i];
        best = fmin(best, plm_norm(gap));
    }
    return best;
}

static double distance_from_mesh(const plm_mesh *mesh, const double point[3])
{
    double best = INFINITY;
    for (size_t f = 0; f < mesh->triangle_count; f++) {
        const uint32_t *t = mesh->triangle[f];
        best = fmin(best, distance_to(point, mesh->vertex[t[0]], mesh->vertex[t[1]], mesh->vertex[t[2]]));
    }
    return best;
}

/* Share of some pixels of all views that lie within `most` of the faces, by the pose of that name. */
static double share_near(const char *folder, const plm_mesh *mesh, const char *pose_name, double most)
{
    size_t near = 0, count = 0;
    for (int view = 0; view < VIEWS; view++) {
        static uint16_t pixel[HEIGHT][WIDTH];
        char path[8300];
        json_error_t trouble;
        snprintf(path, sizeof path, "%s/view_%02d.depth.png", folder, view);
        read_depth(path, pixel);
        snprintf(path, sizeof path, "%s/view_%02d.json", folder, view);
        json_t *root = json_load_file(path, 0, &trouble);
        const json_t *lens = json_object_get(root, "intrinsics"), *pose = json_object_get(root, pose_name);
        const double unit = number_at(root, "depth_metres_per_unit");
        for (int k = view; k < WIDTH * HEIGHT; k += 3) { /* a sample */
            const int row = k / WIDTH, column = k % WIDTH;
            const double depth = unit * pixel[row][column];
            if (!(depth > 0)) continue;
            const double x[4] = {(column + 0.5 - number_at(lens, "cx")) / number_at(lens, "fx") * depth,
                                 (row + 0.5 - number_at(lens, "cy")) / number_at(lens, "fy") * depth, depth, 1};
            double point[3] = {0, 0, 0};
            for (size_t i = 0; i < 3; i++)
                for (size_t j = 0; j < 4; j++)
                    point[i] += json_number_value(json_array_get(json_array_get(pose, i), j)) * x[j];
            near += distance_from_mesh(mesh, point) <= most;
            count++;
        }
        json_decref(root);
    }
    assert_true(count > 300);
    return (double)near / (double)count;
}

static plm_scan_options camera(const char *folder)
{
    return (plm_scan_options){.scanner = PLM_SCANNER_RGBD,
                              .seed = 5,
                              .noise = noise,
                              .views = VIEWS,
                              .distance = 0.4,
                              .image_width = WIDTH,
                              .misplacement = -1,
                              .misrotation = -1,
                              .thin_stem = -1,
                              .views_folder = folder};
}

static void depth_goes_back_onto_the_plant(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    char *folder = test_make_folder(), views[8192];
    snprintf(views, sizeof views, "%s/a/views", folder);
    assert_ok(plm_plant_grow("pepper", &(plm_plant_options){.seed = 5, .resolution = 0.15}, &plant, &error));
    const plm_scan_options options = camera(views);
    assert_ok(plm_scan_plant(&plant, &options, &scan, &error));
    plm_scan_free(&scan);
    /* noise goes with the square of range, which is at most 0.5 m here; mixed pixels at the rims lie behind the plant: in images as
     * small as this a third of the plant is rim, and less than a fourth of that is mixed */
    const double near = 4 * noise * (0.5 / 0.4) * (0.5 / 0.4);
    assert_true(share_near(views, &plant.mesh, "camera_to_world", near) > 0.88);
    assert_true(share_near(views, &plant.mesh, "camera_to_world", 0.2 * noise) < 0.4); /* the noise is there */
    test_remove_folder(folder);
    plm_virtual_plant_free(&plant);
}

static void a_wrong_axis_moves_the_views_but_for_the_first_and_the_true_pose_stays(void **state)
{
    (void)state;
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    char *folder = test_make_folder(), path[8300];
    assert_ok(plm_plant_grow("pepper", &(plm_plant_options){.seed = 5, .resolution = 0.15}, &plant, &error));
    plm_scan_options options = camera(folder);
    options.axis_tilt = plm_radians(3);
    options.axis_shift = 0.004;
    assert_ok(plm_scan_plant(&plant, &options, &scan, &error));
    plm_scan_free(&scan);
    const double near = 4 * noise * (0.5 / 0.4) * (0.5 / 0.4);
    assert_true(share_near(folder, &plant.mesh, "true_camera_to_world", near) > 0.88);
    assert_true(share_near(folder, &plant.mesh, "camera_to_world", near) < 0.7);
    for (int view = 0; view < 2; view++) { /* a turn by nothing is right about any axis */
        json_error_t trouble;
        snprintf(path, sizeof path, "%s/view_%02d.json", folder, view);
        json_t *root = json_load_file(path, 0, &trouble);
        const json_t *pose = json_object_get(root, "camera_to_world"),
                     *truth = json_object_get(root, "true_camera_to_world");
        double most = 0;
        for (size_t i = 0; i < 3; i++)
            for (size_t j = 0; j < 4; j++)
                most = fmax(most, fabs(json_number_value(json_array_get(json_array_get(pose, i), j)) -
                                       json_number_value(json_array_get(json_array_get(truth, i), j))));
        if (view)
            assert_true(most > 0.01);
        else
            assert_true(most < 1e-9);
        json_decref(root);
    }
    test_remove_folder(folder);
    plm_virtual_plant_free(&plant);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(depth_goes_back_onto_the_plant),
        cmocka_unit_test(a_wrong_axis_moves_the_views_but_for_the_first_and_the_true_pose_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
