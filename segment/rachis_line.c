/* segment/rachis_line.c: the rachis between leaflets that are joined at its sides. The level sets of the distance from the
 * foot take in the leaflets beside the rachis where they touch it or each other; about the rachis' own line there is a gap
 * before the next leaflet begins all the same: a sheet has as many points between one and two radii from the line as within
 * one, a tube has nearly none. Leaflets that are known to hang at the sides (rachis_sides.c) are not counted, gap or none. */
#include "segment/rachis_line.h"

#include "cloud/linear.h"
#include "segment/rachis_sides.h"
#include "segment/scratch.h"

#include <math.h>
#include <string.h>

static const double CORE = 1.7; /* widths of the tube from the line: two SDs across it in noise, its radius without */
/* Points beside the line per point on it: of a tube in noise, of a sheet. */
static const double BESIDE_TUBE = 0.2, BESIDE_SHEET = 0.9;
static const double TELLS = 4;      /* a station's evidence (logarithm of odds) is at most this: petiolules, gaps */
static const double CHANGE = 2;     /* evidence that a change from rachis to blade or back must have for it */
static const double SLIMMER = 0.85; /* of the tube's width: a narrower one is taken */
static const double FULL = 0.25;    /* of the points that narrow stations have on the line: fewer are a gap */
enum {
    NEAR = 10,  /* stations in which the nearest place of the line is looked for */
    SMOOTH = 2, /* stations to both sides that make a place of the line */
    ROUNDS = 2, /* of moving the line to the middle of what is about it */
    FEWEST = 4, /* points that tell a middle */
    ABOUT = 3,  /* stations to both sides whose points on the line are counted: how dense what is there is */
    DENSE = 3,  /* points on the line of a station, typically: of leaves with fewer, blades are torn to pieces */
    SURE = 5    /* narrow stations, one after the other, that are the rachis beyond its foot */
};

typedef struct line {
    const plm_leaf_way *way;
    size_t count;      /* stations */
    double (*node)[3]; /* a place each station */
    double (*sum)[4];  /* of the places of points and their number */
    uint32_t *core, *flank;
    float *off;        /* of each point in the way's order, from its nearest node */
    uint32_t *station; /* of its nearest node */
    bool *aside;       /* of a leaflet at the side: tells nothing about what is on the line */
    bool (*came)[2];   /* scratch, as many as stations, as is value */
    float *value;
} line;

/* Middles of sums of SMOOTH stations to both sides; a station without enough points keeps its place. */
static void take_means(line *l)
{
    for (size_t k = 0; k < l->count; k++) {
        double total[4] = {0};
        const size_t low = k > SMOOTH ? k - SMOOTH : 0, high = k + SMOOTH < l->count ? k + SMOOTH : l->count - 1;
        for (size_t j = low; j <= high; j++)
            for (int a = 0; a < 4; a++) total[a] += l->sum[j][a];
        if (total[3] < FEWEST) continue;
        for (int a = 0; a < 3; a++) l->node[k][a] = total[a] / total[3];
    }
}

/* Means over SMOOTH nodes to both sides, twice: bends sharper than the reach beside the line are its points' scatter. */
static void smooth(line *l)
{
    for (int round = 0; round < 2; round++) {
        for (size_t k = 0; k < l->count; k++) {
            for (int a = 0; a < 3; a++) l->sum[k][a] = FEWEST * l->node[k][a];
            l->sum[k][3] = FEWEST;
        }
        take_means(l);
    }
}

static size_t station_of(const line *l, uint32_t point)
{
    const size_t k = (size_t)(l->way->distance[point] / l->way->step + 0.5);
    return k < l->count ? k : l->count - 1;
}

static void add_place(line *l, size_t station, const float xyz[3])
{
    for (int a = 0; a < 3; a++) l->sum[station][a] += xyz[a];
    l->sum[station][3]++;
}

/* The line by the way's points alone; stations before the first and amid few are those of the nearest place on it. */
static void begin_line(line *l, const uint32_t *trail, size_t count)
{
    const float(*xyz)[3] = (const float(*)[3])l->way->sketch->working.xyz;
    for (size_t k = 0; k < count; k++) add_place(l, station_of(l, trail[k]), xyz[trail[k]]);
    size_t last = l->count;
    for (size_t k = 0; k < l->count; k++) {
        if (l->sum[k][3] > 0) {
            for (int a = 0; a < 3; a++) l->node[k][a] = l->sum[k][a] / l->sum[k][3];
            for (size_t j = last == l->count ? 0 : k; j < k; j++) memcpy(l->node[j], l->node[k], sizeof *l->node);
            last = k;
        } else if (last < l->count) {
            memcpy(l->node[k], l->node[last], sizeof *l->node);
        }
    }
    take_means(l);
}

