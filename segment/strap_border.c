/* segment/strap_border.c: in noise the stem takes what scatters as far as its own points do, and with them the foot of each
 * leaf. Foot and stem are sheets of like density under like noise, so a point is the more likely of the nearer one. A leaf
 * begins at the stem's surface, where its plane leaves it. */
#include "segment/strap_border.h"

#include "cloud/local_plane.h"
#include "cloud/neighbours.h"
#include "segment/scratch.h"
#include "segment/stem_fit.h"

#include <math.h>

static const double GAP = 3; /* cells: the leaf's points begin so near beyond those that the stem took */
enum { NEAREST = 48, FEWEST = 24 };

/* The points of leaves, by which the planes are told. */
typedef struct blades {
    size_t count;
    float (*xyz)[3];
    int32_t *leaf;
    plm_index *index;
} blades;

static plm_status index_blades(const plm_sketch *sketch, plm_scratch *scratch, blades *b)
{
    const size_t count = sketch->working.count;
    b->xyz = plm_scratch_take(scratch, count, sizeof *b->xyz);
    b->leaf = plm_scratch_take(scratch, count, sizeof *b->leaf);
    if (scratch->failed) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) {
        if (sketch->leaf[i] < 0 || sketch->is_stem[i]) continue;
        for (int a = 0; a < 3; a++) b->xyz[b->count][a] = sketch->working.xyz[i][a];
        b->leaf[b->count++] = sketch->leaf[i];
    }
    return b->count ? plm_index_build((const float(*)[3])b->xyz, b->count, &b->index, scratch->error) : PLM_OK;
}

/* The leaf that a point this far outside the stem's surface is nearer to than to the stem, -1: none. */
static int32_t nearer_leaf(const blades *b, const float place[3], double off, double gap)
{
    uint32_t row[NEAREST], mine[NEAREST];
    float squared[NEAREST];
    const size_t found = plm_index_nearest(b->index, place, NEAREST, row, squared);
    size_t most = 0, count = 0, first = 0;
    for (size_t k = 0; k < found; k++) {
        size_t same = 0;
        for (size_t j = 0; j < found; j++) same += b->leaf[row[j]] == b->leaf[row[k]];
        if (same > most) most = same, first = k;
    }
    if (most < FEWEST || sqrt((double)squared[first]) >= gap + off) return -1;
    for (size_t k = 0; k < found; k++)
        if (b->leaf[row[k]] == b->leaf[row[first]]) mine[count++] = row[k];
    const bool is_leaf = plm_local_plane_distance((const float(*)[3])b->xyz, mine, count, place, NULL) < off;
    return is_leaf ? b->leaf[row[first]] : -1;
}

plm_status plm_strap_border(plm_sketch *sketch, double shape, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    blades b = {0};
    const plm_status status = index_blades(sketch, &scratch, &b);
    for (size_t i = 0; b.index && i < sketch->working.count; i++) {
        const float *place = sketch->working.xyz[i];
        plm_stem_place at = {0};
        if (!sketch->is_stem[i]) continue;
        const double off = plm_stem_nearest(&sketch->stem, place, &at) - at.radius;
        if (!(off > (shape - 1) * at.radius)) continue;
        const int32_t leaf = nearer_leaf(&b, place, off, GAP * sketch->working.cell);
        if (leaf < 0) continue;
        sketch->leaf[i] = leaf;
        sketch->is_stem[i] = sketch->is_tube[i] = false;
    }
    plm_index_free(b.index);
    plm_scratch_free(&scratch, NULL);
    return status;
}
