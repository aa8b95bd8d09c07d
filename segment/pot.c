/* segment/pot.c: normals of a pot's wall meet on its axis (Hough), and around that axis the wall fills the circle at one
 * radius for each height. A plant does neither. Leaves may hang in front, one side may be unseen. */
#include "segment/pot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloud/linear.h"

enum { SECTORS = 36, ZONES = 4, PEAKS = 2, REFINEMENTS = 4, GAP = 3 };

static const double steepest = 0.8;       /* |normal . up| of a wall patch: it may flare by 53 degrees */
static const double least_coverage = 0.5; /* of the sectors, in a row of the wall */
static const double least_radius = 4;     /* voxels: thinner tubes are stems */
/* Patches within the wall over those of it, at most: more within a round wall under soil, as where the side that no view saw is a
 * sheet across the pot. (A real one: 0.49 with soil over 0.8 of it; of 24 virtual heads in three modes none comes near both.) */
static const double hollow = 0.25, hollow_under_soil = 0.6, under_soil = 0.5;

typedef struct map {
    int rings, rows;
    double low, step; /* rows in w; rings are one voxel wide */
    uint64_t *sector; /* rings x rows: bit set of the sectors that have a wall patch there */
} map;

static double shape_at(const double shape[PLM_OUTLINE], double du, double dv)
{
    double place = atan2(dv, du) / (2 * PLM_PI) * PLM_OUTLINE;
    if (place < 0) place += PLM_OUTLINE;
    const int d = (int)place;
    const double part = place - d;
    return shape[d % PLM_OUTLINE] * (1 - part) + shape[(d + 1) % PLM_OUTLINE] * part;
}

double plm_pot_distance(const plm_pot *pot, const double p[3])
{
    const double h = p[2] - pot->foot;
    const double du = p[0] - pot->centre[0] - pot->slant[0] * h, dv = p[1] - pot->centre[1] - pot->slant[1] * h;
    const double r = sqrt(du * du + dv * dv);
    return pot->round ? r : r / shape_at(pot->shape, du, dv);
}

double plm_pot_radius(const plm_pot *pot, double w)
{
    const double place = fmin(fmax((w - pot->foot) / pot->step - 0.5, 0), pot->rows - 1);
    const int row = (int)place;
    const double part = place - row;
    return row + 1 < pot->rows ? pot->radius[row] * (1 - part) + pot->radius[row + 1] * part : pot->radius[row];
}

/* ---- The axis ------------------------------------------------------------------------------------------------- */

/* Votes of wall patches below top for places that lie along their normals, either way. */
static void vote(const plm_stand *t, double top, float *votes)
{
    const double cell = t->cell, least = least_radius * t->surfels->cell;
    const double most = 0.6 * cell * (t->size[0] > t->size[1] ? t->size[0] : t->size[1]);
    memset(votes, 0, (size_t)t->size[0] * (size_t)t->size[1] * sizeof *votes);
    for (size_t k = 0; k < t->surfels->count; k++) {
        if (!(t->upright[k] >= 0 && t->upright[k] < steepest) || t->place[k][2] > top) continue;
        for (int way = -1; way <= 1; way += 2)
            for (double d = least; d < most; d += cell) {
                const double a = (t->place[k][0] + way * d * t->lean[k][0] - t->low[0]) / cell;
                const double b = (t->place[k][1] + way * d * t->lean[k][1] - t->low[1]) / cell;
                if (!(a >= 0 && a < t->size[0] && b >= 0 && b < t->size[1])) break;
                votes[(size_t)a * (size_t)t->size[1] + (size_t)b]++;
            }
    }
}

/* The place with the most votes within its 3 x 3 cells; they are taken away around it. */
static bool best_place(const plm_stand *t, float *votes, double centre[2])
{
    const int32_t width = t->size[0], height = t->size[1];
    double best = 0;
    int32_t at[2] = {0, 0};
    for (int32_t x = 1; x + 1 < width; x++)
        for (int32_t y = 1; y + 1 < height; y++) {
            double sum = 0;
            for (int32_t a = x - 1; a <= x + 1; a++)
                for (int32_t b = y - 1; b <= y + 1; b++) sum += votes[a * height + b];
            if (sum > best) best = sum, at[0] = x, at[1] = y;
        }
    for (int i = 0; i < 2; i++) centre[i] = t->low[i] + (at[i] + 0.5) * t->cell;
    for (int32_t x = at[0] - 4; x <= at[0] + 4; x++)
        for (int32_t y = at[1] - 4; y <= at[1] + 4; y++)
            if (x >= 0 && y >= 0 && x < width && y < height) votes[x * height + y] = 0;
    return best > 0;
}

