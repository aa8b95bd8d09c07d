/* reports/picture_view.c: a software renderer with a depth buffer, twice as fine as the picture. Depth is made visible by
 * darkening what lies behind a near edge (C. Boucheny, Eye-dome lighting, 2009): points have no normals to shade by. */
#include "reports/picture_view.h"

#include "cloud/subset.h"

#include <math.h>
#include <string.h>

enum { FINE = 2 };

static const double light[3] = {-0.35, 0.75, 0.56};       /* right, up, towards the viewer: unit */
static const double dimmest = 0.55;                       /* of a surface edge-on to the light */
static const double edge_depth = 14, edge_strength = 2.2; /* fine pixels; taste */

/** Depth and colour of the fine pixels of a box. Depth grows towards the viewer. */
typedef struct buffer {
    const plm_view *view;
    int width, height;
    double towards[3];
    float *depth;
    plm_rgb *colour;
} buffer;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

void plm_view_project(const plm_view *view, const double point[3], double *x, double *y)
{
    const double offset[3] = {point[0] - view->centre[0], point[1] - view->centre[1], point[2] - view->centre[2]};
    *x = view->x + view->width / 2.0 + view->scale * dot(offset, view->right);
    *y = view->y + view->height / 2.0 - view->scale * dot(offset, view->up);
}

double plm_view_nearness(const plm_view *view, const double point[3])
{
    double towards[3];
    cross(view->right, view->up, towards);
    return dot(point, towards);
}

plm_rgb plm_organ_colour(plm_label label, int32_t organ)
{
    static const plm_rgb leaves[] = {{0, 158, 115}, {230, 159, 0},  {0, 114, 178},  {204, 121, 167}, {86, 180, 233},
                                     {213, 94, 0},  {153, 153, 51}, {136, 34, 85},  {68, 170, 153},  {240, 200, 60},
                                     {51, 34, 136}, {17, 119, 51},  {170, 68, 153}, {136, 204, 238}, {204, 102, 119}};
    const plm_rgb leaf = leaves[(organ < 0 ? 0 : organ) % (int)(sizeof leaves / sizeof *leaves)];
    switch (label) {
        case PLM_LABEL_LEAF:
            return leaf;
        case PLM_LABEL_PETIOLE: /* its leaf's, darker */
            return (plm_rgb){(uint8_t)(leaf.r * 0.6), (uint8_t)(leaf.g * 0.6), (uint8_t)(leaf.b * 0.6)};
        case PLM_LABEL_STEM:
            return (plm_rgb){96, 72, 52};
        case PLM_LABEL_GROUND:
            return (plm_rgb){190, 184, 176};
        default:
            return (plm_rgb){214, 214, 214};
    }
}

/* ---- Into the buffer --------------------------------------------------------------------------------------------- */

static plm_status make_buffer(const plm_view *view, buffer *made, plm_error *error)
{
    buffer b = {.view = view, .width = view->width * FINE, .height = view->height * FINE};
    cross(view->right, view->up, b.towards);
    const size_t count = (size_t)b.width * (size_t)b.height;
    b.depth = plm_alloc(count, sizeof *b.depth, error);
    b.colour = b.depth ? plm_alloc(count, sizeof *b.colour, error) : NULL;
    if (!b.colour) {
        plm_free(b.depth);
        return PLM_E_MEMORY;
    }
    for (size_t i = 0; i < count; i++) b.depth[i] = -INFINITY;
    *made = b;
    return PLM_OK;
}

static void free_buffer(buffer *b)
{
    plm_free(b->depth);
    plm_free(b->colour);
}

/* Fine pixels from the buffer's corner, and depth in fine pixels. */
static void to_buffer(const buffer *b, const double point[3], double out[3])
{
    const plm_view *view = b->view;
    plm_view_project(view, point, &out[0], &out[1]);
    out[0] = (out[0] - view->x) * FINE;
    out[1] = (out[1] - view->y) * FINE;
    const double offset[3] = {point[0] - view->centre[0], point[1] - view->centre[1], point[2] - view->centre[2]};
    out[2] = dot(offset, b->towards) * view->scale * FINE;
}

/* Of equal depths the smaller colour wins: the order of points does not show. */
static void put(buffer *b, int x, int y, float depth, plm_rgb colour)
{
    const size_t at = (size_t)y * (size_t)b->width + (size_t)x;
    if (depth < b->depth[at]) return;
    if (depth == b->depth[at] && memcmp(&colour, &b->colour[at], sizeof colour) >= 0) return;
    b->depth[at] = depth;
    b->colour[at] = colour;
}

