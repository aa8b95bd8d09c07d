/* traits/leaf_midrib.c: the midrib as the way from the junction to the tip that is furthest along the leaf: shortest paths
 * in a neighbour graph over the leaf's smooth surface (compound leaves: and along the petiole and rachis), straightened
 * by a low polynomial. */
#include "traits/leaf_midrib.h"

#include "cloud/linear.h"
#include "traits/petiole_end.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    NODES = 2000, /* of the surface */
    RACHIS_NODES = 600,
    NEIGHBOURS = 12,
    TERMS = 3, /* bends of the line: t (1 - t) times Legendre polynomials up to degree 2 */
    MOST_LEAFLETS = 64,
    COMPOUND_PARTS =
        3, /* connected parts, or leaflets, from which on a leaf on a petiole is taken for a compound one */
    FEWEST_CONTACTS = 4,
    TIP_STEPS = 12
};

static const double large_leaflet = 0.05;  /* share of a leaf's points: less is no leaflet that tells a compound one */
static const double contact_share = 0.005; /* of the nodes: those nearest to the petiole make the junction */
/* Spacings of nodes around the mean of these contacts outward and aside within which the blade ends: the lobes of a
 * heart-shaped base lie further aside. */
static const double contact_reach = 2.5, contact_aside = 1.0;

/* Where a found label has a petiole end and its blade begin, per thickness of the petiole, and at most per root of
 * the leaf's area: standard error on virtual plants. */
static const double junction_share = 0.8, junction_most = 0.15;

/* Nodes within this share of the furthest distance, and this near to the furthest one, make the tip. */
static const double tip_share = 0.03, tip_reach = 0.15, settled = 1e-3;
static const double wide_share = 0.06, wide_reach = 0.25; /* the same, of those that tell its middle across */
static const double pointed_share = 0.03;                 /* of the furthest distance: the former spread less across */
static const double most_shift = 2;                       /* spreads of the former by which the latter may move it */

/** Nodes and shortest ways from the first one. */
typedef struct way {
    size_t count, surface; /* nodes; the first so many are of the surface, the others of the petiole */
    float (*xyz)[3];
    double *distance;
    uint32_t *before; /* node that comes before on the way; a node itself at the start */
} way;

static void free_way(way *w)
{
    plm_free(w->xyz);
    plm_free(w->distance);
    plm_free(w->before);
}

static plm_status gather_nodes(const plm_mesh *mesh, const plm_organ *petiole, way *w, plm_error *error)
{
    const size_t surface = mesh->vertex_count < NODES ? mesh->vertex_count : NODES;
    const size_t rachis = !petiole ? 0 : petiole->count < RACHIS_NODES ? petiole->count : RACHIS_NODES;
    w->count = surface + rachis;
    w->surface = surface;
    w->xyz = plm_alloc(w->count, sizeof *w->xyz, error);
    w->distance = plm_alloc(w->count, sizeof *w->distance, error);
    w->before = plm_alloc(w->count, sizeof *w->before, error);
    if (!w->xyz || !w->distance || !w->before) return PLM_E_MEMORY;
    for (size_t j = 0; j < surface; j++)
        for (int i = 0; i < 3; i++) w->xyz[j][i] = (float)mesh->vertex[j * mesh->vertex_count / surface][i];
    for (size_t j = 0; j < rachis; j++)
        memcpy(w->xyz[surface + j], petiole->xyz[j * petiole->count / rachis], sizeof *w->xyz);
    return PLM_OK;
}

static double gap_between(const float a[3], const float b[3])
{
    return sqrt(((double)a[0] - b[0]) * ((double)a[0] - b[0]) + ((double)a[1] - b[1]) * ((double)a[1] - b[1]) +
                ((double)a[2] - b[2]) * ((double)a[2] - b[2]));
}

/* The shortest jump from what was reached to what was not: parts of a leaf that nothing joins. */
static size_t bridge(way *w, const bool *done)
{
    size_t to = 0, from = 0;
    double least = INFINITY;
    for (size_t j = 0; j < w->count; j++) {
        if (done[j]) continue;
        for (size_t i = 0; i < w->count; i++) {
            if (!done[i]) continue;
            const double gap = gap_between(w->xyz[i], w->xyz[j]);
            if (gap < least) least = gap, from = i, to = j;
        }
    }
    w->distance[to] = w->distance[from] + least;
    w->before[to] = (uint32_t)from;
    return to;
}