/* ---- The wall around an axis ---------------------------------------------------------------------------------- */

static int sector_of(double du, double dv)
{
    const int s = (int)((atan2(dv, du) / (2 * PLM_PI) + 1) * SECTORS) % SECTORS;
    return s < 0 ? s + SECTORS : s;
}

/* Is the patch part of a wall around the axis: steep, and facing it (corners of a square face it by 45 degrees)? */
static bool faces(const plm_stand *t, size_t k, const plm_pot *pot, bool round, double *du, double *dv)
{
    if (!(t->upright[k] >= 0 && t->upright[k] < steepest)) return false;
    const double h = t->place[k][2] - pot->foot;
    *du = t->place[k][0] - pot->centre[0] - pot->slant[0] * h;
    *dv = t->place[k][1] - pot->centre[1] - pot->slant[1] * h;
    const double r = hypot(*du, *dv);
    return r > 0 && fabs(t->lean[k][0] * *du + t->lean[k][1] * *dv) > (round ? 0.85 : 0.6) * r;
}

static void fill_map(const plm_stand *t, const plm_pot *pot, bool round, map *m)
{
    memset(m->sector, 0, (size_t)m->rings * (size_t)m->rows * sizeof *m->sector);
    for (size_t k = 0; k < t->surfels->count; k++) {
        double du, dv;
        if (!faces(t, k, pot, round, &du, &dv)) continue;
        const double ring = sqrt(du * du + dv * dv) / shape_at(pot->shape, du, dv) / t->surfels->cell;
        const double row = (t->place[k][2] - m->low) / m->step;
        if (ring >= 0 && ring < m->rings && row >= 0 && row < m->rows)
            m->sector[(size_t)row * (size_t)m->rings + (size_t)ring] |= UINT64_C(1) << sector_of(du, dv);
    }
}

static int sectors_seen(const map *m, int row, int ring)
{
    uint64_t bits = 0;
    for (int r = ring > 0 ? ring - 1 : 0; r <= ring + 1 && r < m->rings; r++)
        for (int w = row > 0 ? row - 1 : 0; w <= row + 1 && w < m->rows; w++)
            bits |= m->sector[(size_t)w * (size_t)m->rings + (size_t)r];
    int n = 0;
    for (; bits; bits &= bits - 1) n++;
    return n;
}

/* The outermost ring of a row that is seen in nearly as many sectors as the best one; -1 where none is seen enough. */
static int wall_ring(const map *m, int row, int *seen)
{
    int best = 0, ring = -1;
    for (int r = (int)least_radius; r < m->rings; r++) {
        const int n = sectors_seen(m, row, r);
        if (n > best) best = n;
    }
    if (best < least_coverage * SECTORS) return -1;
    for (int r = (int)least_radius; r < m->rings; r++)
        if (sectors_seen(m, row, r) >= 0.92 * best) ring = r;
    *seen = best;
    /* Seen rings are three wide: the middle of the outermost three. */
    return ring - 1 >= (int)least_radius && sectors_seen(m, row, ring - 1) >= 0.92 * best ? ring - 1 : ring;
}

/* The run of rows with the largest seen wall. Rows without wall inside of the run get the ring below. */
static bool best_run(const map *m, int *first, int *count, int ring_of[PLM_POT_ROWS])
{
    int ring[PLM_POT_ROWS], seen[PLM_POT_ROWS];
    for (int row = 0; row < m->rows; row++) ring[row] = wall_ring(m, row, &seen[row]);
    double best = 0;
    for (int start = 0; start < m->rows; start++) {
        if (ring[start] < 0) continue;
        int last = start;
        double area = 0;
        for (int row = start; row < m->rows && row - last <= GAP; row++) {
            if (ring[row] < 0 || abs(ring[row] - ring[last]) > 2 + (row - last)) continue;
            area += (double)seen[row] * ring[row];
            last = row;
        }
        if (area > best) {
            best = area;
            *first = start;
            *count = last - start + 1;
        }
    }
    if (!(best > 0)) return false;
    int known = ring[*first];
    for (int i = 0; i < *count; i++) {
        const int r = ring[*first + i];
        if (r >= 0 && abs(r - known) <= 2 + GAP) known = r;
        ring_of[i] = known;
    }
    return true;
}