/* The nearest node of each point, of the stations about its own. */
static void assign(line *l)
{
    const float(*xyz)[3] = (const float(*)[3])l->way->sketch->working.xyz;
    for (size_t k = 0; k < l->way->count; k++) {
        const float *p = xyz[l->way->order[k]];
        const size_t own = station_of(l, l->way->order[k]);
        const size_t low = own > NEAR ? own - NEAR : 0, high = own + NEAR < l->count ? own + NEAR : l->count - 1;
        double least = INFINITY;
        for (size_t j = low; j <= high; j++) {
            double squared = 0;
            for (int a = 0; a < 3; a++) squared += (p[a] - l->node[j][a]) * (p[a] - l->node[j][a]);
            if (squared < least) least = squared, l->station[k] = (uint32_t)j;
        }
        l->off[k] = (float)sqrt(least);
    }
}

/* Moves the line to the middle of what is near to it. */
static void centre(line *l, double reach)
{
    memset(l->sum, 0, l->count * sizeof *l->sum);
    for (size_t k = 0; k < l->way->count; k++)
        if (l->off[k] < reach) add_place(l, l->station[k], l->way->sketch->working.xyz[l->way->order[k]]);
    take_means(l);
    smooth(l);
}

static void count_core(line *l, double reach)
{
    for (size_t k = 0; k < l->way->count; k++)
        if (l->off[k] < reach) l->core[l->station[k]]++;
}

static void count_flank(line *l, double reach)
{
    for (size_t k = 0; k < l->way->count; k++)
        if (l->off[k] >= reach && l->off[k] < 2 * reach && !l->aside[k]) l->flank[l->station[k]]++;
}

/* Median number of points on the line of stations that are narrow; 0 where there are none. */
static double typical_core(const line *l)
{
    size_t count = 0;
    for (size_t k = 0; k < l->count; k++)
        if (l->way->station[k].count && l->way->station[k].width <= plm_leaf_wide(l->way))
            l->value[count++] = (float)l->core[k];
    return count ? plm_quantile(l->value, count, 0.5) : 0;
}

/* Evidence that a station is of the rachis and not of a blade: logarithm of the odds of so many points beside the line. */
static double evidence(const line *l, size_t k, double typical)
{
    const size_t low = k > ABOUT ? k - ABOUT : 0, high = k + ABOUT < l->count ? k + ABOUT : l->count - 1;
    double core = 0;
    for (size_t j = low; j <= high; j++) core += (double)l->core[j] / (double)(high - low + 1);
    if (core < FULL * typical) return 0;
    const double odds = l->flank[k] * log(BESIDE_TUBE / BESIDE_SHEET) + (BESIDE_SHEET - BESIDE_TUBE) * core;
    return fmin(fmax(odds, -TELLS), TELLS);
}

/* Which stations are the rachis': the likeliest sequence of rachis and blade, where each change costs (Viterbi's way). */
static void find_clear(const line *l, double typical, bool *clear)
{
    double score[2] = {0}; /* of the best sequence that ends in blade, in rachis */
    for (size_t k = 0; k < l->count; k++) {
        const double e = evidence(l, k, typical), before[2] = {score[0], score[1]};
        for (int state = 0; state < 2; state++) {
            l->came[k][state] = before[!state] - CHANGE > before[state] ? !state : state;
            score[state] = fmax(before[state], before[!state] - CHANGE) + (state ? 0.5 * e : -0.5 * e);
        }
    }
    bool state = score[1] > score[0];
    for (size_t k = l->count; k-- > 0; state = l->came[k][state]) clear[k] = state;
}

/* A run of clear stations is the rachis where at one of them, or beside it, nothing else is joined with it; thin places amid a
 * blade that is joined all along are none. */
static void drop_unjoined(const line *l, bool *clear)
{
    const plm_station *station = l->way->station;
    for (size_t k = 0, end; k < l->count; k = end + 1) {
        bool narrow = false;
        for (end = k; end < l->count && clear[end]; end++) continue;
        for (size_t j = k > 0 ? k - 1 : 0; j <= end && j < l->count; j++)
            narrow |= station[j].count > 1 && station[j].width <= plm_leaf_wide(l->way);
        for (size_t j = k; j < end && !narrow; j++) clear[j] = false;
    }
}

