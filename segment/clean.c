/* segment/clean.c: floaters and ghost points, judged on a thinned copy: first point by point (segment/ghosts.c), then
 * clusters of floaters: small pieces, further from the next larger piece than they are long. Where no depth camera leaves
 * ghosts off rims, sparse tips of leaves are told from floaters at last (segment/sparse_tips.c). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cloud/neighbours.h"
#include "segment/ghosts.h"
#include "segment/scale.h"
#include "segment/segment.h"
#include "segment/sparse_tips.h"
#include "segment/thinning.h"

enum { BUDGET = 80000, NEAREST = 8, SIXTH = 5, FEWEST = 10 * PLM_GHOST_NEIGHBOURS, AROUND = 256 };

static const double likely = 0.5;        /* probability from which on a point is dropped */
static const double small_share = 0.004; /* of the thinned points: a larger piece is never a floater */
static const double link_far = 3,
                    link_near = 1.3; /* spacings, or distances to the sixth: what holds a piece together */
static const double gap = 6;         /* spacings between a cluster of floaters and the rest, at least */
/* Of what is kept: more sparse tips are leaves that were seen seldom (virtual splats: 0.0003 of nine clouds in ten, 0.005 to 0.06 of those
 * that lost a leaf with them; 0.0023 at most of 41 real clouds). */
static const double many_tips = 0.004;

typedef struct sieve {
    size_t count;
    const float (*xyz)[3];
    plm_index *index;
    uint32_t *row;  /* count x NEAREST: neighbours, nearest first */
    float *squared; /* their squared distances */
    bool *drop;
    uint32_t *parent; /* of the union of pieces */
    uint32_t *size;
    double *longest, *apart; /* of small pieces, at their root: extent, distance to the next larger piece */
    float (*low)[3], (*high)[3];
} sieve;

static float sixth(const sieve *s, size_t i)
{
    return sqrtf(s->squared[i * NEAREST + SIXTH]);
}

/* ---- Clusters ------------------------------------------------------------------------------------------------- */

static uint32_t root(sieve *s, uint32_t i)
{
    while (s->parent[i] != i) i = s->parent[i] = s->parent[s->parent[i]];
    return i;
}

static void join_pieces(sieve *s, double spacing)
{
    for (size_t i = 0; i < s->count; i++) s->parent[i] = (uint32_t)i;
    for (size_t i = 0; i < s->count; i++)
        for (size_t j = 0; j < NEAREST && !s->drop[i]; j++) {
            const uint32_t other = s->row[i * NEAREST + j];
            if (s->drop[other]) continue;
            /* sparse parts of a plant hold together, floaters as sparse as one another do not */
            const double own = fmin(link_near * fminf(sixth(s, i), sixth(s, other)), gap * spacing),
                         reach = fmax(link_far * spacing, own);
            if (s->squared[i * NEAREST + j] > reach * reach) continue;
            const uint32_t a = root(s, (uint32_t)i), b = root(s, other);
            s->parent[a > b ? a : b] = a > b ? b : a;
        }
    for (size_t i = 0; i < s->count; i++) {
        const uint32_t r = root(s, (uint32_t)i);
        if (s->drop[i]) continue;
        for (int a = 0; a < 3; a++) {
            s->low[r][a] = s->size[r] ? fminf(s->low[r][a], s->xyz[i][a]) : s->xyz[i][a];
            s->high[r][a] = s->size[r] ? fmaxf(s->high[r][a], s->xyz[i][a]) : s->xyz[i][a];
        }
        s->size[r]++;
    }
}

/* Distance from a point to the nearest kept point of another piece, as far as its nearest ones tell. */
static double distance_to_others(sieve *s, size_t i)
{
    uint32_t near[AROUND];
    float squared[AROUND];
    const size_t n = plm_index_nearest(s->index, s->xyz[i], AROUND, near, squared);
    for (size_t j = 0; j < n; j++)
        if (!s->drop[near[j]] && root(s, near[j]) != root(s, (uint32_t)i)) return sqrt(squared[j]);
    return n < AROUND ? INFINITY : sqrt(squared[n - 1]);
}

