/* segment/segmentation.c: plm_segment: gathers the plant's points, runs the stages on the sketch, carries the labels to
 * all points. */
#include "segment/segment.h"

#include "cloud/voxel_pitch.h"
#include "segment/blade_base.h"
#include "segment/core.h"
#include "segment/head.h"
#include "segment/judge_tubes.h"
#include "segment/petiole_foot.h"
#include "segment/rosette_borders.h"
#include "segment/rosette_links.h"
#include "segment/rosette_petioles.h"
#include "segment/rosette_pieces.h"
#include "segment/scratch.h"
#include "segment/sketch.h"

#include <string.h>

const char *plm_habit_name(plm_habit habit)
{
    static const char *const name[] = {"unknown", "simple", "compound",    "strap",
                                       "rosette", "head",   "single_leaf", "bare_stem"};
    return (size_t)habit < sizeof name / sizeof *name ? name[habit] : "unknown";
}

void plm_segmentation_free(plm_segmentation *segmentation)
{
    if (!segmentation) return;
    plm_free(segmentation->label);
    plm_free(segmentation->organ);
    plm_free(segmentation->leaflet);
    plm_free(segmentation->leaf_flags);
    *segmentation = (plm_segmentation){0};
}

/* The plant's points: neither ground nor noise. row[i]: where point i came from. Their box's low corner becomes 0, so
 * that voxels are the same wherever the plant stands; low: that corner. */
static size_t gather(const plm_cloud *cloud, const uint8_t *label, const bool *keep, float (*xyz)[3], uint32_t *row,
                     float low[3])
{
    size_t count = 0;
    for (size_t i = 0; i < cloud->count; i++) {
        if ((label && label[i] == PLM_LABEL_GROUND) || (keep && !keep[i])) continue;
        for (int axis = 0; axis < 3; axis++)
            if (!count || cloud->xyz[i][axis] < low[axis]) low[axis] = cloud->xyz[i][axis];
        row[count++] = (uint32_t)i;
    }
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) xyz[i][axis] = cloud->xyz[row[i]][axis] - low[axis];
    return count;
}

static uint8_t class_of(const plm_sketch *sketch, size_t i)
{
    if (sketch->is_stem[i]) return PLM_LABEL_STEM;
    if (sketch->leaf[i] < 0) return sketch->is_tube[i] ? PLM_LABEL_STEM : PLM_LABEL_OTHER;
    return sketch->is_tube[i] ? PLM_LABEL_PETIOLE : PLM_LABEL_LEAF;
}

/* Labels of the points that were gathered. */
static void carry(const plm_sketch *sketch, const uint32_t *row, size_t count, plm_segmentation *out)
{
    for (size_t i = 0; i < count; i++) {
        const uint32_t w = sketch->working.voxels.owner[sketch->base.voxels.owner[i]];
        const uint8_t label = class_of(sketch, w);
        out->label[row[i]] = label;
        out->organ[row[i]] = label == PLM_LABEL_STEM ? 0 : label == PLM_LABEL_OTHER ? -1 : sketch->leaf[w];
        if (out->leaflet) out->leaflet[row[i]] = label == PLM_LABEL_LEAF ? sketch->leaflet[w] : -1;
    }
}

static void count_organs(plm_segmentation *out)
{
    size_t petioles = 0;
    for (size_t i = 0; i < out->count; i++) {
        if (out->label[i] == PLM_LABEL_STEM) out->stem_count = 1;
        if (out->label[i] == PLM_LABEL_PETIOLE && (size_t)out->organ[i] + 1 > petioles)
            petioles = (size_t)out->organ[i] + 1;
    }
    out->petiole_count = petioles;
}

static plm_status result_start(const plm_cloud *cloud, const uint8_t *label, plm_segmentation *out, plm_error *error)
{
    out->count = cloud->count;
    out->label = plm_alloc(cloud->count, sizeof *out->label, error);
    out->organ = plm_alloc(cloud->count, sizeof *out->organ, error);
    if (!out->label || !out->organ) return PLM_E_MEMORY;
    for (size_t i = 0; i < cloud->count; i++) {
        out->label[i] = label && label[i] == PLM_LABEL_GROUND ? PLM_LABEL_GROUND : PLM_LABEL_OTHER;
        out->organ[i] = -1;
    }
    return PLM_OK;
}

static plm_status result_leaflets(plm_segmentation *out, plm_error *error)
{
    out->leaflet = plm_alloc(out->count, sizeof *out->leaflet, error);
    if (!out->leaflet) return PLM_E_MEMORY;
    for (size_t i = 0; i < out->count; i++) out->leaflet[i] = -1;
    return PLM_OK;
}

