/* traits/midrib_width.c: the largest cross-section of a leaf, along its surface. */
#include "traits/leaf_midrib.h"

#include "cloud/linear.h"

#include <math.h>

enum { REACH = 3 /* stations by which the nearest one may differ from the cutting one */ };

static size_t nearest_station(const plm_midrib_line *line, const double point[3])
{
    size_t best = 0;
    double least = INFINITY;
    for (size_t k = 0; k < PLM_MIDRIB_STATIONS; k++) {
        double d[3];
        for (int i = 0; i < 3; i++) d[i] = point[i] - line->at[k][i];
        const double squared = plm_dot(d, d);
        if (squared < least) least = squared, best = k;
    }
    return best;
}

/* Length of the cut of a triangle with the plane where height is 0. */
static double cut_length(const plm_mesh *mesh, const uint32_t corner[3], const double height[3])
{
    double end[2][3];
    int found = 0;
    for (int i = 0; i < 3 && found < 2; i++) {
        const int j = (i + 1) % 3;
        if ((height[i] < 0) == (height[j] < 0)) continue;
        const double share = height[i] / (height[i] - height[j]);
        const double *a = mesh->vertex[corner[i]], *b = mesh->vertex[corner[j]];
        for (int k = 0; k < 3; k++) end[found][k] = a[k] + share * (b[k] - a[k]);
        found++;
    }
    if (found < 2) return 0;
    const double d[3] = {end[1][0] - end[0][0], end[1][1] - end[0][1], end[1][2] - end[0][2]};
    return plm_norm(d);
}

/* Adds to the widths what the planes at the stations near a triangle cut from it. */
static void cut_triangle(const plm_mesh *mesh, const plm_midrib_line *line, const size_t *nearest, size_t t,
                         double width[PLM_MIDRIB_STATIONS])
{
    const uint32_t *corner = mesh->triangle[t];
    const size_t middle = nearest[corner[0]];
    const size_t from = middle > REACH + 1 ? middle - REACH : 1;
    for (size_t k = from; k <= middle + REACH && k + 1 < PLM_MIDRIB_STATIONS; k++) {
        double along[3], height[3];
        for (int i = 0; i < 3; i++) along[i] = line->at[k + 1][i] - line->at[k - 1][i];
        for (int c = 0; c < 3; c++) {
            double d[3];
            for (int i = 0; i < 3; i++) d[i] = mesh->vertex[corner[c]][i] - line->at[k][i];
            height[c] = plm_dot(d, along);
        }
        width[k] += cut_length(mesh, corner, height);
    }
}

plm_status plm_midrib_width(const plm_mesh *mesh, const plm_midrib_line *line, double *width, plm_error *error)
{
    size_t *nearest = plm_alloc(mesh->vertex_count, sizeof *nearest, error);
    if (!nearest) return PLM_E_MEMORY;
    double at[PLM_MIDRIB_STATIONS] = {0};
    for (size_t v = 0; v < mesh->vertex_count; v++) nearest[v] = nearest_station(line, mesh->vertex[v]);
    for (size_t t = 0; t < mesh->triangle_count; t++) cut_triangle(mesh, line, nearest, t, at);
    plm_free(nearest);
    double largest = 0; /* of means of three: a single cut along a ragged rim is no width */
    for (size_t k = 2; k + 2 < PLM_MIDRIB_STATIONS; k++) largest = fmax(largest, (at[k - 1] + at[k] + at[k + 1]) / 3);
    *width = largest;
    return PLM_OK;
}