/* Moves the axis (place and slant) so that the wall's patches lie evenly around it; gives their scatter. */
static void centre_axis(const plm_stand *t, bool round, plm_pot *pot)
{
    const double band = fmax(3 * t->surfels->cell, 0.08 * pot->radius[pot->rows / 2]);
    double a[16] = {0}, b[4] = {0}, squares = 0, n = 0;
    const double middle = 0.5 * (pot->foot + pot->rim), half = fmax(0.5 * (pot->rim - pot->foot), t->surfels->cell);
    for (size_t k = 0; k < t->surfels->count; k++) {
        double du, dv;
        const double w = t->place[k][2];
        if (w < pot->foot || w > pot->rim || !faces(t, k, pot, round, &du, &dv)) continue;
        const double shape = shape_at(pot->shape, du, dv), r = sqrt(du * du + dv * dv);
        const double off = r - plm_pot_radius(pot, w) * shape;
        if (fabs(off) > band) continue;
        const double x = (w - middle) / half, row[4] = {du / r, dv / r, x * du / r, x * dv / r};
        for (int i = 0; i < 4; i++) {
            for (int j = 0; j < 4; j++) a[4 * i + j] += row[i] * row[j];
            b[i] += row[i] * off;
        }
        squares += off * off;
        n++;
    }
    pot->scatter = n > 0 ? sqrt(squares / n) : INFINITY;
    for (int i = 0; i < 4; i++) a[5 * i] += 1e-3 * n; /* no slant from half a wall */
    if (n < 20 || !plm_solve_spd(4, a, b)) return;
    for (int i = 0; i < 2; i++) {
        pot->slant[i] += b[2 + i] / half;
        pot->centre[i] += b[i] - b[2 + i] * (middle - pot->foot) / half;
    }
}

/* The outline from the wall itself: in each direction the ratio to the rows' radius at which most patches lie. A level
 * gave a first one, where leaves may hide corners and widen sides. Directions without wall take their neighbours'. */
static void refine_shape(const plm_stand *t, plm_pot *pot)
{
    enum { BINS = 40 };
    static const double range = 0.25;
    double histogram[PLM_OUTLINE][BINS] = {{0}}, ratio[PLM_OUTLINE], smooth[PLM_OUTLINE], mean = 0;
    for (size_t k = 0; k < t->surfels->count; k++) {
        double du, dv;
        const double w = t->place[k][2];
        if (w < pot->foot || w > pot->rim || !faces(t, k, pot, false, &du, &dv)) continue;
        const double q = hypot(du, dv) / (shape_at(pot->shape, du, dv) * plm_pot_radius(pot, w)) - 1;
        if (fabs(q) >= range) continue;
        const int d = (int)lround(atan2(dv, du) / (2 * PLM_PI) * PLM_OUTLINE + PLM_OUTLINE) % PLM_OUTLINE;
        histogram[d][(int)((q + range) / (2 * range) * BINS)]++;
    }
    for (int d = 0; d < PLM_OUTLINE; d++) {
        double best = 0;
        ratio[d] = 0; /* unknown */
        for (int b = 1; b + 1 < BINS; b++) {
            const double *h = histogram[d] + b, sum = h[-1] + h[0] + h[1];
            if (sum < 4 || sum <= best) continue;
            best = sum;
            ratio[d] = 1 + range * (2 * (b + 0.5 + (h[1] - h[-1]) / sum) / BINS - 1);
        }
    }
    for (int d = 0; d < PLM_OUTLINE; d++) { /* median of the known ones among five, or the nearest known on each side */
        double near[5];
        int n = 0;
        for (int reach = 2; n == 0 && reach < PLM_OUTLINE / 2; reach++)
            for (int e = -reach; e <= reach && n < 5; e++) {
                const double r = ratio[(d + e + PLM_OUTLINE) % PLM_OUTLINE];
                if (r > 0) near[n++] = r;
            }
        for (int i = 1; i < n; i++)
            for (int j = i; j > 0 && near[j] < near[j - 1]; j--) {
                const double other = near[j];
                near[j] = near[j - 1];
                near[j - 1] = other;
            }
        smooth[d] = n ? 0.5 * (near[(n - 1) / 2] + near[n / 2]) : 1;
    }
    for (int d = 0; d < PLM_OUTLINE; d++) mean += pot->shape[d] * smooth[d] / PLM_OUTLINE;
    for (int d = 0; d < PLM_OUTLINE; d++) pot->shape[d] *= smooth[d] / mean;
}