/* Dijkstra's shortest ways from start; some thousand nodes need no heap. */
static void spread(way *w, const uint32_t *neighbour, const float *squared, bool *done, size_t start)
{
    for (size_t j = 0; j < w->count; j++) w->distance[j] = INFINITY, w->before[j] = (uint32_t)j, done[j] = false;
    w->distance[start] = 0;
    for (size_t round = 0; round < w->count; round++) {
        size_t at = w->count;
        for (size_t j = 0; j < w->count; j++)
            if (!done[j] && isfinite(w->distance[j]) && (at == w->count || w->distance[j] < w->distance[at])) at = j;
        if (at == w->count) at = bridge(w, done);
        done[at] = true;
        for (size_t k = at * NEIGHBOURS; k < (at + 1) * NEIGHBOURS && neighbour[k] != PLM_NO_ROW; k++) {
            const double through = w->distance[at] + sqrt((double)squared[k]);
            if (through >= w->distance[neighbour[k]]) continue;
            w->distance[neighbour[k]] = through;
            w->before[neighbour[k]] = (uint32_t)at;
        }
    }
}

static plm_status find_ways(way *w, size_t start, plm_error *error)
{
    plm_index *index = NULL;
    uint32_t *neighbour = plm_alloc(w->count, NEIGHBOURS * sizeof *neighbour, error);
    float *squared = plm_alloc(w->count, NEIGHBOURS * sizeof *squared, error);
    bool *done = plm_alloc(w->count, sizeof *done, error);
    plm_status status = neighbour && squared && done ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) status = plm_index_build((const float(*)[3])w->xyz, w->count, &index, error);
    if (status == PLM_OK) status = plm_index_table(index, NEIGHBOURS, neighbour, squared, error);
    if (status == PLM_OK) spread(w, neighbour, squared, done, start);
    plm_index_free(index);
    plm_free(neighbour);
    plm_free(squared);
    plm_free(done);
    return status;
}

typedef struct contact {
    double distance;
    size_t node;
} contact;

static int compare_contacts(const void *a, const void *b)
{
    const contact *x = a, *y = b;
    if (x->distance != y->distance) return x->distance < y->distance ? -1 : 1;
    return (x->node > y->node) - (x->node < y->node);
}

/* Mean of the nearest ones; gives the nearest of all. Sorts them. */
static size_t mean_of_contacts(const way *w, contact *contacts, size_t count, double mean[3])
{
    qsort(contacts, count, sizeof *contacts, compare_contacts);
    size_t used = (size_t)(contact_share * (double)count);
    if (used < FEWEST_CONTACTS) used = FEWEST_CONTACTS < count ? FEWEST_CONTACTS : count;
    memset(mean, 0, 3 * sizeof *mean);
    for (size_t j = 0; j < used; j++)
        for (int i = 0; i < 3; i++) mean[i] += w->xyz[contacts[j].node][i] / (double)used;
    return contacts[0].node;
}

/* Mean of the nodes [0, count) nearest to a place, and the nearest of all. */
static plm_status nearest_nodes(const way *w, size_t count, const double place[3], double mean[3], size_t *nearest,
                                plm_error *error)
{
    contact *contacts = plm_alloc(count, sizeof *contacts, error);
    if (!contacts) return PLM_E_MEMORY;
    const float at[3] = {(float)place[0], (float)place[1], (float)place[2]};
    for (size_t j = 0; j < count; j++) contacts[j] = (contact){gap_between(w->xyz[j], at), j};
    *nearest = mean_of_contacts(w, contacts, count, mean);
    plm_free(contacts);
    return PLM_OK;
}

/* Where nodes [first, end) come nearest to an organ: mean of the nearest ones, and the node nearest of all. */
static plm_status find_contact(const way *w, size_t first, size_t end, const plm_organ *organ, double place[3],
                               size_t *nearest, plm_error *error)
{
    const size_t count = end - first;
    contact *contacts = plm_alloc(count, sizeof *contacts, error);
    if (!contacts) return PLM_E_MEMORY;
    for (size_t j = 0; j < count; j++) {
        float squared;
        plm_index_nearest(organ->index, w->xyz[first + j], 1, NULL, &squared);
        contacts[j] = (contact){squared, first + j};
    }
    *nearest = mean_of_contacts(w, contacts, count, place);
    plm_free(contacts);
    return PLM_OK;
}