static void put_disc(buffer *b, const double centre[3], double radius, plm_rgb colour)
{
    if (!(centre[0] > -radius && centre[1] > -radius && centre[0] < b->width + radius &&
          centre[1] < b->height + radius))
        return;
    const int left = (int)fmax(0, floor(centre[0] - radius)), right = (int)fmin(b->width - 1, centre[0] + radius);
    const int top = (int)fmax(0, floor(centre[1] - radius)), bottom = (int)fmin(b->height - 1, centre[1] + radius);
    for (int y = top; y <= bottom; y++)
        for (int x = left; x <= right; x++) {
            const double dx = x + 0.5 - centre[0], dy = y + 0.5 - centre[1], squared = dx * dx + dy * dy;
            if (squared > radius * radius) continue;
            put(b, x, y, (float)(centre[2] + sqrt(radius * radius - squared) * 0.5), colour); /* a ball, flattened */
        }
}

static plm_rgb shaded(plm_rgb colour, double share)
{
    return (plm_rgb){(uint8_t)(colour.r * share), (uint8_t)(colour.g * share), (uint8_t)(colour.b * share)};
}

/* Both sides of a surface are lit alike. */
static plm_rgb triangle_colour(const double p[3][3], plm_rgb colour)
{
    const double a[3] = {p[1][0] - p[0][0], p[0][1] - p[1][1], p[1][2] - p[0][2]};
    const double c[3] = {p[2][0] - p[0][0], p[0][1] - p[2][1], p[2][2] - p[0][2]};
    double normal[3];
    cross(a, c, normal);
    const double length = sqrt(dot(normal, normal));
    const double lit = length > 0 ? fabs(dot(normal, light)) / length : 0;
    return shaded(colour, dimmest + (1 - dimmest) * lit);
}

static void put_triangle(buffer *b, const double p[3][3], plm_rgb colour)
{
    const double area = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]);
    if (area == 0) return;
    double low[2], high[2];
    for (int axis = 0; axis < 2; axis++) {
        low[axis] = fmin(p[0][axis], fmin(p[1][axis], p[2][axis]));
        high[axis] = fmax(p[0][axis], fmax(p[1][axis], p[2][axis]));
    }
    const plm_rgb seen = triangle_colour(p, colour);
    const int right = (int)fmin(b->width - 1, high[0]), bottom = (int)fmin(b->height - 1, high[1]);
    for (int y = (int)fmax(0, floor(low[1])); y <= bottom; y++)
        for (int x = (int)fmax(0, floor(low[0])); x <= right; x++) {
            const double px = x + 0.5, py = y + 0.5;
            const double w1 = ((px - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (py - p[0][1])) / area;
            const double w2 = ((p[1][0] - p[0][0]) * (py - p[0][1]) - (px - p[0][0]) * (p[1][1] - p[0][1])) / area;
            if (w1 < 0 || w2 < 0 || w1 + w2 > 1) continue;
            put(b, x, y, (float)(p[0][2] + w1 * (p[1][2] - p[0][2]) + w2 * (p[2][2] - p[0][2])), seen);
        }
}

/* ---- The plant --------------------------------------------------------------------------------------------------- */

static void put_surfaces(buffer *b, const plm_measurement *measurement)
{
    const plm_mesh *mesh = &measurement->leaves;
    double shift[3];
    for (int axis = 0; axis < 3; axis++) shift[axis] = mesh->origin[axis] - measurement->cloud.origin[axis];
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double corner[3][3];
        for (int k = 0; k < 3; k++) {
            const double *vertex = mesh->vertex[mesh->triangle[i][k]];
            const double point[3] = {vertex[0] + shift[0], vertex[1] + shift[1], vertex[2] + shift[2]};
            to_buffer(b, point, corner[k]);
        }
        put_triangle(b, (const double(*)[3])corner,
                     plm_organ_colour(PLM_LABEL_LEAF, mesh->face_organ ? mesh->face_organ[i] : 0));
    }
}

enum { MOST_POINTS = 200000 }; /**< a tenth of the fine pixels */

/** Leaves with higher numbers keep their points, whether they have a surface or not. */
enum { MOST_LEAVES = 1 << 16 };

/* Which leaves have a surface: count long, the caller's. */
static plm_status list_surfaces(const plm_mesh *mesh, bool **has_surface, size_t *count, plm_error *error)
{
    int32_t highest = -1;
    for (size_t i = 0; mesh->face_organ && i < mesh->triangle_count; i++)
        if (mesh->face_organ[i] > highest && mesh->face_organ[i] < MOST_LEAVES) highest = mesh->face_organ[i];
    *count = (size_t)(highest + 1);
    *has_surface = plm_alloc_zero(*count, sizeof **has_surface, error);
    if (!*has_surface) return PLM_E_MEMORY;
    for (size_t i = 0; mesh->face_organ && i < mesh->triangle_count; i++)
        if (mesh->face_organ[i] >= 0 && mesh->face_organ[i] <= highest) (*has_surface)[mesh->face_organ[i]] = true;
    return PLM_OK;
}

/* Points of noise are drawn small; those of a leaf whose surface is drawn would only speckle it. A view shows no more than
 * so many points. */
