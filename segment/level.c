/* segment/level.c: horizontal planes. The tilt comes from the mode of the normals (soil and table share it, leaves do
 * not), then levels are peaks of the heights of horizontal patches, each fitted robustly and cut to its largest
 * connected piece on a raster. */
#include "segment/level.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloud/linear.h"

static const double flat = 0.90;            /* |normal . up| of a horizontal patch: within 26 degrees */
static const double widest_tilt = 15;       /* degrees */
static const double smallest_share = 0.004; /* of the patches: a level with fewer is none */
enum { TILT_BINS = 31, SMALLEST = 12, FITS = 6 };

/* ---- The stand ----------------------------------------------------------------------------------------------- */

plm_status plm_stand_make(const plm_surfels *s, const double up[3], plm_stand *stand, plm_error *error)
{
    plm_stand t = {.surfels = s, .cell = 2 * s->cell};
    memcpy(t.rotation[2], up, sizeof t.rotation[2]);
    plm_frame_of_axis(up, t.rotation[0], t.rotation[1]);
    t.place = plm_alloc(s->count, sizeof *t.place, error);
    t.upright = plm_alloc(s->count, sizeof *t.upright, error);
    t.lean = plm_alloc(s->count, sizeof *t.lean, error);
    if (!t.place || !t.upright || !t.lean) {
        plm_stand_free(&t);
        return PLM_E_MEMORY;
    }
    float high[2] = {-INFINITY, -INFINITY};
    t.low[0] = t.low[1] = INFINITY;
    for (size_t k = 0; k < s->count; k++) {
        double n[3];
        for (int i = 0; i < 3; i++) {
            const double *row = t.rotation[i];
            t.place[k][i] = (float)(row[0] * s->centre[k][0] + row[1] * s->centre[k][1] + row[2] * s->centre[k][2]);
            n[i] = row[0] * s->normal[k][0] + row[1] * s->normal[k][1] + row[2] * s->normal[k][2];
        }
        const double length = plm_norm(n), side = hypot(n[0], n[1]);
        t.upright[k] = length > 0.5 ? (float)fabs(n[2]) : -1;
        for (int i = 0; i < 2; i++) {
            t.lean[k][i] = side > 0 ? (float)(n[i] / side) : 0;
            t.low[i] = fminf(t.low[i], t.place[k][i]);
            high[i] = fmaxf(high[i], t.place[k][i]);
        }
    }
    for (int i = 0; i < 2; i++) {
        t.low[i] -= (float)(1.5 * t.cell);
        t.size[i] = (int32_t)(((double)high[i] - t.low[i]) / t.cell) + 3;
    }
    *stand = t;
    return PLM_OK;
}

void plm_stand_free(plm_stand *stand)
{
    plm_free(stand->place);
    plm_free(stand->upright);
    plm_free(stand->lean);
    stand->place = NULL;
    stand->upright = NULL;
    stand->lean = NULL;
}

int64_t plm_stand_cell(const plm_stand *t, double u, double v)
{
    const double a = floor((u - t->low[0]) / t->cell), b = floor((v - t->low[1]) / t->cell);
    if (!(a >= 0 && a < t->size[0] && b >= 0 && b < t->size[1])) return -1;
    return (int64_t)a * t->size[1] + (int64_t)b;
}

/* ---- Tilt ---------------------------------------------------------------------------------------------------- */

double plm_find_tilt(const plm_surfels *s, const double up[3], double direction[3])
{
    static const int half = TILT_BINS / 2;
    double u[3], v[3], weight[TILT_BINS][TILT_BINS] = {{0}}, total = 0;
    const double step = tan(plm_radians(widest_tilt)) / half;
    plm_frame_of_axis(up, u, v);
    for (size_t k = 0; k < s->count; k++) {
        const double n[3] = {s->normal[k][0], s->normal[k][1], s->normal[k][2]}, height = plm_dot(n, up);
        if (fabs(height) < 0.5) continue;
        const double a = round(plm_dot(n, u) / height / step), b = round(plm_dot(n, v) / height / step);
        if (fabs(a) > half || fabs(b) > half) continue;
        weight[half + (int)a][half + (int)b]++;
        total++;
    }
    enum { WINDOW = 4 }; /* about 4 degrees */
    double best = 0, at[2] = {0, 0};
    for (int a = 0; a < TILT_BINS; a++)
        for (int b = 0; b < TILT_BINS; b++) {
            double sum = 0, sum_a = 0, sum_b = 0;
            for (int i = -WINDOW; i <= WINDOW; i++)
                for (int j = -WINDOW; j <= WINDOW; j++) {
                    if (i * i + j * j > WINDOW * WINDOW) continue;
                    const int x = a + i, y = b + j;
                    if (x < 0 || y < 0 || x >= TILT_BINS || y >= TILT_BINS) continue;
                    sum += weight[x][y];
                    sum_a += weight[x][y] * (x - half);
                    sum_b += weight[x][y] * (y - half);
                }
            if (sum > best) {
                best = sum;
                at[0] = sum_a / sum * step;
                at[1] = sum_b / sum * step;
            }
        }
    for (int i = 0; i < 3; i++) direction[i] = up[i] + at[0] * u[i] + at[1] * v[i];
    plm_normalise(direction);
    return total > 0 ? best / total : 0;
}

