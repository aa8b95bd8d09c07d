/* segment/judge_tubes.c: noise, rims and the inner leaves of heads look like tubes, too; what leaves those leave is unlike a plant's. */
#include "segment/judge_tubes.h"

#include "segment/scratch.h"

#include <math.h>

/* Doubtful tubes were petioles of a rosette where they part the blades into leaves of which none is half of the plant, and a share PETIOLED
 * have one, unless the user says rosette. (On 24 virtual rosettes the largest has 0.33 at most, and 0.7 of the leaves have petioles. Of
 * single leaves noise parts a rim or a fold and leaves 0.57 or more, or parts them into many, of which 0.52 at most have tubes.) Of fewer
 * than PETIOLED_SURE sure tubes were none, either: 0.08 to 0.25 of three single leaves as splats, 0.59 and more of 110 rosettes;
 * so a rosette of one leaf has a petiole, or is a single leaf. */
static const double LARGEST = 0.5, PETIOLED = 0.55, PETIOLED_SURE = 0.4;
/* A rosette's are no fewer of its points (0.002 of a single leaf as a splat; 0.041 and more of 32 rosettes). */
static const double TUBES_LEAST = 0.01;
/* Doubtful tubes were a stem and petioles where that stem goes straight (its ends' distance over its length), tubes are few, leaves have
 * petioles, and none is most of the plant: sparse plants of 3 000 to 12 000 points, whose few points on the stem make short tubes. (Of five
 * such plants stems are 0.98 straight and more, 0.035 to 0.106 of the points tubes, 0.44 and more of the leaves have petioles; of lettuces
 * seven of eight stems 0.36 to 0.84, tubes 0.094 to 0.336; the leaves of the eighth have no petioles.) */
static const double STRAIGHT_STEM = 0.9, STEM_TUBES = 0.12;
enum { PETIOLE_LEAST = 3 /* points */ };

typedef struct leaf_look {
    double largest;  /* share of the blades' points in one of them */
    double petioled; /* share that has petioles */
    double tubes;    /* share of all points */
} leaf_look;

static plm_status look_at_leaves(const plm_sketch *sketch, leaf_look *look, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    size_t *blade = plm_scratch_take(&scratch, sketch->leaf_count + 1, sizeof *blade);
    size_t *petiole = plm_scratch_take(&scratch, sketch->leaf_count + 1, sizeof *petiole);
    const plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) {
        size_t all = 0, largest = 0, petioled = 0, tubes = 0;
        for (size_t i = 0; i < sketch->working.count; i++) {
            tubes += sketch->is_tube[i];
            if (sketch->leaf[i] >= 0) ++(sketch->is_tube[i] ? petiole : blade)[sketch->leaf[i]];
        }
        for (size_t k = 0; k < sketch->leaf_count; k++) {
            all += blade[k];
            if (blade[k] > largest) largest = blade[k];
            petioled += petiole[k] >= PETIOLE_LEAST;
        }
        look->largest = all ? (double)largest / (double)all : 1;
        look->petioled = sketch->leaf_count ? (double)petioled / (double)sketch->leaf_count : 0;
        look->tubes = (double)tubes / (double)sketch->working.count;
    }
    plm_scratch_free(&scratch, NULL);
    return status;
}

static bool is_straight(const plm_stem_path *stem)
{
    if (!stem->count) return false;
    const double *a = stem->node[0], *b = stem->node[stem->count - 1];
    return hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]) >= STRAIGHT_STEM * stem->along[stem->count - 1];
}

plm_status plm_judge_tubes(const plm_sketch *sketch, bool is_told, bool *believed, plm_error *error)
{
    leaf_look look = {0};
    const plm_status status = look_at_leaves(sketch, &look, error);
    if (status != PLM_OK) return status;
    const bool is_rosette = sketch->habit == PLM_HABIT_ROSETTE;
    const bool has_petioles = sketch->habit == PLM_HABIT_SIMPLE || sketch->habit == PLM_HABIT_COMPOUND;
    if (!sketch->scale.is_doubtful) {
        *believed = !is_rosette || is_told || !sketch->leaf_count ||
                    (look.petioled >= PETIOLED_SURE && look.tubes >= TUBES_LEAST);
    } else if (is_rosette) {
        *believed = look.largest <= LARGEST && (is_told || look.petioled >= PETIOLED);
    } else {
        *believed = has_petioles && is_straight(&sketch->stem) && look.tubes < STEM_TUBES && look.largest <= LARGEST &&
                    look.petioled >= PETIOLED_SURE;
    }
    return PLM_OK;
}