/* A caller who knows that there is no stem among tubes spares the search for one. */
static bool may_have_stem(plm_habit habit)
{
    return habit != PLM_HABIT_ROSETTE && habit != PLM_HABIT_HEAD && habit != PLM_HABIT_SINGLE_LEAF;
}

static plm_status find_organs(const float (*xyz)[3], size_t count, const plm_segment_options *options, plm_tubes tubes,
                              plm_sketch *sketch, plm_error *error)
{
    plm_sketch_free(sketch);
    plm_status status = plm_sketch_make(xyz, count, options->point_budget, tubes, sketch, error);
    sketch->asked = options->habit;
    if (status == PLM_OK) status = plm_deadline_check(options->deadline, error);
    if (status == PLM_OK) status = plm_sketch_tidy(sketch, error);
    /* What tubes a blurred plant shows are petioles of a rosette, or none. */
    const bool stemless = tubes != PLM_TUBES_SURE && sketch->scale.is_doubtful && sketch->scale.is_blurred;
    if (status == PLM_OK && may_have_stem(options->habit) && !stemless) status = plm_sketch_stem(sketch, error);
    if (status == PLM_OK) status = plm_deadline_check(options->deadline, error);
    if (status == PLM_OK && sketch->stem.count > 0) status = plm_sketch_stem_end(sketch, error);
    if (status == PLM_OK) status = plm_deadline_check(options->deadline, error);
    if (status == PLM_OK) status = plm_sketch_leaves(sketch, error);
    if (status == PLM_OK) status = plm_deadline_check(options->deadline, error);
    if (status == PLM_OK) status = plm_sketch_fruit(sketch, error);
    if (status == PLM_OK) status = plm_sketch_strays(sketch, error);
    return status;
}

/* Blades without tubes are a single leaf or a head: their sheets tell. */
static bool may_be_head(plm_habit habit, const plm_sketch *sketch)
{
    const bool bladed = sketch->habit == PLM_HABIT_SINGLE_LEAF || sketch->habit == PLM_HABIT_HEAD;
    return habit == PLM_HABIT_HEAD || (habit == PLM_HABIT_UNKNOWN && !sketch->scale.has_tubes && bladed);
}

/* The voxels whose means the points are, and how strongly these gather in them; 0 where they are none. */
static plm_status find_voxels(const float (*xyz)[3], size_t count, plm_scale *scale, plm_error *error)
{
    plm_index *index = NULL;
    plm_sampling sampling = {0};
    plm_status status = plm_index_build(xyz, count, &index, error);
    if (status == PLM_OK) status = plm_sampling_measure(index, xyz, count, NULL, &sampling, error);
    if (status == PLM_OK) status = plm_voxels_measure(xyz, count, &sampling, error);
    scale->gathering = sampling.gathering;
    scale->pitch = sampling.gathering > 0 ? sampling.pitch : 0;
    plm_index_free(index);
    return status;
}

/* Of a blurred rosette the leaves tell of each other whose the petioles are, and where the blades begin. */
static plm_status rosette_petioles(const float (*xyz)[3], const uint32_t *row, size_t count, const double middle[3],
                                   const plm_sketch *sketch, plm_segmentation *out, plm_error *error)
{
    plm_status status = plm_rosette_petioles(xyz, row, count, middle, out, error);
    if (status == PLM_OK) status = plm_blade_bases(xyz, row, count, &sketch->scale, out, error);
    return status == PLM_OK ? plm_rosette_borders(xyz, row, count, &sketch->scale, middle, out, error) : status;
}

/* Where all petioles of a rosette meet; false in has where none do, and of other plants. */
static plm_status find_middle(const plm_sketch *sketch, double middle[3], bool *has, plm_error *error)
{
    *has = false;
    if (sketch->habit != PLM_HABIT_ROSETTE) return PLM_OK;
    uint32_t core;
    const plm_status status = plm_sketch_core(sketch, &core, error);
    if (status != PLM_OK || core == UINT32_MAX) return status;
    for (int a = 0; a < 3; a++) middle[a] = sketch->working.xyz[core][a];
    *has = true;
    return PLM_OK;
}