static plm_status put_points(buffer *b, const plm_measurement *measurement, double radius, plm_error *error)
{
    const plm_cloud *cloud = &measurement->cloud;
    bool *has_surface;
    size_t leaves;
    uint32_t *drawn = plm_alloc(cloud->count, sizeof *drawn, error);
    plm_status status = drawn ? list_surfaces(&measurement->leaves, &has_surface, &leaves, error) : PLM_E_MEMORY;
    if (status != PLM_OK) {
        plm_free(drawn);
        return status;
    }
    const size_t count = plm_sample_rows((const float(*)[3])cloud->xyz, cloud->count, MOST_POINTS, drawn);
    for (size_t k = 0; k < count; k++) {
        const size_t i = drawn[k];
        const plm_label label = cloud->label ? (plm_label)cloud->label[i] : PLM_LABEL_OTHER;
        const int32_t organ = cloud->organ ? cloud->organ[i] : -1;
        if (label == PLM_LABEL_LEAF && organ >= 0 && (size_t)organ < leaves && has_surface[organ]) continue;
        plm_rgb colour = plm_organ_colour(label, organ);
        if (!cloud->label)
            colour =
                cloud->rgb ? (plm_rgb){cloud->rgb[i][0], cloud->rgb[i][1], cloud->rgb[i][2]} : (plm_rgb){84, 130, 84};
        const double point[3] = {cloud->xyz[i][0], cloud->xyz[i][1], cloud->xyz[i][2]};
        double centre[3];
        to_buffer(b, point, centre);
        put_disc(b, centre, cloud->label && label == PLM_LABEL_OTHER ? 1 : radius, colour);
    }
    plm_free(has_surface);
    plm_free(drawn);
    return PLM_OK;
}

/* Radius of a disc, in fine pixels: neighbours should touch. The spacing is that of a sheet seen from the front. */
static double disc_radius(const buffer *b, const plm_measurement *measurement)
{
    double spacing = measurement->segmentation.spacing;
    if (!(spacing > 0)) {
        const double covered = 0.15 * b->view->width * b->view->height / (b->view->scale * b->view->scale);
        spacing = sqrt(covered / (double)measurement->cloud.count);
    }
    if (measurement->cloud.count > MOST_POINTS) spacing *= sqrt((double)measurement->cloud.count / MOST_POINTS);
    return fmin(fmax(0.8 * spacing * b->view->scale * FINE, 1.2), 7);
}

/* How much of its light a fine pixel keeps, by how far its neighbours stand before it. */
static double edge_light(const buffer *b, int x, int y)
{
    static const int around[8][2] = {{-2, 0}, {2, 0}, {0, -2}, {0, 2}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
    const float depth = b->depth[(size_t)y * (size_t)b->width + (size_t)x];
    double before = 0;
    for (int i = 0; i < 8; i++) {
        const int nx = x + around[i][0], ny = y + around[i][1];
        if (nx < 0 || ny < 0 || nx >= b->width || ny >= b->height) continue;
        const float other = b->depth[(size_t)ny * (size_t)b->width + (size_t)nx];
        if (other > depth) before += fmin(other - depth, edge_depth) / edge_depth / 8;
    }
    return exp(-edge_strength * before);
}

static void to_canvas(const buffer *b, plm_canvas *canvas)
{
#pragma omp parallel for
    for (int y = 0; y < b->view->height; y++)
        for (int x = 0; x < b->view->width; x++) {
            double sum[3] = {0};
            int seen = 0;
            for (int k = 0; k < FINE * FINE; k++) {
                const int fx = x * FINE + k % FINE, fy = y * FINE + k / FINE;
                const size_t at = (size_t)fy * (size_t)b->width + (size_t)fx;
                if (isinf(b->depth[at])) continue;
                const double kept = edge_light(b, fx, fy);
                sum[0] += b->colour[at].r * kept;
                sum[1] += b->colour[at].g * kept;
                sum[2] += b->colour[at].b * kept;
                seen++;
            }
            if (seen == 0) continue;
            const plm_rgb mean = {(uint8_t)(sum[0] / seen + 0.5), (uint8_t)(sum[1] / seen + 0.5),
                                  (uint8_t)(sum[2] / seen + 0.5)};
            plm_canvas_blend(canvas, b->view->x + x, b->view->y + y, mean, (double)seen / (FINE * FINE));
        }
}

plm_status plm_view_draw(plm_canvas *canvas, const plm_view *view, const plm_measurement *measurement, plm_error *error)
{
    buffer b;
    plm_status status = make_buffer(view, &b, error);
    if (status != PLM_OK) return status;
    put_surfaces(&b, measurement);
    status = put_points(&b, measurement, disc_radius(&b, measurement), error);
    if (status == PLM_OK) to_canvas(&b, canvas);
    free_buffer(&b);
    return status;
}