/* Mean radius of the wall's patches in each row, near the ring that the map gave. */
static void refine_radius(const plm_stand *t, bool round, plm_pot *pot)
{
    double sum[PLM_POT_ROWS] = {0}, n[PLM_POT_ROWS] = {0};
    const double band = 2 * t->surfels->cell;
    for (size_t k = 0; k < t->surfels->count; k++) {
        double du, dv;
        const double w = t->place[k][2];
        const int row = (int)((w - pot->foot) / pot->step);
        if (w < pot->foot || row >= pot->rows || !faces(t, k, pot, round, &du, &dv)) continue;
        const double r = sqrt(du * du + dv * dv) / shape_at(pot->shape, du, dv);
        if (fabs(r - pot->radius[row]) > band) continue;
        sum[row] += r;
        n[row]++;
    }
    for (int row = 0; row < pot->rows; row++)
        if (n[row] > 5) pot->radius[row] = sum[row] / n[row];
}

static bool trace_wall(const plm_stand *t, bool round, map *m, plm_pot *pot, double *area)
{
    int first = 0, count = 0, ring[PLM_POT_ROWS];
    fill_map(t, pot, round, m);
    if (!best_run(m, &first, &count, ring)) return false;
    const double foot = m->low + first * m->step;
    for (int i = 0; i < 2; i++) pot->centre[i] += pot->slant[i] * (foot - pot->foot);
    pot->foot = foot;
    pot->rows = count;
    pot->step = m->step;
    pot->rim = pot->foot + count * m->step;
    *area = 0;
    for (int row = 0; row < count; row++) {
        pot->radius[row] = (ring[row] + 0.5) * t->surfels->cell;
        *area += (double)sectors_seen(m, first + row, ring[row]) / SECTORS * pot->radius[row] * m->step;
    }
    double covered = 0;
    for (int row = 0; row < count; row++) covered += (double)sectors_seen(m, first + row, ring[row]) / SECTORS;
    pot->coverage = covered / count;
    return true;
}

/* Traces the wall around a first axis, in rounds of centring and tracing. Gives its area over 2 pi; 0 for none. */
static double wall_around(const plm_stand *t, map *m, plm_pot *pot, bool round)
{
    double area = 0;
    for (int i = 0; i < REFINEMENTS; i++) {
        if (!trace_wall(t, round, m, pot, &area)) return 0;
        centre_axis(t, round, pot);
        if (!round && i >= 1) refine_shape(t, pot);
    }
    if (!trace_wall(t, round, m, pot, &area)) return 0;
    refine_radius(t, round, pot);
    return area;
}

/* ---- What is inside ------------------------------------------------------------------------------------------- */

/* Soil: the height near the rim at which most horizontal patches lie inside of the wall. */
static void look_inside(const plm_stand *t, plm_pot *pot)
{
    enum { BINS = 128 };
    const double cell = t->surfels->cell, top = pot->radius[pot->rows - 1];
    const double low = fmax(pot->foot + 0.15 * (pot->rim - pot->foot), pot->rim - 1.5 * top),
                 high = pot->rim + 0.25 * top;
    double histogram[BINS] = {0}, wall = 0, inside = 0;
    for (size_t k = 0; k < t->surfels->count; k++) {
        const double p[3] = {t->place[k][0], t->place[k][1], t->place[k][2]};
        if (p[2] < low || p[2] >= high || t->upright[k] < 0.7) continue;
        if (plm_pot_distance(pot, p) > plm_pot_radius(pot, p[2]) - 2 * cell) continue;
        histogram[(int)((p[2] - low) / (high - low) * BINS)]++;
    }
    double best = 0;
    const double bin = (high - low) / BINS;
    const int half = (int)ceil(fmax(2 * cell, 0.04 * top) / bin);
    for (int b = 0; b < BINS; b++) {
        double sum = 0, moment = 0;
        for (int c = b - half; c <= b + half; c++)
            if (c >= 0 && c < BINS) sum += histogram[c], moment += histogram[c] * (c + 0.5);
        if (sum > best) best = sum, pot->soil = low + moment / sum * bin;
    }
    pot->lid = best * cell * cell / (PLM_PI * top * top);
    pot->soil_seen = pot->lid > 0.1;
    if (!pot->soil_seen) pot->soil = pot->rim;
    for (size_t k = 0; k < t->surfels->count; k++) {
        const double p[3] = {t->place[k][0], t->place[k][1], t->place[k][2]};
        if (p[2] < pot->foot + 2 * cell || p[2] > pot->soil - 3 * cell) continue;
        const double r = plm_pot_distance(pot, p), radius = plm_pot_radius(pot, p[2]);
        wall += fabs(r - radius) <= 2 * cell;
        inside += r < 0.8 * radius;
    }
    pot->filled = wall > 0 ? inside / wall : 1;
}

