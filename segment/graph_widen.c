/* segment/graph_widen.c: splats leave some leaves with a tenth of the points of others, scans of few points a stem with a fifth. Links that
 * suit the dense parts leave the sparse ones full of holes: ways across a leaf take turns, as if it were several, and balls on a stem hold
 * two points. */
#include "cloud/neighbours.h"
#include "cloud/order.h"
#include "segment/graph.h"
#include "segment/scratch.h"

#include <math.h>

/* A part is sparse where the distance to the FOURTH neighbour is more than SPARSE of the median: two points of such parts are linked up to
 * WIDE of the shorter of their distances. */
static const double SPARSE = 1.2, WIDE = 1.5;
/* New links, counted from both of their ends, over the number of points: fewer are those between a few stray points, which do harm (0.004 to
 * 0.04 of rosettes from depth cameras; 0.22 and more of splats whose leaves fell to pieces). */
static const double SHARE = 0.1;
enum { FOURTH = 4, NEIGHBOURS = 10 };

static bool is_linked(const plm_graph *graph, uint32_t a, uint32_t b)
{
    for (uint32_t e = graph->first[a]; e < graph->first[a + 1]; e++)
        if (graph->edge[e] == b) return true;
    return false;
}

/* row, squared: NEIGHBOURS a point. sparse: square of the distance beyond which parts are. Gives how many links there are. */
static size_t find_links(const plm_graph *graph, const uint32_t *row, const float *squared, double sparse,
                         plm_link *link)
{
    size_t links = 0;
    for (size_t i = 0; i < graph->count; i++) {
        const double own = squared[i * NEIGHBOURS + FOURTH - 1];
        for (size_t j = 0; own > sparse && j < NEIGHBOURS && row[i * NEIGHBOURS + j] != PLM_NO_ROW; j++) {
            const uint32_t other = row[i * NEIGHBOURS + j];
            const double least = fmin(own, squared[other * (size_t)NEIGHBOURS + FOURTH - 1]);
            if (least > sparse && squared[i * NEIGHBOURS + j] <= WIDE * WIDE * least &&
                !is_linked(graph, (uint32_t)i, other))
                link[links++] = (plm_link){(uint32_t)i, other, 0};
        }
    }
    return links;
}

plm_status plm_graph_widen(plm_graph *graph, plm_error *error)
{
    const size_t count = graph->count;
    if (count <= NEIGHBOURS) return PLM_OK;
    plm_scratch scratch = {.error = error};
    uint32_t *row = plm_scratch_take(&scratch, count * NEIGHBOURS, sizeof *row);
    float *squared = plm_scratch_take(&scratch, count * NEIGHBOURS, sizeof *squared);
    double *fourth = plm_scratch_take(&scratch, count, sizeof *fourth);
    plm_link *link = plm_scratch_take(&scratch, count * NEIGHBOURS, sizeof *link);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) status = plm_neighbour_table(graph->xyz, count, NEIGHBOURS, row, squared, error);
    if (status == PLM_OK) {
        for (size_t i = 0; i < count; i++) fourth[i] = squared[i * NEIGHBOURS + FOURTH - 1];
        const double sparse = SPARSE * SPARSE * plm_order_median(fourth, count);
        const size_t links = find_links(graph, row, squared, sparse, link);
        if ((double)links >= SHARE * (double)count) status = plm_graph_add(graph, link, links, error);
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}