/* ---- Levels -------------------------------------------------------------------------------------------------- */

typedef struct search {
    const plm_stand *stand;
    uint8_t *taken;    /* of each patch: belongs to a level that was found */
    double *histogram; /* of the heights of horizontal patches that are not taken */
    int bins;
    double low, bin;
    uint32_t *member; /* patches of the level in work */
    size_t members;
    int32_t *piece; /* raster: number of the connected piece, 0 none */
    int32_t *stack;
    double *distance;
} search;

static bool horizontal(const plm_stand *t, size_t k)
{
    return t->upright[k] > flat;
}

static void fill_histogram(search *f)
{
    const plm_stand *t = f->stand;
    memset(f->histogram, 0, (size_t)f->bins * sizeof *f->histogram);
    for (size_t k = 0; k < t->surfels->count; k++)
        if (horizontal(t, k) && !f->taken[k]) f->histogram[(int)(((double)t->place[k][2] - f->low) / f->bin)]++;
}

/* Height at which the most patches lie within a voxel and a half. */
static double highest_peak(const search *f, double *patches)
{
    double best = 0;
    int at = 0;
    for (int b = 2; b + 2 < f->bins; b++) {
        const double *h = f->histogram + b;
        const double sum = h[-2] + 2 * h[-1] + 3 * h[0] + 2 * h[1] + h[2]; /* triangle of half width 1.5 voxels */
        if (sum > best) best = sum, at = b;
    }
    *patches = best / 3;
    return f->low + (at + 0.5) * f->bin;
}

