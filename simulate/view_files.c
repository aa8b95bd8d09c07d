/* simulate/view_files.c: a depth camera's view as files: what a reconstruction from views starts from. */
#include <math.h>
#include <stdio.h>

#include "io/io.h"
#include "io/json_file.h"
#include "simulate/view.h"

/* Metres of a unit of the depth image: 65535 units reach 6.5 m. */
static const double depth_unit = 1e-4;

enum { POSE_DIGITS = 12 };

static plm_status path_of(const char *folder, int number, const char *ending, char path[4096], plm_error *error)
{
    if (snprintf(path, 4096, "%s/view_%02d.%s", folder, number, ending) >= 4096)
        return plm_fail(error, PLM_E_ARGUMENT, "%.200s...: the path is too long", folder);
    return PLM_OK;
}

static plm_status write_image(const plm_scan_options *options, int number, const char *name, const plm_view *view,
                              int channels, int bits, const void *pixels, plm_error *error)
{
    char path[4096];
    const plm_image image = {view->camera.width, view->camera.height, channels, bits, pixels};
    const plm_status status = path_of(options->views_folder, number, name, path, error);
    return status == PLM_OK ? plm_image_write_png(path, &image, error) : status;
}

static plm_status write_depth(const plm_scan_options *options, int number, const plm_view *view, plm_error *error)
{
    const size_t count = (size_t)view->camera.width * (size_t)view->camera.height;
    uint16_t *pixel = plm_alloc(count, sizeof *pixel, error);
    if (!pixel) return PLM_E_MEMORY;
    for (size_t k = 0; k < count; k++) {
        const double units = floor((double)view->depth[k] / depth_unit + 0.5);
        pixel[k] = units > 0 && units < 65536 ? (uint16_t)units : 0;
    }
    const plm_status status = write_image(options, number, "depth.png", view, 1, 16, pixel, error);
    plm_free(pixel);
    return status;
}

/* Colour and mask do not suffer from what the depth sensor loses. */
static plm_status write_colour(const plm_stage_set *stage, const plm_scan_options *options, int number,
                               const plm_view *view, plm_error *error)
{
    static const uint8_t wall[3] = {52, 54, 60};
    const size_t count = (size_t)view->camera.width * (size_t)view->camera.height;
    uint8_t(*rgb)[3] = plm_alloc(count, sizeof *rgb, error);
    uint8_t *mask = plm_alloc(count, 1, error);
    plm_status status = rgb && mask ? PLM_OK : PLM_E_MEMORY;
    for (size_t k = 0; k < count && status == PLM_OK; k++) {
        const bool is_something = view->face[k] != PLM_NO_FACE;
        plm_sample sample = {.rgb = {wall[0], wall[1], wall[2]}};
        if (is_something) {
            double point[3], direction[3];
            const size_t row = k / (size_t)view->camera.width, column = k % (size_t)view->camera.width;
            plm_camera_unproject(&view->camera, (double)column + 0.5, (double)row + 0.5, 1, point);
            for (int i = 0; i < 3; i++) {
                direction[i] = point[i] - view->camera.position[i];
                sample.xyz[i] = (float)point[i];
            }
            plm_sample_label(stage, view->face[k], direction, options->seed, &sample);
        }
        for (int i = 0; i < 3; i++) rgb[k][i] = sample.rgb[i];
        mask[k] = is_something && view->face[k] < stage->plant_faces ? 255 : 0;
    }
    if (status == PLM_OK) status = write_image(options, number, "colour.png", view, 3, 8, rgb, error);
    if (status == PLM_OK) status = write_image(options, number, "mask.png", view, 1, 8, mask, error);
    plm_free(rgb);
    plm_free(mask);
    return status;
}

/* Camera to world: columns are the camera's x (right), y (down), z (forward) and its place. */
static json_t *pose_json(const plm_camera *camera)
{
    json_t *rows = json_array();
    for (int i = 0; i < 3; i++)
        json_array_append_new(rows, json_pack("[f,f,f,f]", camera->rotation[0][i], camera->rotation[1][i],
                                              camera->rotation[2][i], camera->position[i]));
    json_array_append_new(rows, json_pack("[i,i,i,i]", 0, 0, 0, 1));
    return rows;
}

static plm_status write_pose(const plm_stage_set *stage, const plm_scan_options *options, int number,
                             const plm_view *view, plm_error *error)
{
    const plm_camera *camera = &view->camera;
    char path[4096];
    plm_json_use_seam();
    json_t *root = json_pack(
        "{s:s, s:i, s:i, s:f, s:{s:i, s:i, s:f, s:f, s:f, s:f}, s:o, s:o, s:{s:[f,f,f], s:[f,f,f]}, s:f, s:f}",
        "convention",
        "camera: x right, y down, z forward; metres; the middle of pixel (column, row) is at (column + 0.5, row + "
        "0.5); "
        "camera_to_world is the calibrated pose, true_camera_to_world the one the images were taken from",
        "view", number, "views", options->views, "depth_metres_per_unit", depth_unit, "intrinsics", "width",
        camera->width, "height", camera->height, "fx", camera->focal[0], "fy", camera->focal[1], "cx",
        camera->centre[0], "cy", camera->centre[1], "camera_to_world", pose_json(&view->assumed),
        "true_camera_to_world", pose_json(camera), "true_axis", "point", stage->centre[0], stage->centre[1],
        stage->centre[2], "direction", 0.0, 0.0, 1.0, "turn_degrees", 360.0 * number / options->views,
        "depth_noise_m_at_0.4_m", options->noise);
    plm_status status = path_of(options->views_folder, number, "json", path, error);
    if (status == PLM_OK) status = plm_json_write(path, root, POSE_DIGITS, error);
    json_decref(root);
    return status;
}

plm_status plm_view_write(const plm_stage_set *stage, const plm_scan_options *options, int number, const plm_view *view,
                          plm_error *error)
{
    plm_status status = plm_folder_make(options->views_folder, error);
    if (status == PLM_OK) status = write_depth(options, number, view, error);
    if (status == PLM_OK) status = write_colour(stage, options, number, view, error);
    if (status == PLM_OK) status = write_pose(stage, options, number, view, error);
    return status;
}
