/* simulate/view.c: a depth camera: true depth by rays through the pixels' middles, then what a time-of-flight sensor
 * makes of it: noise that grows with the square of range, mixed pixels at depth edges, grazing surfaces and thin stems
 * lost. */
#include "simulate/view.h"

#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "cloud/random.h"

size_t plm_ring_positions(const plm_stage_set *stage, const plm_scan_options *options, double (*position)[3])
{
    const uint64_t key = plm_key(options->seed, 20);
    const double start = 2 * PLM_PI * plm_uniform_at(key, 0);
    for (int k = 0; k < options->views; k++) {
        const double azimuth = start + 2 * PLM_PI * k / options->views;
        position[k][0] = stage->centre[0] + options->distance * cos(options->elevation) * cos(azimuth);
        position[k][1] = stage->centre[1] + options->distance * cos(options->elevation) * sin(azimuth);
        position[k][2] = stage->centre[2] + options->distance * sin(options->elevation);
    }
    return (size_t)options->views;
}

/* The seedling paper's camera: 70 x 55 degrees, 16 by 9 pixels. */
static plm_camera camera_at(const double position[3], const double target[3], int width)
{
    const int height = width * 9 / 16;
    plm_camera camera = {.width = width,
                         .height = height,
                         .focal = {0.5 * width / tan(plm_radians(35)), 0.5 * height / tan(plm_radians(27.5))},
                         .centre = {0.5 * width, 0.5 * height}};
    double *right = camera.rotation[0], *down = camera.rotation[1], *forward = camera.rotation[2];
    memcpy(camera.position, position, sizeof camera.position);
    for (int i = 0; i < 3; i++) forward[i] = target[i] - position[i];
    plm_normalise(forward);
    plm_cross(forward, (double[3]){0, 0, 1}, right);
    plm_normalise(right);
    plm_cross(forward, right, down);
    return camera;
}

/* The calibration is a little wrong: the whole view is turned about the target and shifted. */
static plm_camera misjudged(const plm_camera *camera, const double target[3], const plm_scan_options *options,
                            int number)
{
    const uint64_t key = plm_key(options->seed, 21);
    const uint64_t at = 8 * (uint64_t)number;
    plm_camera wrong = *camera;
    double turn[3], shift[3], arm[3], moved[3];
    for (int i = 0; i < 3; i++) {
        turn[i] = fmax(options->misrotation, 0) * plm_normal_at(key, at + (uint64_t)i);
        shift[i] = fmax(options->misplacement, 0) * plm_normal_at(key, at + 3 + (uint64_t)i);
        arm[i] = camera->position[i] - target[i];
    }
    plm_cross(turn, arm, moved); /* angles of 1e-3: the first order is good to 1e-6 */
    for (int i = 0; i < 3; i++) wrong.position[i] += moved[i] + shift[i];
    for (int k = 0; k < 3; k++) {
        plm_cross(turn, camera->rotation[k], moved);
        for (int i = 0; i < 3; i++) wrong.rotation[k][i] += moved[i];
        plm_normalise(wrong.rotation[k]);
    }
    return wrong;
}

/* Turns a vector about a unit axis (Rodrigues). */
static void turn_about(const double axis[3], double angle, double vector[3])
{
    double across[3], turned[3];
    const double along = plm_dot(axis, vector), sine = sin(angle), cosine = cos(angle);
    plm_cross(axis, vector, across);
    for (int i = 0; i < 3; i++) turned[i] = cosine * vector[i] + sine * across[i] + (1 - cosine) * along * axis[i];
    memcpy(vector, turned, sizeof turned);
}

/* Poses come from the first view's by turning about the turntable's axis: where that is calibrated wrongly, the view is turned back
 * about the true axis and forth about the wrong one. */
