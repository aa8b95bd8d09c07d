/* segment/junction.c: the blade junction by the widths of a leaf's level sets. The distance along the graph from the foot
 * grows along the petiole and then spreads over the blade, so its level sets are rings as wide as the petiole before the
 * junction and arcs that widen after it (the Reeb graph of that distance: Y. Shinagawa and T. L. Kunii, Constructing a
 * Reeb graph automatically from cross sections, 1991). Classes by balls blur the junction by a ball's radius; a change of
 * the width is told to about a step. */
#include "segment/junction.h"

#include "segment/rachis_line.h"
#include "segment/scratch.h"

#include <math.h>
#include <string.h>

static const double WINDOW = 3;                         /* in steps */
static const double JOINED = 1, JOINED_COMPOUND = 0.25; /* in windows, to both sides: see measure_stations */
static const double WIDE = 1.6;       /* widths of the tube: a station beyond is blade, one below is tube */
static const double TUBE_SHARE = 0.5; /* of a station's points: it is of tube */
static const double FULL = 0.5;       /* of the points that the tube's stations have */
static const double LONG_RUN = 2.5;   /* windows: a narrow stretch of this length is tube, however few its points */
/* Share of the leaf's points that its last leaflet holds at least where balls find no tube before it, and the share where
 * the narrow stretch before it is shorter than so many windows. */
static const double LEAST_LAST = 0.2, LEAST_LAST_SHORT = 0.29, SHORT_RUN = 1.5;
/* The same where nothing but a tube lies about the line, at a few stations and at many. */
static const double LEAST_CLEAR = 0.15, LEAST_SURE = 0.1;
static const double LEAST_LONG = 0.05; /* the same beyond a long clear stretch */
/* Points of a stretch where balls find no tube, or of a long clear one: of a thinly scanned sheet so many would not all lie near
 * the line by chance. With noise of less than so much of the tube's width, points lie evenly, and a gap is one. */
static const double ENOUGH = 25, NOISY = 0.25;
/* Steps of a compound leaf, in links: about what a point takes of a sheet. In shorter ones stations fall apart at gaps. */
static const double STEP_LINKS = 0.65;
static const double WIDEST = 1.15;     /* tubes of the narrowest of the larger leaves: a leaf's tube is no wider */
static const double FAR_WIDER = 1.3;   /* than that, in noise: what a simple leaf shows is its blade */
static const double THINNEST = 0.3;    /* of the stem's radius: tubes are hardly narrower */
static const double FILLED = 0.4;      /* as FULL: with less, where balls find no tube, it is a thinly scanned blade */
static const double BLADE = 2;         /* widths of the tube that the last leaflet reaches at least */
static const double FOOT = 0.35;       /* in R: stations before are cut by the stem */
static const double SUBSTEP = 0.1;     /* of a step, in the search for the change */
static const double NARROW = 0.07;     /* quantile of the widths of a rosette's leaf that is its tube's */
static const double LEAST_BLADE = 0.2; /* share of a simple leaf's points beyond its junction: less is none */
enum {
    CLEAR = 2,        /* stations at which nothing but a tube lies about the line: a rachis, ... */
    SURE = 5,         /* ... and so many: surely */
    LONG_CLEAR = 10,  /* ... and so many, with a small leaflet beyond */
    LARGER_LEAST = 2, /* leaves that tell how wide a smaller one's tube is at most */
    BEFORE = 6,
    AFTER = 9,
    FEWEST_STATIONS = 6,
    STATIONS_MOST = 5000,
    FOOT_STATIONS = 2, /* hold what stands about the foot */
    FEWEST_OF_STATION = 5
};

typedef struct work {
    plm_sketch *sketch;
    const plm_side_groups *groups;
    plm_scratch scratch;
    plm_leaf_way way;
    size_t first; /* station beyond the foot's reach */
    bool *allowed;
    uint32_t *source, *parent, *mark;
    float *start, *value;
    uint32_t *trail; /* from the leaf's farthest point to the foot */
    size_t trail_count;
    bool *clear, *beside; /* of each station: see plm_rachis_clear */
    float *widest;        /* how wide each leaf's tube is at most, told by larger ones; NULL: see larger_leaves_tell */
    uint32_t stamp;
} work;