static int compare_double(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Least squares plane of the members; false where they do not span one. */
static bool fit_plane(const search *f, double plane[3])
{
    const plm_stand *t = f->stand;
    double mean[3] = {0}, m[5] = {0};
    for (size_t i = 0; i < f->members; i++)
        for (int a = 0; a < 3; a++) mean[a] += t->place[f->member[i]][a];
    for (int a = 0; a < 3; a++) mean[a] /= (double)f->members;
    for (size_t i = 0; i < f->members; i++) {
        const float *p = t->place[f->member[i]];
        const double u = p[0] - mean[0], v = p[1] - mean[1], w = p[2] - mean[2];
        m[0] += u * u, m[1] += u * v, m[2] += v * v, m[3] += u * w, m[4] += v * w;
    }
    const double determinant = m[0] * m[2] - m[1] * m[1];
    if (!(determinant > 1e-6 * (m[0] + m[2]) * (m[0] + m[2]))) return false;
    plane[0] = (m[3] * m[2] - m[4] * m[1]) / determinant;
    plane[1] = (m[4] * m[0] - m[3] * m[1]) / determinant;
    plane[2] = mean[2] - plane[0] * mean[0] - plane[1] * mean[1];
    return true;
}

static double off_plane(const plm_stand *t, const double plane[3], size_t k)
{
    return t->place[k][2] - (plane[0] * t->place[k][0] + plane[1] * t->place[k][1] + plane[2]);
}

static void gather(search *f, const double plane[3], double band)
{
    f->members = 0;
    for (size_t k = 0; k < f->stand->surfels->count; k++)
        if (horizontal(f->stand, k) && !f->taken[k] && fabs(off_plane(f->stand, plane, k)) <= band)
            f->member[f->members++] = (uint32_t)k;
}

/* Robust scatter of the members off the plane. */
static double scatter_off(search *f, const double plane[3])
{
    for (size_t i = 0; i < f->members; i++) f->distance[i] = fabs(off_plane(f->stand, plane, f->member[i]));
    qsort(f->distance, f->members, sizeof *f->distance, compare_double);
    return f->members ? 1.4826 * f->distance[f->members / 2] : 0;
}

/* Keeps the members on the largest connected piece of their raster cells (gaps of one cell are bridged) and marks it in
 * mask. Gives its number of cells. */
static size_t keep_largest_piece(search *f, uint8_t *mask)
{
    const plm_stand *t = f->stand;
    const int32_t width = t->size[0], height = t->size[1];
    memset(f->piece, 0, (size_t)width * (size_t)height * sizeof *f->piece);
    for (size_t i = 0; i < f->members; i++)
        f->piece[plm_stand_cell(t, t->place[f->member[i]][0], t->place[f->member[i]][1])] = -1;
    size_t largest = 0;
    int32_t number = 0, best = 0;
    for (int32_t start = 0; start < width * height; start++) {
        if (f->piece[start] != -1) continue;
        size_t cells = 0, depth = 0;
        f->piece[start] = ++number;
        f->stack[depth++] = start;
        while (depth) {
            const int32_t c = f->stack[--depth], x = c / height, y = c % height;
            cells++;
            for (int32_t a = x > 1 ? x - 2 : 0; a <= x + 2 && a < width; a++)
                for (int32_t b = y > 1 ? y - 2 : 0; b <= y + 2 && b < height; b++)
                    if (f->piece[a * height + b] == -1) {
                        f->piece[a * height + b] = number;
                        f->stack[depth++] = a * height + b;
                    }
        }
        if (cells > largest) largest = cells, best = number;
    }
    for (int32_t c = 0; c < width * height; c++) mask[c] = best && f->piece[c] == best;
    size_t kept = 0;
    for (size_t i = 0; i < f->members; i++) {
        const float *p = t->place[f->member[i]];
        if (mask[plm_stand_cell(t, p[0], p[1])]) f->member[kept++] = f->member[i];
    }
    f->members = kept;
    return largest;
}

/* Support function of the mask in PLM_OUTLINE directions, turned into distances along rays: the convex outline. */
static void outline(const plm_stand *t, plm_level *level)
{
    double support[PLM_OUTLINE];
    for (int d = 0; d < PLM_OUTLINE; d++) support[d] = 0;
    for (int32_t x = 0; x < t->size[0]; x++)
        for (int32_t y = 0; y < t->size[1]; y++) {
            if (!level->mask[x * t->size[1] + y]) continue;
            const double u = t->low[0] + (x + 0.5) * t->cell - level->centre[0];
            const double v = t->low[1] + (y + 0.5) * t->cell - level->centre[1];
            for (int d = 0; d < PLM_OUTLINE; d++) {
                const double angle = 2 * PLM_PI * d / PLM_OUTLINE;
                support[d] = fmax(support[d], u * cos(angle) + v * sin(angle));
            }
        }
    level->hull_area = 0;
    for (int d = 0; d < PLM_OUTLINE; d++) {
        double reach = INFINITY;
        for (int e = 1 - PLM_OUTLINE / 4; e < PLM_OUTLINE / 4; e++)
            reach = fmin(reach, support[(d + e + PLM_OUTLINE) % PLM_OUTLINE] / cos(2 * PLM_PI * e / PLM_OUTLINE));
        level->radius[d] = reach;
        level->hull_area += reach * reach * PLM_PI / PLM_OUTLINE;
    }
}

double plm_level_reach(const plm_level *level, double du, double dv)
{
    double place = atan2(dv, du) / (2 * PLM_PI) * PLM_OUTLINE;
    if (place < 0) place += PLM_OUTLINE;
    const int d = (int)place % PLM_OUTLINE;
    const double part = place - floor(place);
    return level->radius[d] * (1 - part) + level->radius[(d + 1) % PLM_OUTLINE] * part;
}

static void describe(search *f, const double plane[3], size_t cells, plm_level *level)
{
    const plm_stand *t = f->stand;
    memcpy(level->plane, plane, sizeof level->plane);
    level->scatter = scatter_off(f, plane);
    level->area = (double)cells * t->cell * t->cell;
    level->patches = f->members;
    double sum[2] = {0}, upright = 0;
    for (int32_t x = 0; x < t->size[0]; x++)
        for (int32_t y = 0; y < t->size[1]; y++)
            if (level->mask[x * t->size[1] + y]) sum[0] += x + 0.5, sum[1] += y + 0.5;
    for (int i = 0; i < 2; i++) level->centre[i] = t->low[i] + sum[i] / (double)cells * t->cell;
    for (size_t i = 0; i < f->members; i++) upright += t->upright[f->member[i]];
    level->agreement = upright / (double)f->members;
    outline(t, level);
}

/* Fits a level at a height. The band follows the scatter (rough soil), within 1.5 voxels and 4 % of its size. */
static size_t grow_level(search *f, double height, double plane[3], uint8_t *mask)
{
    double band = 1.5 * f->stand->surfels->cell;
    size_t cells = 0;
    plane[0] = plane[1] = 0;
    plane[2] = height;
    for (int fit = 0; fit < FITS; fit++) {
        gather(f, plane, band);
        if (f->members < SMALLEST) return 0;
        cells = keep_largest_piece(f, mask);
        double next[3];
        if (f->members < SMALLEST || !fit_plane(f, next)) return 0;
        memcpy(plane, next, sizeof next);
        const double size = sqrt((double)cells) * f->stand->cell;
        band = fmax(1.5 * f->stand->surfels->cell, fmin(3 * scatter_off(f, plane), 0.04 * size));
    }
    return cells;
}

static plm_status search_start(search *f, const plm_stand *t, plm_error *error)
{
    const size_t count = t->surfels->count, cells = (size_t)t->size[0] * (size_t)t->size[1];
    double high = -INFINITY;
    *f = (search){.stand = t, .low = INFINITY, .bin = 0.5 * t->surfels->cell};
    for (size_t k = 0; k < count; k++) {
        f->low = fmin(f->low, t->place[k][2]);
        high = fmax(high, t->place[k][2]);
    }
    f->low -= 3 * f->bin;
    f->bins = (int)((high - f->low) / f->bin) + 4;
    f->taken = plm_alloc_zero(count, sizeof *f->taken, error);
    f->histogram = plm_alloc(count ? (size_t)f->bins : 0, sizeof *f->histogram, error);
    f->member = plm_alloc(count, sizeof *f->member, error);
    f->distance = plm_alloc(count, sizeof *f->distance, error);
    f->piece = plm_alloc(cells, sizeof *f->piece, error);
    f->stack = plm_alloc(cells, sizeof *f->stack, error);
    return f->taken && f->histogram && f->member && f->distance && f->piece && f->stack ? PLM_OK : PLM_E_MEMORY;
}

static void search_end(search *f)
{
    plm_free(f->taken);
    plm_free(f->histogram);
    plm_free(f->member);
    plm_free(f->distance);
    plm_free(f->piece);
    plm_free(f->stack);
}

static int larger_first(const void *a, const void *b)
{
    const double x = ((const plm_level *)a)->area, y = ((const plm_level *)b)->area;
    return (y > x) - (y < x);
}

plm_status plm_find_levels(const plm_stand *stand, plm_level level[PLM_LEVELS], int *count, plm_error *error)
{
    search f;
    *count = 0;
    plm_status status = search_start(&f, stand, error);
    const size_t cells = (size_t)stand->size[0] * (size_t)stand->size[1];
    const double least = fmax(SMALLEST, smallest_share * (double)stand->surfels->count);
    for (int attempt = 0; status == PLM_OK && attempt < 3 * PLM_LEVELS && *count < PLM_LEVELS; attempt++) {
        double patches, plane[3];
        fill_histogram(&f);
        const double height = highest_peak(&f, &patches);
        if (patches < least) break;
        plm_level next = {.mask = plm_alloc(cells, 1, error)};
        if (!next.mask) {
            status = PLM_E_MEMORY;
            break;
        }
        const size_t found = grow_level(&f, height, plane, next.mask);
        if (found && (double)f.members >= least) {
            for (size_t i = 0; i < f.members; i++) f.taken[f.member[i]] = 1;
            describe(&f, plane, found, &next);
            level[(*count)++] = next;
        } else { /* nothing connected there: look elsewhere */
            plm_free(next.mask);
            for (size_t k = 0; k < stand->surfels->count; k++)
                if (horizontal(stand, k) && fabs(stand->place[k][2] - height) <= stand->surfels->cell) f.taken[k] = 1;
        }
    }
    search_end(&f);
    if (status == PLM_OK)
        qsort(level, (size_t)*count, sizeof *level, larger_first);
    else
        plm_levels_free(level, *count), *count = 0;
    return status;
}

void plm_levels_free(plm_level level[PLM_LEVELS], int count)
{
    for (int i = 0; i < count; i++) {
        plm_free(level[i].mask);
        level[i].mask = NULL;
    }
}