static void turn_wrongly(const plm_stage_set *stage, const plm_scan_options *options, int number, plm_camera *camera)
{
    const uint64_t key = plm_key(options->seed, 23);
    const double lean = 2 * PLM_PI * plm_uniform_at(key, 0), aside = 2 * PLM_PI * plm_uniform_at(key, 1);
    const double angle = 2 * PLM_PI * number / options->views, up[3] = {0, 0, 1};
    const double axis[3] = {sin(options->axis_tilt) * cos(lean), sin(options->axis_tilt) * sin(lean),
                            cos(options->axis_tilt)};
    const double shift[3] = {options->axis_shift * cos(aside), options->axis_shift * sin(aside), 0};
    for (int i = 0; i < 3; i++) camera->position[i] -= stage->centre[i];
    turn_about(up, -angle, camera->position);
    for (int i = 0; i < 3; i++) camera->position[i] -= shift[i];
    turn_about(axis, angle, camera->position);
    for (int i = 0; i < 3; i++) camera->position[i] += shift[i] + stage->centre[i];
    for (int k = 0; k < 3; k++) {
        turn_about(up, -angle, camera->rotation[k]);
        turn_about(axis, angle, camera->rotation[k]);
    }
}

void plm_camera_unproject(const plm_camera *camera, double column, double row, double depth, double point[3])
{
    const double x = (column - camera->centre[0]) / camera->focal[0], y = (row - camera->centre[1]) / camera->focal[1];
    for (int i = 0; i < 3; i++)
        point[i] = camera->position[i] +
                   depth * (x * camera->rotation[0][i] + y * camera->rotation[1][i] + camera->rotation[2][i]);
}

/* True depth and face of every pixel. */
static void trace(const plm_stage_set *stage, plm_view *view)
{
#pragma omp parallel for schedule(dynamic, 16)
    for (int row = 0; row < view->camera.height; row++)
        for (int column = 0; column < view->camera.width; column++) {
            const size_t pixel = (size_t)row * (size_t)view->camera.width + (size_t)column;
            double ahead[3];
            plm_hit hit;
            plm_camera_unproject(&view->camera, column + 0.5, row + 0.5, 1, ahead);
            for (int i = 0; i < 3; i++)
                ahead[i] -= view->camera.position[i]; /* depth 1 along the axis: t is the depth */
            const bool met = plm_rays_first(stage->rays, view->camera.position, ahead, 0, INFINITY, &hit);
            view->face[pixel] = met ? hit.face : PLM_NO_FACE;
            view->depth[pixel] = met ? (float)hit.t : 0;
        }
}

/* Radius of the tube that a face belongs to; 0 for sheets and ground. */
static double tube_radius(const plm_stage_set *stage, uint32_t face)
{
    return face < stage->plant_faces ? (double)stage->plant->vertex_radius[stage->mesh.triangle[face][0]] : 0;
}

/* Whether the sensor sees the surface at all: grazing incidence and thin stems fail, stems in pieces of a centimetre.
 */
static bool is_lost(const plm_stage_set *stage, const plm_scan_options *options, int number, uint32_t face,
                    const double point[3], const double direction[3], double draw)
{
    double normal[3];
    plm_face_normal(&stage->mesh, face, normal);
    const double cosine = fabs(plm_dot(normal, direction)) / plm_norm(direction);
    if (cosine < 0.1 + 0.12 * draw) return true;
    const double diameter = 2 * tube_radius(stage, face);
    if (!(diameter > 0) || diameter >= options->thin_stem) return false;
    uint64_t piece = (uint64_t)number;
    for (int i = 0; i < 3; i++) piece = piece * 1000003u + (uint64_t)(int64_t)floor(point[i] / 0.01);
    return plm_uniform_at(plm_key(options->seed, 22), piece) < 0.05 + 0.4 * (1 - diameter / options->thin_stem);
}

/* Farthest true depth among the four neighbours of a pixel, INFINITY where one sees nothing. */
static double farthest_around(const plm_camera *camera, const float *depth, int column, int row)
{
    double farthest = 0;
    for (int k = 0; k < 4; k++) {
        const int c = column + (k == 0) - (k == 1), r = row + (k == 2) - (k == 3);
        if (c < 0 || r < 0 || c >= camera->width || r >= camera->height) continue;
        const double there = (double)depth[(size_t)r * (size_t)camera->width + (size_t)c];
        farthest = fmax(farthest, there > 0 ? there : INFINITY);
    }
    return farthest;
}

