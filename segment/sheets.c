/* segment/sheets.c: the depth of a point in its sheet is how far it lies from the nearest rim along the surface. Where two
 * leaves touch, or meet at their feet, what joins them is narrow: its depth is far less than that of either. So sheets are
 * the basins of the depth that a ratio tells apart (a merge tree of its logarithm); what is nearer to the rim goes to the
 * sheet that is nearest along the surface. */
#include "segment/sheets.h"

#include "cloud/linear.h"
#include "cloud/neighbours.h"
#include "cloud/order.h"
#include "segment/merge_tree.h"
#include "segment/scratch.h"

static const double RIM_GAP = 140; /* degrees of a point's surroundings without a neighbour: it is at the rim */
static const double NECK = 0.45;   /* depth between two sheets over that of the lesser one, at most */
static const double SHALLOW = 2;   /* spacings: what is less deep is no sheet */
static const double RIMLESS = 100; /* spacings: depth of a closed piece */
static const double LEAST = 0.002; /* share of the points that a sheet has */
enum { FEWEST = 20, GAP_ROOM = 256 };

/* Whether the linked neighbours of a point leave a wide gap in the directions around it. */
static bool is_rim(const plm_sheet_surface *surface, size_t i)
{
    const plm_graph *graph = &surface->graph;
    const double axis[3] = {surface->normal[i][0], surface->normal[i][1], surface->normal[i][2]};
    double u[3], v[3];
    float angle[GAP_ROOM];
    size_t angles = 0;
    plm_frame_of_axis(axis, u, v);
    for (uint32_t e = graph->first[i]; e < graph->first[i + 1] && angles < GAP_ROOM; e++) {
        const float *p = surface->xyz[i], *q = surface->xyz[graph->edge[e]];
        const double d[3] = {(double)q[0] - p[0], (double)q[1] - p[1], (double)q[2] - p[2]};
        angle[angles++] = (float)atan2(plm_dot(d, v), plm_dot(d, u));
    }
    if (angles < 3) return true;
    plm_order_sort(angle, angles);
    double gap = angle[0] + 2 * PLM_PI - angle[angles - 1];
    for (size_t k = 1; k < angles; k++) gap = fmax(gap, (double)angle[k] - angle[k - 1]);
    return gap > plm_radians(RIM_GAP);
}

/* Distance of each point from the rim along the surface. A closed piece has no rim: it is deep all over. */
static plm_status find_depth(const plm_sheet_surface *surface, float *depth, uint32_t *source, plm_error *error)
{
    size_t sources = 0;
    for (uint32_t i = 0; i < surface->graph.count; i++)
        if (is_rim(surface, i)) source[sources++] = i;
    const plm_walk walk = {.source = source, .source_count = sources, .distance = depth};
    const plm_status status = plm_graph_walk(&surface->graph, &walk, error);
    for (size_t i = 0; status == PLM_OK && i < surface->graph.count; i++)
        if (!isfinite(depth[i])) depth[i] = (float)(RIMLESS * surface->spacing);
    return status;
}

/* Points without a sheet get that of the nearest point along the surface; pieces that have none, of the nearest in space. */
static plm_status spread(const plm_sheet_surface *surface, int32_t *sheet, float *distance, uint32_t *source,
                         plm_error *error)
{
    plm_scratch scratch = {.error = error};
    const size_t count = surface->graph.count;
    int32_t *origin = plm_scratch_take(&scratch, count, sizeof *origin);
    float(*xyz)[3] = plm_scratch_take(&scratch, count, sizeof *xyz);
    uint32_t *row = plm_scratch_take(&scratch, count, sizeof *row);
    plm_index *index = NULL;
    size_t sources = 0;
    for (uint32_t i = 0; !scratch.failed && i < count; i++)
        if (sheet[i] >= 0) source[sources++] = i;
    const plm_walk walk = {.source = source, .source_count = sources, .distance = distance, .origin = origin};
    plm_status status = scratch.failed ? PLM_E_MEMORY : plm_graph_walk(&surface->graph, &walk, error);
    size_t known = 0;
    for (uint32_t i = 0; status == PLM_OK && i < count; i++) {
        if (origin[i] < 0) continue;
        sheet[i] = sheet[source[origin[i]]];
        for (int a = 0; a < 3; a++) xyz[known][a] = surface->xyz[i][a];
        row[known++] = i;
    }
    if (status == PLM_OK) status = plm_index_build((const float(*)[3])xyz, known, &index, error);
    for (uint32_t i = 0; status == PLM_OK && known && i < count; i++) {
        uint32_t nearest;
        if (origin[i] < 0 && plm_index_nearest(index, surface->xyz[i], 1, &nearest, NULL))
            sheet[i] = sheet[row[nearest]];
    }
    plm_index_free(index);
    plm_scratch_free(&scratch, NULL);
    return status;
}

plm_status plm_find_sheets(const plm_sheet_surface *surface, int32_t *sheet, size_t *sheets, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    const size_t count = surface->graph.count;
    float *depth = plm_scratch_take(&scratch, count, sizeof *depth);
    uint32_t *source = plm_scratch_take(&scratch, count, sizeof *source);
    plm_status status = scratch.failed ? PLM_E_MEMORY : find_depth(surface, depth, source, error);
    /* A branch of the tree ends where its tip is more than reach above a meeting: by a ratio of depths, that is. One that meets
     * none counts if its tip is more than reach above 0, which is where the depth is SHALLOW. */
    const double ratio = -log(NECK), shallow = SHALLOW * surface->spacing;
    for (size_t i = 0; status == PLM_OK && i < count; i++)
        depth[i] = depth[i] > 0 ? (float)(log(depth[i] / shallow) + ratio) : INFINITY;
    const size_t least = (size_t)fmax(FEWEST, LEAST * (double)count);
    if (status == PLM_OK) status = plm_merge_tree(&surface->graph, depth, ratio, least, sheet, sheets, error);
    if (status == PLM_OK) status = spread(surface, sheet, depth, source, error);
    plm_scratch_free(&scratch, NULL);
    return status;
}