/* The stem that comes nearest to an organ's points. */
static const plm_organ *nearest_stem(const plm_scene *scene, const plm_organ *organ)
{
    const plm_organ *best = NULL;
    float least = INFINITY;
    for (size_t i = 0; i < scene->organ_count; i++) {
        const plm_organ *stem = &scene->organ[i];
        if (stem->label != PLM_LABEL_STEM || !stem->index) continue;
        const size_t step = organ->count / 500 + 1;
        for (size_t j = 0; j < organ->count; j += step) {
            float squared;
            plm_index_nearest(stem->index, organ->xyz[j], 1, NULL, &squared);
            if (squared < least) least = squared, best = stem;
        }
    }
    return best;
}

/* ---- The line --------------------------------------------------------------------------------------------------- */

static void bends_at(double t, double term[TERMS])
{
    const double x = 2 * t - 1;
    term[0] = t * (1 - t);
    term[1] = term[0] * x;
    term[2] = term[0] * 0.5 * (3 * x * x - 1);
}

/* A line from base to tip through the nodes of the way that ends at node last, as far back as node `first` (where the
 * way starts, when it is not met). */
static void draw_line(const way *w, size_t first, size_t last, const double base[3], const double tip[3],
                      plm_midrib_line *line)
{
    const double from = w->distance[first], whole = fmax(w->distance[last] - from, 1e-12);
    double normal[TERMS * TERMS] = {0}, right[3][TERMS] = {{0}};
    for (size_t at = last;; at = w->before[at]) {
        const double t = (w->distance[at] - from) / whole;
        double term[TERMS];
        if (t < 0) break;
        bends_at(t, term);
        for (int a = 0; a < TERMS; a++) {
            for (int b = 0; b <= a; b++) normal[a * TERMS + b] += term[a] * term[b];
            for (int i = 0; i < 3; i++) right[i][a] += term[a] * (w->xyz[at][i] - base[i] - t * (tip[i] - base[i]));
        }
        if (w->before[at] == at) break;
    }
    for (int a = 0; a < TERMS; a++) normal[a * TERMS + a] += 1e-9; /* ways of two or three nodes stay straight */
    for (int i = 0; i < 3; i++) {
        double matrix[TERMS * TERMS];
        memcpy(matrix, normal, sizeof matrix);
        if (!plm_solve_spd(TERMS, matrix, right[i])) memset(right[i], 0, sizeof right[i]);
    }
    line->length = 0;
    for (int k = 0; k < PLM_MIDRIB_STATIONS; k++) {
        const double t = (double)k / (PLM_MIDRIB_STATIONS - 1);
        double term[TERMS], step[3];
        bends_at(t, term);
        for (int i = 0; i < 3; i++) {
            line->at[k][i] = base[i] + t * (tip[i] - base[i]);
            for (int a = 0; a < TERMS; a++) line->at[k][i] += right[i][a] * term[a];
            step[i] = k ? line->at[k][i] - line->at[k - 1][i] : 0;
        }
        line->length += plm_norm(step);
    }
}

static size_t furthest_node(const way *w)
{
    size_t best = 0;
    for (size_t j = 1; j < w->surface; j++)
        if (w->distance[j] > w->distance[best]) best = j;
    return best;
}

/* The node of the surface nearest to a place, of those nearly as far as the furthest one: a rolled leaf may lie beside itself. */
static size_t nearest_far_node(const way *w, size_t last, const double place[3])
{
    const float at[3] = {(float)place[0], (float)place[1], (float)place[2]};
    size_t best = last;
    for (size_t j = 0; j < w->surface; j++)
        if (w->distance[j] >= (1 - wide_share) * w->distance[last] &&
            gap_between(w->xyz[j], at) < gap_between(w->xyz[best], at))
            best = j;
    return best;
}

/* How far the surface reaches from a place in a direction, at most `most`, among its vertices that are within `aside` of that
 * line. Nodes are only some of the
 * vertices: the outermost of them lies inside by as much as they lie apart. */