/* Petioles, told at all points. Those of a rosette have no stem that hides their feet. */
static plm_status refine_petioles(const float (*xyz)[3], const uint32_t *row, size_t count, plm_sketch *sketch,
                                  plm_segmentation *out, plm_error *error)
{
    const bool is_rosette = sketch->habit == PLM_HABIT_ROSETTE;
    double middle[3];
    bool has_middle;
    plm_status status = find_middle(sketch, middle, &has_middle, error);
    if (status == PLM_OK && !is_rosette) status = plm_petiole_feet(xyz, row, count, sketch, out, error);
    if (status == PLM_OK && has_middle) status = plm_rosette_links(xyz, row, count, middle, out, error);
    if (status != PLM_OK || !plm_simple_leaves(row, count, out)) return status;
    status = find_voxels(xyz, count, &sketch->scale, error);
    if (status != PLM_OK) return status;
    if (has_middle && plm_rosette_is_noisy(&sketch->scale))
        status = rosette_petioles(xyz, row, count, middle, sketch, out, error);
    else
        status = plm_blade_bases(xyz, row, count, &sketch->scale, out, error);
    /* Of voxel means it is ghosts that lie apart, and these are of no organ. */
    if (status != PLM_OK || !is_rosette || sketch->scale.pitch > 0) return status;
    return plm_rosette_pieces(xyz, row, count, out, error);
}

plm_status plm_segment(const plm_cloud *cloud, const uint8_t *label, const bool *keep,
                       const plm_segment_options *options, plm_segmentation *result, plm_error *error)
{
    static const plm_segment_options defaults = {0};
    if (!options) options = &defaults;
    plm_scratch scratch = {.error = error};
    plm_segmentation out = {0};
    plm_sketch sketch = {0};
    float(*xyz)[3] = plm_scratch_take(&scratch, cloud->count, sizeof *xyz);
    uint32_t *row = plm_scratch_take(&scratch, cloud->count, sizeof *row);
    plm_status status = scratch.failed ? PLM_E_MEMORY : result_start(cloud, label, &out, error);
    if (status != PLM_OK) goto done;
    float low[3] = {0};
    const size_t count = gather(cloud, label, keep, xyz, row, low);
    if (!count) {
        status = plm_fail(error, PLM_E_DEGENERATE, "the cloud has no points of a plant");
        goto done;
    }
    plm_tubes tubes = PLM_TUBES_SURE;
    if (options->habit == PLM_HABIT_UNKNOWN) tubes = PLM_TUBES_DOUBTFUL;
    if (options->habit == PLM_HABIT_ROSETTE) tubes = PLM_TUBES_ANY; /* the user saw petioles */
    status = find_organs((const float(*)[3])xyz, count, options, tubes, &sketch, error);
    bool believed = true; /* who says anything but rosette knows */
    if (status == PLM_OK && tubes != PLM_TUBES_SURE)
        status = plm_judge_tubes(&sketch, tubes == PLM_TUBES_ANY, &believed, error);
    if (status == PLM_OK && !believed)
        status = find_organs((const float(*)[3])xyz, count, options, PLM_TUBES_NONE, &sketch, error);
    if (status == PLM_OK && sketch.habit == PLM_HABIT_COMPOUND) status = result_leaflets(&out, error);
    if (status != PLM_OK) goto done;
    out.habit = sketch.habit;
    out.scale = sketch.scale.has_tubes ? sketch.scale.radius : 0;
    out.stem_radius = sketch.scale.stem_radius;
    out.spacing = sketch.scale.spacing;
    out.noise = sketch.scale.noise;
    carry(&sketch, row, count, &out);
    out.leaf_count = sketch.leaf_count;
    const bool heads = may_be_head(options->habit, &sketch);
    if (heads) status = plm_deadline_check(options->deadline, error);
    if (status == PLM_OK && heads) status = plm_find_head((const float(*)[3])xyz, row, count, out.noise, &out, error);
    const bool has_petioles =
        sketch.habit == PLM_HABIT_SIMPLE || sketch.habit == PLM_HABIT_ROSETTE || sketch.habit == PLM_HABIT_COMPOUND;
    if (status == PLM_OK && has_petioles && sketch.scale.has_tubes)
        status = refine_petioles((const float(*)[3])xyz, row, count, &sketch, &out, error);
    if (status != PLM_OK) goto done;
    count_organs(&out);
    out.leaf_flags = plm_alloc_zero(out.leaf_count + 1, sizeof *out.leaf_flags, error);
    if (!out.leaf_flags) {
        status = PLM_E_MEMORY;
        goto done;
    }
    *result = out;
    out = (plm_segmentation){0};
done:
    plm_segmentation_free(&out);
    plm_sketch_free(&sketch);
    plm_scratch_free(&scratch, NULL);
    return status;
}