/* The clear stations from what is on the line within half a window of each. row: scratch of way->count rows. */
static void measure_clear(const line *l, const bool *clear, bool *beside, double reach, uint32_t *row,
                          plm_leaf_way *way)
{
    const double half = 0.5 * way->window / way->step;
    size_t begin = 0, narrow = 0;
    for (size_t k = 0; k < l->count; k++) {
        const bool wide = way->station[k].width > plm_leaf_wide(way);
        narrow = wide && narrow < SURE ? 0 : narrow + 1; /* stations before the first sure ones are about the foot */
        beside[k] = clear[k] && wide && narrow >= SURE;
        if (!beside[k]) continue;
        size_t count = 0;
        const double low = ((double)k - half - NEAR - 1) * way->step, high = ((double)k + half + NEAR + 1) * way->step;
        while (begin < way->count && way->distance[way->order[begin]] < low) begin++;
        for (size_t i = begin; i < way->count && way->distance[way->order[i]] <= high; i++)
            if (l->off[i] < reach && fabs((double)l->station[i] - (double)k) <= half) row[count++] = way->order[i];
        plm_station_measure(way->sketch, row, count, &way->station[k]);
    }
}

/* The line, what is about it, and which stations are clear, for a reach. */
static plm_status follow(line *l, const uint32_t *trail, size_t count, double reach, bool *clear, plm_error *error)
{
    memset(l->sum, 0, l->count * sizeof *l->sum);
    memset(l->core, 0, l->count * sizeof *l->core);
    memset(l->flank, 0, l->count * sizeof *l->flank);
    begin_line(l, trail, count);
    for (int round = 0; round < ROUNDS; round++) {
        assign(l);
        centre(l, reach);
    }
    assign(l);
    count_core(l, reach);
    const double typical = typical_core(l);
    plm_status status = PLM_OK;
    if (typical >= DENSE)
        status = plm_rachis_sides(l->way, l->off, l->station, reach, l->aside, error);
    else
        memset(l->aside, 0, l->way->count * sizeof *l->aside);
    if (status != PLM_OK) return status;
    count_flank(l, reach);
    find_clear(l, typical, clear);
    drop_unjoined(l, clear);
    return PLM_OK;
}

/* Median width of the narrow stations that are clear: leaflets that balls call tubes are not among them. */
static double clear_width(const line *l, const bool *clear)
{
    size_t count = 0;
    for (size_t k = 0; k < l->count; k++)
        if (clear[k] && l->way->station[k].count > 1 && l->way->station[k].width <= plm_leaf_wide(l->way))
            l->value[count++] = (float)l->way->station[k].width;
    return count >= SURE ? plm_quantile(l->value, count, 0.5) : INFINITY;
}

plm_status plm_rachis_clear(plm_leaf_way *way, const uint32_t *trail, size_t count, bool *clear, bool *beside,
                            plm_error *error)
{
    plm_scratch scratch = {.error = error};
    line l = {.way = way,
              .count = way->station_count,
              .node = plm_scratch_take(&scratch, way->station_count, sizeof *l.node),
              .sum = plm_scratch_take(&scratch, way->station_count, sizeof *l.sum),
              .core = plm_scratch_take(&scratch, way->station_count, sizeof *l.core),
              .flank = plm_scratch_take(&scratch, way->station_count, sizeof *l.flank),
              .came = plm_scratch_take(&scratch, way->station_count, sizeof *l.came),
              .value = plm_scratch_take(&scratch, way->station_count, sizeof *l.value),
              .off = plm_scratch_take(&scratch, way->count, sizeof *l.off),
              .station = plm_scratch_take(&scratch, way->count, sizeof *l.station),
              .aside = plm_scratch_take(&scratch, way->count, sizeof *l.aside)};
    uint32_t *row = plm_scratch_take(&scratch, way->count, sizeof *row);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) status = follow(&l, trail, count, CORE * way->tube, clear, error);
    for (int round = 0; round < ROUNDS && status == PLM_OK; round++) {
        const double width = clear_width(&l, clear);
        if (!(width < SLIMMER * way->tube)) break;
        way->tube = width;
        status = follow(&l, trail, count, CORE * way->tube, clear, error);
    }
    if (status == PLM_OK) measure_clear(&l, clear, beside, CORE * way->tube, row, way);
    plm_scratch_free(&scratch, NULL);
    return status;
}