static double reach_from(const plm_mesh *mesh, const double place[3], const double direction[3], double most,
                         double aside)
{
    double furthest = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double d[3];
        for (int i = 0; i < 3; i++) d[i] = mesh->vertex[v][i] - place[i];
        const double along = plm_dot(d, direction), across = sqrt(fmax(plm_dot(d, d) - along * along, 0));
        if (along <= most && across <= aside) furthest = fmax(furthest, along);
    }
    return furthest;
}

/* Whether a node of the surface is so far out, and within reach of the place. */
static bool is_of_end(const way *w, size_t node, double near_far, double reach, const double place[3])
{
    const float at[3] = {(float)place[0], (float)place[1], (float)place[2]};
    return w->distance[node] >= near_far && gap_between(w->xyz[node], at) <= reach;
}

/* Mean of the nodes that are nearly as far as the furthest one and within reach of the place; gives their number. */
static double mean_of_far(const way *w, double near_far, double reach, const double place[3], double mean[3])
{
    double count = 0;
    memset(mean, 0, 3 * sizeof *mean);
    for (size_t j = 0; j < w->surface; j++) {
        if (!is_of_end(w, j, near_far, reach, place)) continue;
        for (int i = 0; i < 3; i++) mean[i] += w->xyz[j][i];
        count++;
    }
    for (int i = 0; i < 3 && count > 0; i++) mean[i] /= count;
    return count;
}

/* The middle of the nodes that are at least a share of the furthest one's distance away, sought in steps from there. */
static void middle_of_far(const way *w, size_t last, double share, double reach, double middle[3])
{
    const double far = w->distance[last];
    for (int i = 0; i < 3; i++) middle[i] = w->xyz[last][i];
    for (int step = 0; step < TIP_STEPS; step++) {
        double mean[3];
        if (!(mean_of_far(w, (1 - share) * far, reach * far, middle, mean) > 0)) return;
        const double moved = plm_distance(mean, middle);
        memcpy(middle, mean, sizeof mean);
        if (moved < settled * far) return;
    }
}

/* RMS distance, along a direction, of the nodes about a middle from it. */
static double spread_along(const way *w, double near_far, double reach, const double middle[3],
                           const double direction[3])
{
    double squares = 0, count = 0;
    for (size_t j = 0; j < w->surface; j++) {
        if (!is_of_end(w, j, near_far, reach, middle)) continue;
        double off = 0;
        for (int i = 0; i < 3; i++) off += (w->xyz[j][i] - middle[i]) * direction[i];
        squares += off * off;
        count++;
    }
    return count > 0 ? sqrt(squares / count) : 0;
}

/* The tip: in the middle, across the leaf, of the nodes that are nearly as far as the furthest one, and as far out as
 * the surface reaches there. The furthest one alone lies anywhere along a round end: more nodes tell the middle across,
 * fewer how far the leaf goes. Of compound leaves as few tell both: other leaflets end near by. Gives how far the end
 * spreads across (RMS), by which the tip is unsure. */
static double place_tip(const way *w, const plm_leaf_surface *surface, size_t last, bool compound, const double base[3],
                        double tip[3])
{
    const double far = w->distance[last], reach = tip_reach * far;
    double middle[3], wide[3], out[3], across[3], shift = 0, wideness = 0;
    middle_of_far(w, last, tip_share, tip_reach, middle);
    middle_of_far(w, last, compound ? tip_share : wide_share, compound ? tip_reach : wide_reach, wide);
    for (int i = 0; i < 3; i++) out[i] = wide[i] - base[i];
    plm_normalise(out);
    plm_cross(surface->plane.normal, out, across);
    if (plm_normalise(across) > 0) {
        wideness = spread_along(w, (1 - tip_share) * far, reach, middle, across);
        for (int i = 0; i < 3; i++) shift += across[i] * (wide[i] - middle[i]);
        shift = fmin(fmax(shift, -most_shift * wideness), most_shift * wideness); /* a pointed tip stays where it is */
        for (int i = 0; i < 3; i++) middle[i] += shift * across[i];
    }
    size_t before = last;
    const bool pointed = wideness < pointed_share * far;
    while (pointed && w->distance[before] > (1 - tip_reach) * far && w->before[before] != before)
        before = w->before[before];
    for (int i = 0; i < 3; i++) out[i] = middle[i] - (pointed ? w->xyz[before][i] : base[i]);
    plm_normalise(out);                                          /* of a pointed leaf as it runs there: it may droop */
    const double around = pointed ? 2 * tip_share * far : reach; /* a rolled leaf may lie beside its tip */
    const double furthest = reach_from(&surface->mesh, middle, out, around, around);
    for (int i = 0; i < 3; i++) tip[i] = middle[i] + furthest * out[i];
    return wideness;
}

