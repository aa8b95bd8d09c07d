/* segment/stem_path.c: the main stem: the cheapest way from the base to its top (stem_top.c), where thick tubes are cheap and
 * blades dear; cut where it becomes as thin as a petiole; centred, and its radius measured along it. */
#include "cloud/linear.h"
#include "segment/scratch.h"
#include "segment/stem_fit.h"
#include "segment/stem_top.h"

#include <string.h>

static const double THICK = 0.5; /* of the stem's radius: a tube that may be stem */
static const double COST_LEAST = 0.25, COST_MOST = 16, COST_BLADE = 60;
static const double THIN_END = 0.55; /* of the lower stem's radius: the stem has become a petiole */
/* A stem that tapers goes on where it is so thick against what its lower part's taper gives there, while it turns (radians) less. */
static const double TAPERED = 0.7, STRAIGHT = 0.21; /* the latter as KINK in stem_kink.c */
static const double TAPER = 0.65;      /* of the lower stem's radius: less no taper says; as in stem_top.c */
static const double LOWER_SHARE = 0.6; /* of the path: where the stem's radius is taken from */
static const double FOOT_SHARE = 0.2;  /* of the path: the foot, which is bare */
static const double RISE_LEAST = 0.2, RISE_ASKED = 0.15; /* of the size: less is no stem; asked for by the user */
static const double PIECE_SHARE = 0.2;                /* of the longest piece of tube: the base is on such a one, ... */
static const double PIECE_LEAST = 2, PIECE_GAP = 2.5; /* ... or on an upright one of this length so far below, in R */
static const double STEP = 0.25;                      /* nodes, in R */
static const double WINDOW = 1;                       /* half window of centring and of the radius, in R */
static const double REACH = 2;                        /* points within so many stem radii centre the path */
static const double MARGIN = 1.1;                     /* points within so many radii (plus sigma) are stem */
static const double MARGIN_BLADE = 1.15;              /* the same for points that look like blade */
enum { CENTRING_ROUNDS = 3, STRAIGHT_NODES = 6 /* before the end: arms of a turn */, ARM_LEAST = 3 };

/* ---- The path over points ------------------------------------------------------------------------------------- */

static bool is_thick(const plm_sketch *sketch, size_t i)
{
    return sketch->is_tube[i] && sketch->point[i].radius > THICK * sketch->scale.stem_radius;
}

/* Lowest and highest thick tube point of the tube network that is largest, among those that the walk reached. */
static uint32_t extreme_point(const plm_sketch *sketch, const bool *candidate, bool highest)
{
    uint32_t best = UINT32_MAX;
    for (uint32_t i = 0; i < sketch->working.count; i++) {
        if (!candidate[i]) continue;
        const float z = sketch->working.xyz[i][2];
        if (best == UINT32_MAX || (highest ? z > sketch->working.xyz[best][2] : z < sketch->working.xyz[best][2]))
            best = i;
    }
    return best;
}

static plm_status tube_walk(const plm_sketch *sketch, uint32_t base, plm_tube_ways *ways, plm_error *error)
{
    float *weight = plm_alloc(sketch->working.count, sizeof *weight, error);
    if (!weight) return PLM_E_MEMORY;
    for (size_t i = 0; i < sketch->working.count; i++) {
        const double ratio = sketch->scale.stem_radius / fmax(sketch->point[i].radius, 1e-3 * sketch->scale.radius);
        weight[i] = (float)(sketch->is_tube[i] ? fmin(fmax(ratio * ratio, COST_LEAST), COST_MOST) : COST_BLADE);
    }
    const plm_walk walk = {.source = &base,
                           .source_count = 1,
                           .weight = weight,
                           .distance = ways->distance,
                           .parent = ways->parent,
                           .order = ways->order,
                           .reached = &ways->reached};
    const plm_status status = plm_graph_walk(&sketch->graph, &walk, error);
    plm_free(weight);
    return status;
}