/* How much a wall looks like a pot: its area, less for thin tall tubes, bodies that are filled, and missing lids. */
static double merit(const plm_pot *pot, double area)
{
    const double top = pot->radius[pot->rows - 1];
    if (pot->rim - pot->foot > 6 * top || pot->rim - pot->foot < 0.15 * top) return 0;
    if (hypot(pot->slant[0], pot->slant[1]) > 0.25) return 0;
    if (pot->filled > (pot->round && pot->lid > under_soil ? hollow_under_soil : hollow)) return 0;
    if (pot->scatter > 0.06 * top + 1.0 * pot->step) return 0;
    return area * pot->coverage * (0.2 + fmin(pot->lid, 0.8));
}

typedef struct hunt {
    const plm_stand *stand;
    map map;
    plm_pot best;
    double merit;
} hunt;

static void try_axis(hunt *h, const double centre[2], const plm_level *level)
{
    plm_pot pot = {.round = !level, .centre = {centre[0], centre[1]}, .foot = h->map.low};
    double mean = 0;
    for (int d = 0; d < PLM_OUTLINE; d++) {
        if (level && !(level->radius[d] > 0)) return; /* one row of cells: no outline */
        mean += level ? level->radius[d] / PLM_OUTLINE : 1.0 / PLM_OUTLINE;
    }
    for (int d = 0; d < PLM_OUTLINE; d++) pot.shape[d] = level ? level->radius[d] / mean : 1;
    const double area = wall_around(h->stand, &h->map, &pot, !level);
    if (!(area > 0)) return;
    look_inside(h->stand, &pot);
    const double m = merit(&pot, area);
    if (m > h->merit) {
        h->merit = m;
        h->best = pot;
    }
}

plm_status plm_find_pot(const plm_stand *stand, const plm_level *level, int levels, bool *found, plm_pot *pot,
                        plm_error *error)
{
    const plm_surfels *s = stand->surfels;
    float low = INFINITY, high = -INFINITY;
    for (size_t k = 0; k < s->count; k++) {
        low = fminf(low, stand->place[k][2]);
        high = fmaxf(high, stand->place[k][2]);
    }
    hunt h = {.stand = stand, .map = {.low = low}};
    h.map.rings = (int)(0.75 * (stand->size[0] > stand->size[1] ? stand->size[0] : stand->size[1])) * 2 + 2;
    h.map.step = fmax(1.5 * s->cell, (high - low) / (PLM_POT_ROWS - 1));
    h.map.rows = s->count ? (int)((high - low) / h.map.step) + 1 : 0;
    h.map.sector = plm_alloc((size_t)h.map.rings * (size_t)h.map.rows, sizeof *h.map.sector, error);
    float *votes = plm_alloc((size_t)stand->size[0] * (size_t)stand->size[1], sizeof *votes, error);
    const bool room = h.map.sector && votes;
    if (room) {
        static const double zone[ZONES] = {0.12, 0.25, 0.5, 1};
        for (int z = 0; z < ZONES; z++) {
            vote(stand, low + zone[z] * (high - low), votes);
            for (int p = 0; p < PEAKS; p++) {
                double centre[2];
                if (best_place(stand, votes, centre)) try_axis(&h, centre, NULL);
            }
        }
        for (int i = 0; i < levels; i++) try_axis(&h, level[i].centre, &level[i]);
        *found = h.merit > 0;
        if (*found) *pot = h.best;
    }
    plm_free(votes);
    plm_free(h.map.sector);
    return room ? PLM_OK : PLM_E_MEMORY;
}