/* ---- The way from the foot ------------------------------------------------------------------------------------- */

/* Distances within a leaf from its foot, and its points in their order. No points where the leaf has no foot. */
static plm_status walk_leaf(work *w, int32_t leaf, plm_error *error)
{
    const plm_sketch *s = w->sketch;
    const size_t count = s->working.count;
    float nearest = INFINITY;
    w->way.count = 0;
    for (uint32_t i = 0; i < count; i++) {
        w->allowed[i] = s->leaf[i] == leaf && !s->is_stem[i];
        if (w->allowed[i] && w->groups->distance[i] < nearest) nearest = w->groups->distance[i];
    }
    if (!isfinite(nearest) || nearest > s->scale.radius) return PLM_OK;
    size_t sources = 0;
    for (uint32_t i = 0; i < count; i++)
        if (w->allowed[i] && w->groups->distance[i] <= nearest + 1.5 * s->working.cell) {
            w->start[sources] = w->groups->distance[i];
            w->source[sources++] = i;
        }
    const plm_walk walk = {.source = w->source,
                           .source_count = sources,
                           .start = w->start,
                           .allowed = w->allowed,
                           .distance = w->way.distance,
                           .parent = w->parent,
                           .order = w->way.order,
                           .reached = &w->way.count};
    return plm_graph_walk(&s->graph, &walk, error);
}

/* Marks the points at distances in [low, high) that are joined, among them, with the way from tip to foot. */
static void flood(work *w, double low, double high, const uint32_t *trail, size_t trail_count)
{
    const plm_graph *graph = &w->sketch->graph;
    const float *distance = w->way.distance;
    const uint32_t stamp = ++w->stamp;
    size_t stack = 0;
    for (size_t k = 0; k < trail_count; k++) {
        const uint32_t i = trail[k];
        if (distance[i] >= low && distance[i] < high && w->mark[i] != stamp) w->mark[i] = stamp, w->source[stack++] = i;
    }
    while (stack) {
        const uint32_t i = w->source[--stack];
        for (uint32_t e = graph->first[i]; e < graph->first[i + 1]; e++) {
            const uint32_t j = graph->edge[e];
            if (!w->allowed[j] || w->mark[j] == stamp || !(distance[j] >= low && distance[j] < high)) continue;
            w->mark[j] = stamp;
            w->source[stack++] = j;
        }
    }
}

double plm_leaf_wide(const plm_leaf_way *way)
{
    return WIDE * way->tube;
}

/* The station of the marked points of order[begin, end). */
static void measure_marked(work *w, size_t begin, size_t end, plm_station *station)
{
    size_t count = 0;
    for (size_t k = begin; k < end; k++)
        if (w->mark[w->way.order[k]] == w->stamp) w->source[count++] = w->way.order[k];
    plm_station_measure(w->sketch, w->source, count, station);
}

/* A station takes in what is joined, within a wider range of distances, with the way to the leaf's farthest point:
 * leaflets to the sides, and what lies about the foot, are not. The range is wide enough for gaps between points, and for
 * compound leaves narrow enough for their leaflets. */
static void measure_stations(work *w)
{
    plm_leaf_way *way = &w->way;
    const double margin = (w->sketch->habit == PLM_HABIT_COMPOUND ? JOINED_COMPOUND : JOINED) * way->window;
    size_t begin = 0, end = 0;
    w->trail_count = 0;
    for (uint32_t i = way->order[way->count - 1]; i != UINT32_MAX; i = w->parent[i]) w->trail[w->trail_count++] = i;
    for (size_t k = 0; k < way->station_count; k++) {
        const double low = (double)k * way->step - 0.5 * way->window, high = low + way->window;
        while (begin < way->count && way->distance[way->order[begin]] < low) begin++;
        if (end < begin) end = begin;
        while (end < way->count && way->distance[way->order[end]] < high) end++;
        flood(w, low - margin, high + margin, w->trail, w->trail_count);
        measure_marked(w, begin, end, &way->station[k]);
    }
}