/** A component of tube. */
typedef struct tube_piece {
    double length;
    float low[3], high[3]; /* its lowest and highest thick points */
    bool has_thick, is_candidate;
} tube_piece;

static void measure_pieces(const plm_sketch *sketch, const int32_t *component, tube_piece *piece)
{
    const double cell = sketch->working.cell;
    for (size_t i = 0; i < sketch->working.count; i++) {
        if (component[i] < 0) continue;
        const float *at = sketch->working.xyz[i];
        tube_piece *p = &piece[component[i]];
        p->length += cell * cell / (2 * PLM_PI * fmax(sketch->point[i].radius, 0.1 * sketch->scale.stem_radius));
        if (!is_thick(sketch, i)) continue;
        if (!p->has_thick || at[2] < p->low[2]) memcpy(p->low, at, sizeof p->low);
        if (!p->has_thick || at[2] > p->high[2]) memcpy(p->high, at, sizeof p->high);
        p->has_thick = true;
    }
}

/* Whether a piece stands upright below a point, a gap apart. */
static bool is_below(const plm_sketch *sketch, const tube_piece *p, const float point[3])
{
    const double R = sketch->scale.radius, rise = (double)p->high[2] - p->low[2];
    const double gap[3] = {point[0] - p->high[0], point[1] - p->high[1], point[2] - p->high[2]};
    return p->has_thick && rise >= PIECE_LEAST * R && plm_norm(gap) < PIECE_GAP * R &&
           hypot((double)p->high[0] - p->low[0], (double)p->high[1] - p->low[1]) < rise;
}

/* Pieces that are long against the longest may hold the stem's base: specks called tube shall not. Nor do they where a gap in
 * the scan leaves a piece of the stem below the others. */
static void choose_pieces(const plm_sketch *sketch, tube_piece *piece, size_t count)
{
    double longest = 0;
    for (size_t c = 0; c < count; c++) longest = fmax(longest, piece[c].length);
    const tube_piece *lowest = NULL;
    for (size_t c = 0; c < count; c++) {
        piece[c].is_candidate = piece[c].has_thick && piece[c].length >= PIECE_SHARE * longest;
        if (piece[c].is_candidate && (!lowest || piece[c].low[2] < lowest->low[2])) lowest = &piece[c];
    }
    for (size_t c = 0; lowest && c < count; c++) {
        if (piece[c].is_candidate || !is_below(sketch, &piece[c], lowest->low)) continue;
        piece[c].is_candidate = true;
        lowest = &piece[c];
        c = SIZE_MAX; /* what is below that, from the first on */
    }
}