/* Moves the junction out to the end of the surface there, but not beyond the petiole's (NULL: there is none): the mean of contacts
 * lies inside by their own spread. */
static void move_base(const plm_mesh *mesh, double area, const double tip[3], const double *end, double base[3])
{
    double out[3], gap[3], node = sqrt(area / NODES);
    for (int i = 0; i < 3; i++) out[i] = base[i] - tip[i];
    plm_normalise(out);
    double furthest = reach_from(mesh, base, out, contact_reach * node, contact_aside * node);
    for (int i = 0; i < 3 && end; i++) gap[i] = end[i] - base[i];
    if (end) furthest = fmin(furthest, fmax(plm_dot(gap, out), 0));
    for (int i = 0; i < 3; i++) base[i] += furthest * out[i];
}

static double error_of_ends(const plm_leaf_surface *surface)
{
    return hypot(surface->spacing, surface->noise);
}

/* ---- Simple and compound leaves ---------------------------------------------------------------------------------- */

static plm_status simple_midrib(const plm_scene *scene, const plm_organ *leaf, const plm_organ *holder, plm_midrib *out,
                                plm_error *error)
{
    way w = {0};
    size_t start = 0;
    plm_midrib_line line;
    plm_status status = gather_nodes(&leaf->surface.mesh, NULL, &w, error);
    double end[3];
    bool ends = holder->label == PLM_LABEL_PETIOLE;
    if (status == PLM_OK && ends)
        status = plm_petiole_end(holder, nearest_stem(scene, holder), leaf, end, &ends, error);
    if (status == PLM_OK)
        status = ends ? nearest_nodes(&w, w.surface, end, out->base, &start, error)
                      : find_contact(&w, 0, w.surface, holder, out->base, &start, error);
    if (status == PLM_OK) status = find_ways(&w, start, error);
    if (status == PLM_OK) {
        size_t last = furthest_node(&w);
        out->tip_spread = place_tip(&w, &leaf->surface, last, false, out->base, out->tip);
        last = nearest_far_node(&w, last, out->tip);
        move_base(&leaf->surface.mesh, leaf->surface.area, out->tip, ends ? end : NULL, out->base);
        draw_line(&w, start, last, out->base, out->tip, &line);
        out->length = line.length;
        status = plm_midrib_width(&leaf->surface.mesh, &line, &out->width, error);
    }
    free_way(&w);
    out->method = "way along the surface";
    return status;
}

/* Extent of a mesh in its plane across a direction. */
static double extent_across(const plm_leaf_surface *surface, const double direction[3])
{
    double across[3], low = INFINITY, high = -INFINITY;
    plm_cross(surface->plane.normal, direction, across);
    plm_normalise(across);
    for (size_t v = 0; v < surface->mesh.vertex_count; v++) {
        const double d = plm_dot(surface->mesh.vertex[v], across);
        low = fmin(low, d);
        high = fmax(high, d);
    }
    return fmax(high - low, 0);
}

/* The node of the rachis at which the first leaflet hangs: of all leaf nodes in touch with the rachis, the one whose
 * nearest rachis node comes first. */
static size_t first_junction(const way *w, double touch)
{
    size_t first = furthest_node(w);
    for (size_t j = 0; j < w->surface; j++) {
        size_t nearest = w->surface;
        double least = touch;
        for (size_t k = w->surface; k < w->count; k++) {
            const double gap = gap_between(w->xyz[j], w->xyz[k]);
            if (gap < least) least = gap, nearest = k;
        }
        if (nearest < w->count && least < touch && w->distance[nearest] < w->distance[first]) first = nearest;
    }
    return first;
}