/* ---- The change of the width ----------------------------------------------------------------------------------- */

/* Typical width of the tube: of the stations whose points are mostly called tube; 0 where there are none. */
static double tube_width(const work *w, size_t first)
{
    size_t count = 0;
    for (size_t k = first; k < w->way.station_count; k++) {
        const plm_station *station = &w->way.station[k];
        if (station->count > 1 && station->tube > TUBE_SHARE) w->value[count++] = (float)station->width;
    }
    return count ? plm_quantile(w->value, count, 0.4) : 0;
}

static size_t widest_station(const plm_leaf_way *way, size_t first)
{
    size_t widest = first;
    for (size_t k = first; k < way->station_count; k++)
        if (way->station[k].width > way->station[widest].width) widest = k;
    return widest;
}

/* Leaves of a rosette may be so short that stations of the blade pass as tube: the narrowest ones before the blade's widest
 * place tell. INFINITY where there are none. */
static double narrow_width(const work *w)
{
    const plm_leaf_way *way = &w->way;
    const size_t widest = widest_station(way, w->first);
    size_t count = 0;
    for (size_t k = FOOT_STATIONS; k < widest; k++)
        if (way->station[k].count >= FEWEST_OF_STATION) w->value[count++] = (float)way->station[k].width;
    return count ? plm_quantile(w->value, count, NARROW) : INFINITY;
}

size_t plm_leaf_only_split(const plm_leaf_way *way, size_t first)
{
    const double limit = plm_leaf_wide(way);
    const size_t widest = widest_station(way, first);
    size_t best = first;
    long balance = 0, least = 0;
    for (size_t k = first; k < widest; k++) { /* moving the split beyond station k */
        balance += way->station[k].width > limit ? 1 : -1;
        if (balance < least) {
            least = balance;
            best = k + 1;
        }
    }
    return best;
}

/* Whether the noise is wide against the tube. */
static bool is_noisy(const plm_leaf_way *way)
{
    return way->sketch->scale.noise > NOISY * way->tube;
}

/* The first narrow station beyond the foot, about which in noise sides of the stem and of other feet are called tube. first: it
 * is not noisy, or all is wide there. */
static size_t beyond_foot(const plm_leaf_way *way, size_t first)
{
    const size_t reach = (size_t)(way->sketch->scale.radius / way->step);
    const size_t most = reach < way->station_count ? reach : way->station_count;
    size_t k = first;
    while (k < most && (way->station[k].count < 2 || way->station[k].width > plm_leaf_wide(way))) k++;
    return is_noisy(way) && k < most ? k : first;
}

/* Typical number of points of the tube's stations; 0 where there are none. Wide ones hold leaflets. */
static double tube_count(const work *w, size_t first)
{
    size_t count = 0;
    for (size_t k = first; k < w->way.station_count; k++) {
        const plm_station *station = &w->way.station[k];
        if (station->tube > TUBE_SHARE && station->width <= plm_leaf_wide(&w->way))
            w->value[count++] = (float)station->count;
    }
    return count ? plm_quantile(w->value, count, 0.5) : 0;
}

static double run_points(const plm_leaf_way *way, size_t begin, size_t end)
{
    double points = 0;
    for (size_t k = begin; k < end; k++) points += way->station[k].count;
    return points;
}

bool plm_leaf_is_full(const plm_leaf_way *way, size_t begin, size_t end)
{
    const double run = (double)(end - begin);
    return run >= LONG_RUN * WINDOW || run_points(way, begin, end) >= FULL * way->tube_points * run;
}

/* Share of the leaf's points beyond a station. */
static double share_beyond(const plm_leaf_way *way, size_t station)
{
    size_t k = way->count;
    while (k > 0 && way->distance[way->order[k - 1]] >= (double)station * way->step) k--;
    return (double)(way->count - k) / (double)way->count;
}

/* Whether the narrow stations [begin, split) are rachis: a stretch as long as a window that is long or as full as a tube.
 * Where balls found no tube there, a torn tip hangs on as much, but it holds little of the leaf, or few points; and in noise gaps
 * of a thinly scanned blade look as clear, but there are few points on the line. */