static void drop_clusters(sieve *s, double spacing)
{
    join_pieces(s, spacing);
    const double most = fmin(fmax(6, small_share * (double)s->count), AROUND / 2);
    for (size_t i = 0; i < s->count; i++) {
        const uint32_t r = root(s, (uint32_t)i);
        if (s->drop[i] || s->size[r] >= most) continue;
        if (s->apart[r] == 0) {
            s->apart[r] = INFINITY;
            for (int a = 0; a < 3; a++) s->longest[r] = hypot(s->longest[r], (double)s->high[r][a] - s->low[r][a]);
        }
        s->apart[r] = fmin(s->apart[r], distance_to_others(s, i));
    }
    for (size_t i = 0; i < s->count; i++) {
        const uint32_t r = root(s, (uint32_t)i);
        if (!s->drop[i] && s->size[r] < most && s->apart[r] > fmax(gap * spacing, s->longest[r])) s->drop[i] = true;
    }
}

/* ---- All together --------------------------------------------------------------------------------------------- */

/* tip: out, what of the dropped is a sparse tip; NULL: not asked for. */
static plm_status sift(const float (*xyz)[3], size_t count, double spacing, bool *drop, bool *tip, plm_error *error)
{
    sieve s = {.count = count, .xyz = xyz, .drop = drop};
    plm_status status = plm_index_build(xyz, count, &s.index, error);
    s.row = plm_alloc(count * NEAREST, sizeof *s.row, error);
    s.squared = plm_alloc(count * NEAREST, sizeof *s.squared, error);
    s.parent = plm_alloc(count, sizeof *s.parent, error);
    s.size = plm_alloc_zero(count, sizeof *s.size, error);
    s.longest = plm_alloc_zero(count, sizeof *s.longest, error);
    s.apart = plm_alloc_zero(count, sizeof *s.apart, error);
    s.low = plm_alloc(count, sizeof *s.low, error);
    s.high = plm_alloc(count, sizeof *s.high, error);
    const bool room = s.row && s.squared && s.parent && s.size && s.longest && s.apart && s.low && s.high;
    if (status == PLM_OK && !room) status = PLM_E_MEMORY;
    if (status == PLM_OK) status = plm_index_table(s.index, NEAREST, s.row, s.squared, error);
    if (status == PLM_OK) drop_clusters(&s, spacing);
    if (status == PLM_OK && tip) status = plm_sparse_tips(s.index, xyz, count, drop, tip, error);
    plm_index_free(s.index);
    plm_free(s.row);
    plm_free(s.squared);
    plm_free(s.parent);
    plm_free(s.size);
    plm_free(s.longest);
    plm_free(s.apart);
    plm_free(s.low);
    plm_free(s.high);
    return status;
}

/* Likely ghosts and floaters, and the median distance of nearest neighbours. */
static plm_status judge(const float (*xyz)[3], size_t count, bool *drop, double *spacing, plm_error *error)
{
    float(*feature)[PLM_GHOST_FEATURES] = plm_alloc(count, sizeof *feature, error);
    float *squared = plm_alloc(count, sizeof *squared, error);
    plm_status status = feature && squared ? plm_neighbour_table(xyz, count, 1, NULL, squared, error) : PLM_E_MEMORY;
    if (status == PLM_OK) {
        *spacing = sqrt((double)plm_quantile(squared, count, 0.5));
        if (count >= FEWEST) status = plm_ghost_features(xyz, count, feature, error);
    }
    const int64_t rows = status == PLM_OK && count >= FEWEST ? (int64_t)count : 0;
#pragma omp parallel for schedule(static)
    for (int64_t i = 0; i < rows; i++) drop[i] = plm_ghost_probability(feature[i]) > likely;
    plm_free(feature);
    plm_free(squared);
    return status;
}

