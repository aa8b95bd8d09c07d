/* segment/sheet_surface.c: sheets that lie face to face are told apart by where their planes lie: points are moved onto planes
 * fitted to their surroundings, and neighbours are linked where each lies in the other's plane. */
#include "segment/sheet_surface.h"

#include "cloud/linear.h"
#include "cloud/neighbours.h"
#include "segment/scale.h"
#include "segment/scratch.h"

static const double PLANE_SPACINGS = 2.5, PLANE_SIGMAS = 6; /* radius of the surroundings that a plane is fitted to */
static const double LINK_SPACINGS = 4;                      /* length of a link, at most */
static const double LINK_COSINE = 0.9397;                   /* of the angle between linked planes: 20 degrees */
static const double LINK_OFF = 0.8;                         /* distance from the other's plane, in spacings, at most */
enum { BUDGET = 45000, AREA_NEIGHBOURS = 12, LINK_NEIGHBOURS = 24, ROOM = 512 };

/* Median over the points of the edge of a square that holds one: by the circle that holds so many. 0 where there are too few. */
static plm_status find_spacing(const float (*xyz)[3], size_t count, double *spacing, plm_error *error)
{
    *spacing = 0;
    if (count <= AREA_NEIGHBOURS) return PLM_OK;
    plm_scratch scratch = {.error = error};
    float *squared = plm_scratch_take(&scratch, count * AREA_NEIGHBOURS, sizeof *squared);
    float *last = plm_scratch_take(&scratch, count, sizeof *last);
    plm_status status =
        scratch.failed ? PLM_E_MEMORY : plm_neighbour_table(xyz, count, AREA_NEIGHBOURS, NULL, squared, error);
    if (status == PLM_OK) {
        for (size_t i = 0; i < count; i++) last[i] = squared[(i + 1) * AREA_NEIGHBOURS - 1];
        *spacing = sqrt(PLM_PI * plm_quantile(last, count, 0.5) / AREA_NEIGHBOURS);
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}

static plm_status thin(const float (*xyz)[3], size_t count, double noise, plm_sheet_surface *surface, plm_error *error)
{
    double cell = 0, spacing = 0;
    plm_thinned first = {0};
    plm_status status = plm_thin_cell(xyz, count, BUDGET, &cell, error);
    if (status == PLM_OK) status = plm_thin(xyz, count, cell, &first, error);
    if (status == PLM_OK) status = find_spacing((const float(*)[3])first.xyz, first.count, &spacing, error);
    plm_thinned_free(&first);
    if (status == PLM_OK) status = plm_thin(xyz, count, fmax(fmax(spacing, cell), noise), &surface->thinned, error);
    if (status == PLM_OK)
        status =
            find_spacing((const float(*)[3])surface->thinned.xyz, surface->thinned.count, &surface->spacing, error);
    if (status == PLM_OK && !(surface->spacing > 0))
        return plm_fail(error, PLM_E_DEGENERATE, "too few points for a surface");
    return status;
}

/* Moves a place onto the plane of the points around it, near ones weighing more. */
static void settle(const float (*xyz)[3], const float here[3], const uint32_t *row, const float *squared, size_t rows,
                   double radius, float out[3], float normal[3])
{
    double n = 0, mean[3] = {0}, m[6] = {0}, value[3], vector[3][3];
    for (size_t k = 0; k < rows; k++) {
        const double w = exp(-2 * (double)squared[k] / (radius * radius));
        const double d[3] = {(double)xyz[row[k]][0] - here[0], (double)xyz[row[k]][1] - here[1],
                             (double)xyz[row[k]][2] - here[2]};
        n += w;
        for (int a = 0; a < 3; a++) mean[a] += w * d[a];
        m[0] += w * d[0] * d[0], m[1] += w * d[0] * d[1], m[2] += w * d[0] * d[2];
        m[3] += w * d[1] * d[1], m[4] += w * d[1] * d[2], m[5] += w * d[2] * d[2];
    }
    for (int a = 0; a < 3; a++) mean[a] /= n;
    const int pair[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
    for (int e = 0; e < 6; e++) m[e] = m[e] / n - mean[pair[e][0]] * mean[pair[e][1]];
    plm_eigen3(m, value, vector);
    const double off = plm_dot(mean, vector[2]);
    for (int a = 0; a < 3; a++) {
        normal[a] = (float)vector[2][a];
        out[a] = (float)(here[a] + off * vector[2][a]);
    }
}

static plm_status settle_all(plm_sheet_surface *surface, const float (*from)[3], float (*to)[3], double radius,
                             plm_error *error)
{
    const size_t count = surface->thinned.count;
    plm_index *index = NULL;
    const plm_status status = plm_index_build(from, count, &index, error);
    if (status != PLM_OK) return status;
#pragma omp parallel for schedule(dynamic, 256)
    for (size_t i = 0; i < count; i++) {
        uint32_t row[ROOM];
        float squared[ROOM];
        const size_t found = plm_index_ball(index, from[i], (float)radius, ROOM, row, squared);
        const size_t rows = found <= ROOM ? found : plm_index_nearest(index, from[i], ROOM, row, squared);
        settle(from, from[i], row, squared, rows, radius, to[i], surface->normal[i]);
    }
    plm_index_free(index);
    return PLM_OK;
}

static bool is_along(const plm_sheet_surface *surface, size_t i, size_t j)
{
    const float *p = surface->xyz[i], *q = surface->xyz[j], *m = surface->normal[i], *n = surface->normal[j];
    double cosine = 0, off_p = 0, off_q = 0;
    for (int a = 0; a < 3; a++) {
        cosine += (double)m[a] * n[a];
        off_p += ((double)q[a] - p[a]) * m[a];
        off_q += ((double)q[a] - p[a]) * n[a];
    }
    return fabs(cosine) > LINK_COSINE && fmax(fabs(off_p), fabs(off_q)) < LINK_OFF * surface->spacing;
}

static plm_status make_links(plm_sheet_surface *surface, plm_error *error)
{
    const size_t count = surface->thinned.count;
    plm_graph *near = &surface->near, out = {.count = count, .xyz = (const float(*)[3])surface->xyz};
    const plm_status status =
        plm_graph_build(out.xyz, count, LINK_NEIGHBOURS, LINK_SPACINGS * surface->spacing, near, error);
    if (status != PLM_OK) return status;
    out.first = plm_alloc(count + 1, sizeof *out.first, error);
    out.edge = plm_alloc((size_t)near->first[count] + 1, sizeof *out.edge, error);
    surface->graph = out;
    if (!out.first || !out.edge) return PLM_E_MEMORY;
    uint32_t edges = 0;
    for (size_t i = 0; i < count; i++) {
        out.first[i] = edges;
        for (uint32_t e = near->first[i]; e < near->first[i + 1]; e++)
            if (is_along(surface, i, near->edge[e])) out.edge[edges++] = near->edge[e];
    }
    out.first[count] = edges;
    return PLM_OK;
}

plm_status plm_sheet_surface_make(const float (*xyz)[3], size_t count, double noise, plm_sheet_surface *surface,
                                  plm_error *error)
{
    plm_sheet_surface out = {0};
    float(*between)[3] = NULL;
    plm_status status = thin(xyz, count, noise, &out, error);
    if (status == PLM_OK) {
        between = plm_alloc(out.thinned.count, sizeof *between, error);
        out.xyz = plm_alloc(out.thinned.count, sizeof *out.xyz, error);
        out.normal = plm_alloc(out.thinned.count, sizeof *out.normal, error);
        if (!between || !out.xyz || !out.normal) status = PLM_E_MEMORY;
    }
    const double radius = fmax(PLANE_SPACINGS * out.spacing, PLANE_SIGMAS * noise);
    if (status == PLM_OK) status = settle_all(&out, (const float(*)[3])out.thinned.xyz, between, radius, error);
    if (status == PLM_OK) status = settle_all(&out, (const float(*)[3])between, out.xyz, radius, error);
    plm_free(between);
    if (status == PLM_OK) status = make_links(&out, error);
    if (status == PLM_OK)
        *surface = out;
    else
        plm_sheet_surface_free(&out);
    return status;
}

void plm_sheet_surface_free(plm_sheet_surface *surface)
{
    if (!surface) return;
    plm_thinned_free(&surface->thinned);
    plm_free(surface->xyz);
    plm_free(surface->normal);
    plm_graph_free(&surface->near);
    plm_graph_free(&surface->graph);
    *surface = (plm_sheet_surface){0};
}