static bool is_rachis(const work *w, size_t begin, size_t split)
{
    const plm_leaf_way *way = &w->way;
    const double run = (double)(split - begin);
    double tubes = 0;
    size_t clear = 0;
    for (size_t k = begin; k < split; k++) tubes += way->station[k].tube, clear += w->clear[k];
    const bool filled = run_points(way, begin, split) >= FILLED * way->tube_points * run;
    if (is_noisy(way) && tubes <= TUBE_SHARE * run && run_points(way, begin, split) < ENOUGH * WINDOW) return false;
    if (clear >= CLEAR && filled) return share_beyond(way, split) > (clear >= SURE ? LEAST_SURE : LEAST_CLEAR);
    if (run < WINDOW || !plm_leaf_is_full(way, begin, split)) return false;
    if (tubes > TUBE_SHARE * run) return true;
    return filled && share_beyond(way, split) > (run < SHORT_RUN * WINDOW ? LEAST_LAST_SHORT : LEAST_LAST);
}

/* Noise makes tubes wide, so that a small last leaflet is hardly wider than they are elsewhere; but a long clear stretch before it
 * tells how wide the rachis is there. The first station beyond the outermost such stretch that is wider, where enough of the leaf
 * lies beyond; first: there is none. */
static size_t clear_split(const work *w, size_t first)
{
    const plm_leaf_way *way = &w->way;
    for (size_t k = way->station_count; k > first; k--) {
        const size_t end = k;
        size_t count = 0;
        for (; k > first && w->clear[k - 1]; k--)
            if (way->station[k - 1].count > 1) w->value[count++] = (float)way->station[k - 1].width;
        const double least = fmax(ENOUGH * WINDOW, FILLED * way->tube_points * (double)(end - k));
        if (end - k >= LONG_CLEAR && count && run_points(way, k, end) >= least) {
            const double wide = WIDE * plm_quantile(w->value, count, 0.5);
            size_t split = end;
            while (split < way->station_count && (w->clear[split] || way->station[split].width <= wide)) split++;
            if (split < way->station_count && share_beyond(way, split) > LEAST_LONG) return split;
        }
        if (k == first) break;
    }
    return first;
}

/* The first station of the last leaflet of a compound leaf: from the tip inwards, once the leaflet was met, the first narrow
 * stretch that is rachis. */
static size_t last_split(const work *w, size_t first)
{
    const plm_leaf_way *way = &w->way;
    const double limit = plm_leaf_wide(way);
    size_t k = way->station_count;
    while (k > first && (w->clear[k - 1] || way->station[k - 1].width < BLADE * way->tube)) k--;
    while (k > first) {
        if (way->station[k - 1].width > limit) {
            k--;
            continue;
        }
        const size_t split = k;
        while (k > first && way->station[k - 1].width <= limit) k--;
        if (is_rachis(w, k, split)) return split;
    }
    return first;
}

/* The outer one: beyond a long clear stretch there may be a last leaflet that last_split takes for the rachis' tip. */
static size_t compound_split(const work *w, size_t first)
{
    const size_t split = last_split(w, first), beyond = clear_split(w, first);
    return beyond > split ? beyond : split;
}

/* Least squares of excess = c covered + a beyond over stations; c and a are not negative. Gives the sum of squares. */
static double fit_growth(const plm_leaf_way *way, double d, size_t low, size_t high)
{
    double m[3] = {0}, r[2] = {0}, squares = 0, c = 0, a = 0;
    const double window = way->window / way->step;
    for (int turn = 0; turn < 2; turn++) {
        for (size_t k = low; k < high; k++) {
            const double end = (double)k + 0.5 * window;
            const double covered = fmin(fmax(end - d, 0), window) / window; /* share of the window beyond d */
            const double beyond = covered * fmax(end - d - 0.5 * covered * window, 0);
            const double width = way->station[k].width;
            const double excess = width > way->tube ? sqrt(width * width - way->tube * way->tube) : 0;
            const double residual = excess - c * covered - a * beyond;
            squares += turn ? residual * residual : 0;
            if (turn) continue;
            m[0] += covered * covered, m[1] += covered * beyond, m[2] += beyond * beyond;
            r[0] += covered * excess, r[1] += beyond * excess;
        }
        if (turn) break;
        const double det = m[0] * m[2] - m[1] * m[1];
        if (det > 1e-9 * m[0] * m[2]) c = (m[2] * r[0] - m[1] * r[1]) / det, a = (m[0] * r[1] - m[1] * r[0]) / det;
        if (c < 0) c = 0, a = m[2] > 0 ? r[1] / m[2] : 0;
        if (a < 0) a = 0, c = m[0] > 0 ? r[0] / m[0] : 0;
    }
    return squares;
}