/* The sensor's answer for one pixel; 0 when it gives none. */
static double measured(const plm_stage_set *stage, const plm_scan_options *options, int number, const plm_view *view,
                       const float *truth, int column, int row, bool *is_ghost)
{
    const size_t pixel = (size_t)row * (size_t)view->camera.width + (size_t)column;
    const uint64_t key = plm_key(options->seed, 30 + (uint64_t)number);
    const double depth = (double)truth[pixel], far = farthest_around(&view->camera, truth, column, row);
    double point[3], direction[3], shown = depth;
    plm_camera_unproject(&view->camera, column + 0.5, row + 0.5, depth, point);
    for (int i = 0; i < 3; i++) direction[i] = point[i] - view->camera.position[i];
    *is_ghost = false;
    if (is_lost(stage, options, number, view->face[pixel], point, direction, plm_uniform_at(key, 4 * pixel))) return 0;
    const double mix = plm_uniform_at(key, 4 * pixel + 1);
    if (far > depth + 0.004 && mix < 0.22) {
        /* the pixel's cone holds both; where nothing lies behind, the weak return still pulls the depth back */
        const double weight = mix / 0.22;
        shown += isinf(far) ? -0.004 * log(1 - 0.98 * weight) : weight * fmin(far - depth, 0.03);
        *is_ghost = shown - depth > 0.0008;
    }
    return shown + options->noise * (depth / 0.4) * (depth / 0.4) * plm_normal_at(key, 2 * pixel + 1);
}

static void sense(const plm_stage_set *stage, const plm_scan_options *options, int number, const float *truth,
                  plm_view *view)
{
    size_t pixels = 0, ghosts = 0;
#pragma omp parallel for schedule(dynamic, 16) reduction(+ : pixels, ghosts)
    for (int row = 0; row < view->camera.height; row++)
        for (int column = 0; column < view->camera.width; column++) {
            const size_t pixel = (size_t)row * (size_t)view->camera.width + (size_t)column;
            bool is_ghost = false;
            view->is_ghost[pixel] = 0;
            if (view->face[pixel] == PLM_NO_FACE) continue;
            view->depth[pixel] = (float)measured(stage, options, number, view, truth, column, row, &is_ghost);
            view->is_ghost[pixel] = is_ghost && view->depth[pixel] > 0;
            pixels += view->depth[pixel] > 0;
            ghosts += view->is_ghost[pixel];
        }
    view->pixels = pixels;
    view->ghosts = ghosts;
}

plm_status plm_view_take(const plm_stage_set *stage, const plm_scan_options *options, int number, plm_view *view,
                         plm_error *error)
{
    const size_t pixels = (size_t)options->image_width * (size_t)(options->image_width * 9 / 16);
    double(*position)[3] = plm_alloc(PLM_POSITIONS_MAXIMUM, sizeof *position, error);
    float *truth = plm_alloc(pixels, sizeof *truth, error);
    plm_view taken = {.depth = plm_alloc(pixels, sizeof *taken.depth, error),
                      .face = plm_alloc(pixels, sizeof *taken.face, error),
                      .is_ghost = plm_alloc(pixels, 1, error)};
    const bool has_room = position && truth && taken.depth && taken.face && taken.is_ghost;
    if (has_room) {
        plm_ring_positions(stage, options, position);
        taken.camera = camera_at(position[number], stage->centre, options->image_width);
        taken.assumed = misjudged(&taken.camera, stage->centre, options, number);
        if (options->axis_tilt != 0 || options->axis_shift != 0) turn_wrongly(stage, options, number, &taken.assumed);
        trace(stage, &taken);
        memcpy(truth, taken.depth, pixels * sizeof *truth);
        sense(stage, options, number, truth, &taken);
        *view = taken;
    } else {
        plm_view_free(&taken);
    }
    plm_free(position);
    plm_free(truth);
    return has_room ? PLM_OK : PLM_E_MEMORY;
}

void plm_view_free(plm_view *view)
{
    plm_free(view->depth);
    plm_free(view->face);
    plm_free(view->is_ghost);
    *view = (plm_view){0};
}