static plm_status compound_midrib(const plm_scene *scene, const plm_organ *leaf, const plm_organ *petiole,
                                  plm_midrib *out, plm_error *error)
{
    way w = {0};
    size_t start = 0;
    plm_midrib_line line;
    const plm_organ *stem = nearest_stem(scene, petiole);
    plm_status status = gather_nodes(&leaf->surface.mesh, petiole, &w, error);
    if (status == PLM_OK && !stem) status = plm_fail(error, PLM_E_DEGENERATE, "no stem to which the leaf belongs");
    if (status == PLM_OK) status = find_contact(&w, w.surface, w.count, stem, out->base, &start, error);
    if (status == PLM_OK) status = find_ways(&w, start, error);
    if (status == PLM_OK) {
        const size_t last = furthest_node(&w);
        const double touch = 3 * hypot(petiole->sampling.spacing, leaf->surface.spacing) + petiole->sampling.noise;
        const size_t first = first_junction(&w, touch);
        double junction[3], direction[3];
        for (int i = 0; i < 3; i++) junction[i] = w.xyz[first][i];
        out->tip_spread = place_tip(&w, &leaf->surface, last, true, junction, out->tip);
        for (int i = 0; i < 3; i++) direction[i] = out->tip[i] - junction[i];
        draw_line(&w, first, last, junction, out->tip, &line);
        out->length = line.length;
        out->width = extent_across(&leaf->surface, direction);
    }
    free_way(&w);
    out->compound = true;
    out->method = "way along rachis and surface";
    return status;
}

/* Thickness of a stem or petiole: points on a tube of radius r vary by r^2 / 2 across it; the least of the three variances is
 * that across a bend's plane. */
static double thickness_of(const plm_organ *tube)
{
    double moment[6] = {0}, value[3], axis[3][3];
    for (size_t j = 0; j < tube->count; j++)
        for (int i = 0, k = 0; i < 3; i++)
            for (int m = i; m < 3; m++)
                moment[k++] += (tube->xyz[j][i] - tube->centroid[i]) * (tube->xyz[j][m] - tube->centroid[m]);
    for (int k = 0; k < 6; k++) moment[k] /= (double)tube->count;
    plm_eigen3(moment, value, axis);
    return 2 * sqrt(2 * fmax(value[2], 0));
}

/* Leaflets told apart by the labels that hold a part of the leaf's points worth the name. */
static size_t count_large_leaflets(const plm_organ *leaf)
{
    size_t points[MOST_LEAFLETS] = {0}, large = 0;
    for (size_t j = 0; leaf->leaflet && j < leaf->count; j++)
        if (leaf->leaflet[j] >= 0 && leaf->leaflet[j] < MOST_LEAFLETS) points[leaf->leaflet[j]]++;
    for (int k = 0; k < MOST_LEAFLETS; k++) large += (double)points[k] > large_leaflet * (double)leaf->count;
    return large;
}

plm_status plm_midrib_find(const plm_scene *scene, const plm_organ *leaf, plm_midrib **midrib, plm_error *error)
{
    const plm_organ *petiole = plm_scene_organ(scene, PLM_LABEL_PETIOLE, leaf->id);
    const bool has_parts =
        leaf->surface.component_count >= COMPOUND_PARTS || count_large_leaflets(leaf) >= COMPOUND_PARTS;
    const bool compound = petiole && petiole->index && has_parts;
    const plm_organ *holder = petiole && petiole->index ? petiole : nearest_stem(scene, leaf);
    if (!holder) return plm_fail(error, PLM_E_DEGENERATE, "neither a petiole nor a stem tells where the leaf begins");
    plm_midrib *made = plm_alloc_zero(1, sizeof *made, error);
    if (!made) return PLM_E_MEMORY;
    const plm_status status =
        compound ? compound_midrib(scene, leaf, petiole, made, error) : simple_midrib(scene, leaf, holder, made, error);
    made->end_error = error_of_ends(&leaf->surface);
    made->thickness = thickness_of(holder);
    made->on_stem = holder->label == PLM_LABEL_STEM;
    made->junction_error =
        scene->labels_given ? 0 : fmin(junction_share * made->thickness, junction_most * sqrt(leaf->surface.area));
    made->length_error = hypot(hypot(1.5 * made->end_error, 0.014 * made->length), made->junction_error);
    made->width_error = hypot(made->end_error, 0.014 * made->width);
    if (status == PLM_OK)
        *midrib = made;
    else
        plm_free(made);
    return status;
}