/* Thick tube points of the pieces of tube that may be of the stem. */
static plm_status find_candidates(const plm_sketch *sketch, bool *candidate, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    int32_t *colour = plm_scratch_take(&scratch, count, sizeof *colour);
    int32_t *component = plm_scratch_take(&scratch, count, sizeof *component);
    uint32_t *stack = plm_scratch_take(&scratch, count, sizeof *stack);
    tube_piece *piece = plm_scratch_take(&scratch, count, sizeof *piece);
    if (!scratch.failed) {
        for (size_t i = 0; i < count; i++) colour[i] = sketch->is_tube[i] ? 0 : -1;
        const size_t components = plm_graph_components(&sketch->graph, colour, component, stack);
        measure_pieces(sketch, component, piece);
        choose_pieces(sketch, piece, components);
        for (size_t i = 0; i < count; i++)
            candidate[i] = component[i] >= 0 && is_thick(sketch, i) && piece[component[i]].is_candidate;
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* ---- The centre line ------------------------------------------------------------------------------------------ */

double plm_stem_nearest(const plm_stem_path *stem, const float xyz[3], plm_stem_place *place)
{
    double best = INFINITY;
    for (size_t k = 0; k + 1 < stem->count; k++) {
        const double *p = stem->node[k], *q = stem->node[k + 1];
        const double d[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        const double w[3] = {xyz[0] - p[0], xyz[1] - p[1], xyz[2] - p[2]};
        const double length2 = plm_dot(d, d);
        /* Its start is farther than the best and its length together: (a + b)^2 <= 2 (a^2 + b^2), .001 for rounding. */
        if (plm_dot(w, w) > 2.001 * (best + length2)) continue;
        double t = length2 > 0 ? plm_dot(w, d) / length2 : 0;
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        const double r[3] = {w[0] - t * d[0], w[1] - t * d[1], w[2] - t * d[2]};
        const double here = plm_dot(r, r);
        if (here >= best) continue;
        best = here;
        place->radius = stem->radius[k] + t * (stem->radius[k + 1] - stem->radius[k]);
        place->along = stem->along[k] + t * (stem->along[k + 1] - stem->along[k]);
        memcpy(place->offset, r, sizeof r);
    }
    return sqrt(best);
}

void plm_stem_path_free(plm_stem_path *path)
{
    plm_free(path->node);
    plm_free(path->radius);
    plm_free(path->along);
    *path = (plm_stem_path){0};
}

void plm_stem_measure_along(plm_stem_path *stem)
{
    stem->along[0] = 0;
    for (size_t k = 1; k < stem->count; k++) {
        double d[3];
        for (int axis = 0; axis < 3; axis++) d[axis] = stem->node[k][axis] - stem->node[k - 1][axis];
        stem->along[k] = stem->along[k - 1] + plm_norm(d);
    }
}

double plm_stem_mean_radius(const plm_stem_path *stem, size_t first, size_t end)
{
    double sum = 0;
    for (size_t n = first; n < end; n++) sum += stem->radius[n];
    return sum / (double)(end - first);
}

/* Nodes at equal steps along a chain of points given from the base up. */
static plm_status resample(const plm_sketch *sketch, const uint32_t *chain, size_t length, plm_stem_path *stem,
                           plm_error *error)
{
    const double step = STEP * sketch->scale.radius;
    double total = 0;
    for (size_t k = 1; k < length; k++) total += plm_graph_length(&sketch->graph, chain[k - 1], chain[k]);
    stem->count = (size_t)ceil(total / step) + 1;
    if (stem->count < 4) stem->count = 4;
    stem->node = plm_alloc(stem->count, sizeof *stem->node, error);
    stem->radius = plm_alloc_zero(stem->count, sizeof *stem->radius, error);
    stem->along = plm_alloc_zero(stem->count, sizeof *stem->along, error);
    if (!stem->node || !stem->radius || !stem->along) return PLM_E_MEMORY;
    double at = 0; /* arc length at chain[k] */
    size_t k = 0;
    for (size_t n = 0; n < stem->count; n++) {
        const double wanted = total * (double)n / (double)(stem->count - 1);
        double piece = 0;
        while (k + 1 < length && at + (piece = plm_graph_length(&sketch->graph, chain[k], chain[k + 1])) < wanted) {
            at += piece;
            k++;
        }
        const uint32_t a = chain[k], b = chain[k + 1 < length ? k + 1 : k];
        const double t = piece > 0 ? fmin((wanted - at) / piece, 1) : 0;
        for (int axis = 0; axis < 3; axis++)
            stem->node[n][axis] = sketch->working.xyz[a][axis] +
                                  t * ((double)sketch->working.xyz[b][axis] - sketch->working.xyz[a][axis]);
    }
    plm_stem_measure_along(stem);
    return PLM_OK;
}

void plm_stem_smooth(plm_stem_path *stem, size_t reach, double (*buffer)[3])
{
    memcpy(buffer, stem->node, stem->count * sizeof *buffer);
    for (size_t n = 0; n < stem->count; n++) {
        size_t w = reach;
        if (n < w) w = n;
        if (stem->count - 1 - n < w) w = stem->count - 1 - n;
        for (int axis = 0; axis < 3; axis++) {
            double sum = 0;
            for (size_t j = n - w; j <= n + w; j++) sum += buffer[j][axis];
            stem->node[n][axis] = sum / (double)(2 * w + 1);
        }
    }
    plm_stem_measure_along(stem);
}

/* Moves each node to the mean of the tube points around it, across the stem only. */
static void centre_nodes(const plm_sketch *sketch, plm_stem_path *stem, double reach, double (*sum)[4])
{
    memset(sum, 0, stem->count * sizeof *sum);
    const double window = WINDOW * sketch->scale.radius;
    for (size_t i = 0; i < sketch->working.count; i++) {
        if (!sketch->is_tube[i]) continue;
        plm_stem_place place;
        if (plm_stem_nearest(stem, sketch->working.xyz[i], &place) > reach) continue;
        for (size_t n = 0; n < stem->count; n++) {
            const double w = 1 - fabs(stem->along[n] - place.along) / window;
            if (w <= 0) continue;
            for (int axis = 0; axis < 3; axis++) sum[n][axis] += w * sketch->working.xyz[i][axis];
            sum[n][3] += w;
        }
    }
    for (size_t n = 0; n < stem->count; n++) {
        if (!(sum[n][3] > 0)) continue;
        const size_t a = n ? n - 1 : n, b = n + 1 < stem->count ? n + 1 : n;
        double tangent[3], shift[3];
        for (int axis = 0; axis < 3; axis++) {
            tangent[axis] = stem->node[b][axis] - stem->node[a][axis];
            shift[axis] = sum[n][axis] / sum[n][3] - stem->node[n][axis];
        }
        plm_normalise(tangent);
        const double forward = plm_dot(shift, tangent);
        /* stored in place of the sums, since the nodes are still needed for tangents */
        for (int axis = 0; axis < 3; axis++) sum[n][axis] = stem->node[n][axis] + shift[axis] - forward * tangent[axis];
    }
    for (size_t n = 0; n < stem->count; n++)
        if (sum[n][3] > 0) memcpy(stem->node[n], sum[n], sizeof stem->node[n]);
}

/* Radius at each node: the median distance of the tube points around it from the line. */
static plm_status measure_radius(const plm_sketch *sketch, plm_stem_path *stem, double reach, plm_error *error)
{
    const size_t count = sketch->working.count;
    plm_scratch scratch = {.error = error};
    float *distance = plm_scratch_take(&scratch, count, sizeof *distance);
    float *along = plm_scratch_take(&scratch, count, sizeof *along);
    float *value = plm_scratch_take(&scratch, count, sizeof *value);
    float *radius = plm_scratch_take(&scratch, stem->count, sizeof *radius);
    if (!scratch.failed) {
        size_t near = 0;
        for (size_t i = 0; i < count; i++) {
            if (!sketch->is_tube[i]) continue;
            plm_stem_place place;
            const double d = plm_stem_nearest(stem, sketch->working.xyz[i], &place);
            if (d > reach) continue;
            distance[near] = (float)d;
            along[near++] = (float)place.along;
        }
        for (size_t n = 0; n < stem->count; n++) {
            size_t members = 0;
            for (size_t i = 0; i < near; i++)
                if (fabs(along[i] - stem->along[n]) < WINDOW * sketch->scale.radius) value[members++] = distance[i];
            radius[n] = members ? plm_quantile(value, members, 0.5) : (float)sketch->scale.stem_radius;
        }
        for (size_t n = 0; n < stem->count; n++) { /* running median of five */
            size_t members = 0;
            for (size_t j = n < 2 ? 0 : n - 2; j <= n + 2 && j < stem->count; j++) value[members++] = radius[j];
            stem->radius[n] = plm_quantile(value, members, 0.5);
        }
    }
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* Radius at a node without the noise, whose squared SD is noise2. */
static double bare_radius(const plm_stem_path *stem, size_t n, double noise2)
{
    return sqrt(fmax(stem->radius[n] * stem->radius[n] - noise2, 0));
}

/* The end of a path that was cut at node end, farther on where the stem tapers: as far as it is straight and not much thinner than
 * the taper of its nodes [0, lower) says, which falls to a share of their radius at most. */
static size_t follow_taper(const plm_stem_path *stem, size_t lower, size_t end, double noise2)
{
    double along = 0, radius = 0, squares = 0, product = 0;
    for (size_t n = 0; n < lower; n++) {
        along += stem->along[n] / (double)lower;
        radius += bare_radius(stem, n, noise2) / (double)lower;
    }
    for (size_t n = 0; n < lower; n++) {
        const double d = stem->along[n] - along;
        squares += d * d;
        product += d * (bare_radius(stem, n, noise2) - radius);
    }
    if (!(squares > 0) || product >= 0) return end;
    for (size_t n = end > STRAIGHT_NODES ? end - STRAIGHT_NODES : 0; n < stem->count; n++) {
        const double usual = fmax(radius + product / squares * (stem->along[n] - along), TAPER * radius);
        const bool thin = n >= end && bare_radius(stem, n, noise2) < TAPERED * usual;
        const bool told = n >= ARM_LEAST && n + ARM_LEAST < stem->count; /* nearer to an end a turn is scatter */
        if (thin || (told && plm_stem_turn(stem, n) >= STRAIGHT)) return n > end ? n : end;
    }
    return stem->count;
}

/* Cuts the path where the radius has fallen below THIN_END of the lower stem's for good: at the end of the piece over
 * which the excess over that adds up to the most. The noise adds to the squares of both. A stem that tapers goes on. */
static plm_status cut_thin_end(const plm_sketch *sketch, plm_stem_path *stem, plm_error *error)
{
    float *value = plm_alloc(stem->count, sizeof *value, error);
    if (!value) return PLM_E_MEMORY;
    const double noise2 = sketch->scale.noise * sketch->scale.noise;
    const size_t lower = (size_t)(LOWER_SHARE * (double)stem->count);
    for (size_t n = 0; n < lower; n++) value[n] = (float)stem->radius[n];
    const double typical = plm_quantile(value, lower, 0.5);
    const double least = THIN_END * sqrt(fmax(typical * typical - noise2, 0.25 * typical * typical));
    size_t end = lower;
    double sum = 0, most = 0;
    for (size_t n = lower; n < stem->count; n++) {
        sum += bare_radius(stem, n, noise2) - least;
        if (sum > most) most = sum, end = n + 1;
    }
    stem->count = follow_taper(stem, lower, end, noise2);
    plm_free(value);
    return PLM_OK;
}

static plm_status refine(const plm_sketch *sketch, plm_stem_path *stem, plm_error *error)
{
    double(*buffer)[4] = plm_alloc(stem->count, sizeof *buffer, error);
    if (!buffer) return PLM_E_MEMORY;
    const double reach = REACH * sketch->scale.stem_radius + sketch->scale.noise;
    for (int round = 0; round < CENTRING_ROUNDS; round++) {
        plm_stem_smooth(stem, (size_t)(0.75 / STEP), (double(*)[3])buffer);
        centre_nodes(sketch, stem, reach, buffer);
        plm_stem_measure_along(stem);
    }
    plm_free(buffer);
    return measure_radius(sketch, stem, reach, error);
}

void plm_sketch_mark_stem(plm_sketch *sketch)
{
    for (size_t i = 0; i < sketch->working.count; i++) {
        plm_stem_place place;
        const double d = plm_stem_nearest(&sketch->stem, sketch->working.xyz[i], &place);
        const double margin = sketch->is_tube[i] ? MARGIN : MARGIN_BLADE;
        sketch->is_stem[i] = d <= margin * place.radius + sketch->scale.noise;
    }
}

/* No node is thicker than the lowest ones are in the middle: feet that wrap the stem and blades that rise along it are. */
static plm_status cap_radius(plm_stem_path *stem, plm_error *error)
{
    const size_t lowest = (size_t)(FOOT_SHARE * (double)stem->count) + 1;
    float *value = plm_alloc(lowest, sizeof *value, error);
    if (!value) return PLM_E_MEMORY;
    for (size_t n = 0; n < lowest; n++) value[n] = (float)stem->radius[n];
    const double most = plm_quantile(value, lowest, 0.75);
    for (size_t n = 0; n < stem->count; n++) stem->radius[n] = fmin(stem->radius[n], most);
    plm_free(value);
    return PLM_OK;
}

plm_status plm_stem_trace(plm_sketch *sketch, const uint32_t *parent, uint32_t base, uint32_t top, bool tapers,
                          plm_error *error)
{
    plm_stem_path stem = {0};
    size_t length = 0;
    const double least = sketch->asked == PLM_HABIT_UNKNOWN ? RISE_LEAST : RISE_ASKED;
    if (sketch->working.xyz[top][2] - sketch->working.xyz[base][2] < least * sketch->scale.size) return PLM_OK;
    for (uint32_t i = top; i != UINT32_MAX; i = parent[i]) length++;
    uint32_t *chain = plm_alloc(length, sizeof *chain, error);
    if (!chain) return PLM_E_MEMORY;
    size_t k = length;
    for (uint32_t i = top; i != UINT32_MAX; i = parent[i]) chain[--k] = i;
    plm_status status = resample(sketch, chain, length, &stem, error);
    if (status == PLM_OK) status = refine(sketch, &stem, error);
    if (status == PLM_OK && tapers) status = cap_radius(&stem, error);
    if (status == PLM_OK) status = cut_thin_end(sketch, &stem, error);
    if (status == PLM_OK) status = plm_stem_fit(sketch, &stem, error);
    if (status == PLM_OK && tapers) status = cap_radius(&stem, error);
    if (status == PLM_OK) {
        const plm_stem_path old = sketch->stem;
        sketch->stem = stem;
        stem = old;
        plm_sketch_mark_stem(sketch);
    }
    plm_free(chain);
    plm_stem_path_free(&stem);
    return status;
}

plm_status plm_sketch_stem(plm_sketch *sketch, plm_error *error)
{
    const size_t count = sketch->working.count;
    if (!sketch->scale.has_tubes) return PLM_OK;
    if (plm_leaves_look_like_tubes(sketch)) return plm_sketch_upright_stem(sketch, error);
    plm_scratch scratch = {.error = error};
    bool *candidate = plm_scratch_take(&scratch, count, sizeof *candidate);
    plm_tube_ways ways = {.distance = plm_scratch_take(&scratch, count, sizeof *ways.distance),
                          .parent = plm_scratch_take(&scratch, count, sizeof *ways.parent),
                          .order = plm_scratch_take(&scratch, count, sizeof *ways.order)};
    plm_status status = scratch.failed ? PLM_E_MEMORY : find_candidates(sketch, candidate, error);
    if (status != PLM_OK) goto done;
    const uint32_t base = extreme_point(sketch, candidate, false);
    if (base == UINT32_MAX) goto done;
    status = tube_walk(sketch, base, &ways, error);
    if (status != PLM_OK) goto done;
    for (size_t i = 0; i < count; i++) candidate[i] = candidate[i] && isfinite(ways.distance[i]);
    uint32_t top = extreme_point(sketch, candidate, true);
    status = plm_stem_top(sketch, &ways, &top, error);
    if (status == PLM_OK) status = plm_stem_trace(sketch, ways.parent, base, top, false, error);
done:
    plm_scratch_free(&scratch, NULL);
    return status;
}