/* tip may be NULL. */
static plm_status clean(const float (*xyz)[3], const uint32_t *row, size_t count, bool *keep, bool *tip,
                        double *spacing, plm_error *error)
{
    plm_thinned thinned = {0};
    bool *drop = NULL, *sparse = NULL, fused = true;
    double cell = 0; /* as many points as there are */
    *spacing = 0;
    if (count < 2) return PLM_OK;
    plm_status status = count > BUDGET ? plm_thin_cell(xyz, count, BUDGET, &cell, error) : PLM_OK;
    if (status == PLM_OK) status = plm_thin(xyz, count, cell, &thinned, error);
    if (status == PLM_OK && !(drop = plm_alloc_zero(thinned.count, sizeof *drop, error))) status = PLM_E_MEMORY;
    const float(*few)[3] = (const float(*)[3])thinned.xyz;
    if (status == PLM_OK && thinned.count > 1) status = judge(few, thinned.count, drop, spacing, error);
    if (status == PLM_OK && tip && thinned.count >= FEWEST)
        status = plm_are_voxel_means(xyz, count, thinned.cell, &fused, error);
    if (status == PLM_OK && !fused && !(sparse = plm_alloc_zero(thinned.count, sizeof *sparse, error)))
        status = PLM_E_MEMORY;
    if (status == PLM_OK && thinned.count >= FEWEST) status = sift(few, thinned.count, *spacing, drop, sparse, error);
    for (size_t i = 0; i < count && status == PLM_OK; i++) {
        keep[row[i]] = !drop[thinned.voxels.owner[i]];
        if (sparse) tip[row[i]] = sparse[thinned.voxels.owner[i]];
    }
    plm_free(sparse);
    plm_free(drop);
    plm_thinned_free(&thinned);
    return status;
}

/* row: the points that were judged. */
static void keep_many_tips(const uint32_t *row, size_t count, bool *keep, bool *tip)
{
    size_t kept = 0, tips = 0;
    for (size_t i = 0; i < count; i++) kept += keep[row[i]], tips += tip[row[i]];
    if ((double)tips <= many_tips * (double)kept) return;
    for (size_t i = 0; i < count; i++) {
        keep[row[i]] = keep[row[i]] || tip[row[i]];
        tip[row[i]] = false;
    }
}

plm_status plm_clean(const plm_cloud *cloud, const uint8_t *label, bool *keep, double *spacing, plm_error *error)
{
    return plm_clean_but_tips(cloud, label, keep, NULL, spacing, error);
}

plm_status plm_clean_but_tips(const plm_cloud *cloud, const uint8_t *label, bool *keep, bool *tip, double *spacing,
                              plm_error *error)
{
    uint32_t *row = plm_alloc(cloud->count, sizeof *row, error);
    float(*xyz)[3] = plm_alloc(cloud->count, sizeof *xyz, error);
    bool *draft = plm_alloc(cloud->count, sizeof *draft, error);
    plm_status status = row && xyz && draft ? PLM_OK : PLM_E_MEMORY;
    if (tip) memset(tip, 0, cloud->count * sizeof *tip);
    if (status == PLM_OK) {
        size_t count = 0;
        double found = 0;
        for (size_t i = 0; i < cloud->count; i++) {
            draft[i] = true;
            if (label && label[i] == PLM_LABEL_GROUND) continue;
            memcpy(xyz[count], cloud->xyz[i], sizeof *xyz);
            row[count++] = (uint32_t)i;
        }
        status = clean((const float(*)[3])xyz, row, count, draft, tip, &found, error);
        if (status == PLM_OK) {
            memcpy(keep, draft, cloud->count * sizeof *keep);
            if (tip) keep_many_tips(row, count, keep, tip);
            if (spacing) *spacing = found;
        }
    }
    plm_free(row);
    plm_free(xyz);
    plm_free(draft);
    return status;
}