double plm_leaf_change(const plm_leaf_way *way, size_t first, size_t split)
{
    const size_t low = split > first + BEFORE ? split - BEFORE : first;
    size_t high = split + AFTER < way->station_count ? split + AFTER : way->station_count;
    double best = INFINITY, at = (double)split;
    for (double d = (double)split - 4; d <= (double)split + 3; d += SUBSTEP) {
        if (d < (double)low) continue;
        const double squares = fit_growth(way, d, low, high);
        if (squares < best) best = squares, at = d;
    }
    return at * way->step;
}

/* ---- Leaf by leaf ------------------------------------------------------------------------------------------------ */

/* The leaf's stations and the width of its tube; no points in way where there is nothing to tell. */
static plm_status measure_leaf(work *w, int32_t leaf, plm_error *error)
{
    plm_leaf_way *way = &w->way;
    const plm_sketch *s = w->sketch;
    const plm_status status = walk_leaf(w, leaf, error);
    if (status != PLM_OK || !way->count) return status;
    const double farthest = way->distance[way->order[way->count - 1]];
    way->step = fmax(s->working.cell, farthest / (STATIONS_MOST - 2));
    if (s->habit == PLM_HABIT_COMPOUND)
        way->step = fmax(way->step, STEP_LINKS * plm_leaf_typical_link(way, w->allowed, w->value));
    way->window = WINDOW * way->step;
    way->station_count = (size_t)(farthest / way->step) + 1;
    w->first = (size_t)(FOOT * s->scale.radius / way->step) + 1;
    if (way->station_count >= w->first + FEWEST_STATIONS) {
        measure_stations(w);
        way->tube = tube_width(w, w->first);
        way->tube_points = tube_count(w, w->first);
        if (s->habit == PLM_HABIT_ROSETTE) way->tube = fmin(way->tube, narrow_width(w));
        if (way->tube > 0) return status;
    }
    way->count = 0;
    return status;
}

/* The most that each leaf's tube can be wide: petioles of smaller leaves are no thicker, but in noise balls call their leaflets,
 * or narrow blades, tubes as well. */
static plm_status bound_tubes(work *w, plm_error *error)
{
    const size_t count = w->sketch->leaf_count;
    uint32_t *size = plm_scratch_take(&w->scratch, count, sizeof *size);
    float *tube = plm_scratch_take(&w->scratch, count, sizeof *tube);
    w->widest = plm_scratch_take(&w->scratch, count, sizeof *w->widest);
    plm_status status = w->scratch.failed ? PLM_E_MEMORY : PLM_OK;
    for (size_t leaf = 0; leaf < count && status == PLM_OK; leaf++) {
        status = measure_leaf(w, (int32_t)leaf, error);
        size[leaf] = (uint32_t)w->way.count;
        tube[leaf] = w->way.count ? (float)w->way.tube : INFINITY;
    }
    for (size_t leaf = 0; leaf < count && status == PLM_OK; leaf++) {
        size_t larger = 0;
        w->widest[leaf] = INFINITY;
        for (size_t j = 0; j < count; j++) {
            if (size[j] <= size[leaf]) continue;
            larger++;
            w->widest[leaf] = fminf(w->widest[leaf], (float)(WIDEST * tube[j]));
        }
        if (larger < LARGER_LEAST) w->widest[leaf] = INFINITY;
    }
    return status;
}

/* Clean tubes of simple leaves tell their own width. */
static bool larger_leaves_tell(const plm_sketch *sketch)
{
    const bool may_be_noisy = sketch->scale.noise > NOISY * THINNEST * sketch->scale.stem_radius;
    return sketch->habit == PLM_HABIT_COMPOUND || (sketch->habit == PLM_HABIT_SIMPLE && may_be_noisy);
}

/* Whether larger leaves tell better how wide a leaf's tube is than its own. */
static bool is_bounded(const work *w, int32_t leaf, bool compound)
{
    const double widest = w->widest[leaf];
    if (compound) return w->way.tube > widest;
    return w->way.tube > FAR_WIDER * widest && w->sketch->scale.noise > NOISY * widest;
}

static plm_status set_leaf(work *w, int32_t leaf, plm_error *error)
{
    plm_leaf_way *way = &w->way;
    plm_status status = measure_leaf(w, leaf, error);
    const bool compound = w->sketch->habit == PLM_HABIT_COMPOUND;
    if (status == PLM_OK && way->count && w->widest && is_bounded(w, leaf, compound)) {
        way->tube = w->widest[leaf];
        way->tube_points = tube_count(w, w->first);
    }
    if (status == PLM_OK && way->count && compound)
        status = plm_rachis_clear(way, w->trail, w->trail_count, w->clear, w->beside, error);
    if (status != PLM_OK || !way->count) return status;
    const size_t first = compound ? w->first : beyond_foot(way, w->first);
    const size_t split = compound ? compound_split(w, first) : plm_leaf_only_split(way, first);
    if (split <= first || split >= way->station_count) return PLM_OK;
    way->junction = plm_leaf_change(way, first, split);
    if (!compound && way->distance[way->order[(size_t)((1 - LEAST_BLADE) * (double)way->count)]] < way->junction)
        return PLM_OK;
    if (compound)
        plm_leaf_relabel_compound(w->sketch, way, w->beside);
    else
        plm_leaf_relabel_simple(w->sketch, way);
    plm_leaf_clean_foot(w->sketch, way);
    return compound ? plm_leaf_leaflets(w->sketch, way, error) : PLM_OK;
}

plm_status plm_sketch_junctions(plm_sketch *sketch, const plm_side_groups *groups, plm_error *error)
{
    const size_t count = sketch->working.count;
    const bool has_petioles =
        sketch->habit == PLM_HABIT_SIMPLE || sketch->habit == PLM_HABIT_COMPOUND || sketch->habit == PLM_HABIT_ROSETTE;
    if (!has_petioles || !sketch->scale.has_tubes) return PLM_OK;
    work w = {.sketch = sketch, .groups = groups, .scratch = {.error = error}, .way = {.sketch = sketch}};
    w.allowed = plm_scratch_take(&w.scratch, count, sizeof *w.allowed);
    w.source = plm_scratch_take(&w.scratch, count, sizeof *w.source);
    w.parent = plm_scratch_take(&w.scratch, count, sizeof *w.parent);
    w.mark = plm_scratch_take(&w.scratch, count, sizeof *w.mark);
    w.start = plm_scratch_take(&w.scratch, count, sizeof *w.start);
    w.trail = plm_scratch_take(&w.scratch, count, sizeof *w.trail);
    w.value = plm_scratch_take(&w.scratch, count + STATIONS_MOST, sizeof *w.value);
    w.way.order = plm_scratch_take(&w.scratch, count, sizeof *w.way.order);
    w.way.distance = plm_scratch_take(&w.scratch, count, sizeof *w.way.distance);
    w.clear = plm_scratch_take(&w.scratch, STATIONS_MOST, sizeof *w.clear);
    w.beside = plm_scratch_take(&w.scratch, STATIONS_MOST, sizeof *w.beside);
    w.way.station = plm_scratch_take(&w.scratch, STATIONS_MOST, sizeof *w.way.station);
    plm_status status = w.scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK && larger_leaves_tell(sketch)) status = bound_tubes(&w, error);
    for (size_t leaf = 0; leaf < sketch->leaf_count && status == PLM_OK; leaf++)
        status = set_leaf(&w, (int32_t)leaf, error);
    plm_scratch_free(&w.scratch, NULL);
    return status;
}
