/* segment/ground.c: ground, pot and table of a cloud whose z is up. What is looked for is in ground_scene.c, how the
 * points are told apart in ground_mark.c. */
#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "segment/ground_mark.h"
#include "segment/segment.h"

static const double fine = 200, coarse = 80;     /* voxels along the diagonal */
static const double lower_part[] = {0.35, 0.15}; /* of the height */
enum { PARTS = sizeof lower_part / sizeof *lower_part, fewest = 300 };

/* z of a place of the stand, origin added. */
static double height_of(const plm_cloud *cloud, const plm_stand *t, const double place[3], double xy[2])
{
    double xyz[3];
    for (int i = 0; i < 3; i++) {
        xyz[i] = t->surfels->low[i] + cloud->origin[i];
        for (int j = 0; j < 3; j++) xyz[i] += t->rotation[j][i] * place[j];
    }
    if (xy) memcpy(xy, xyz, 2 * sizeof *xy);
    return xyz[2];
}

static void report(const plm_cloud *cloud, const plm_ground_scene *scene, const plm_ground_marks *marks,
                   plm_ground *ground)
{
    *ground = (plm_ground){.found = true, .has_pot = scene->has_pot, .has_table = scene->table >= 0};
    ground->soil_height = height_of(cloud, &scene->stand, marks->foot, NULL);
    if (scene->has_pot) {
        ground->rim_height = height_of(cloud, &scene->stand, marks->rim, ground->pot_centre);
        ground->pot_diameter = 2 * marks->rim_radius;
    }
    if (scene->table >= 0) ground->table_height = height_of(cloud, &scene->stand, marks->table, NULL);
}

/* One look at a part of the cloud, and what it sees. */
typedef struct look {
    plm_cloud part; /* a selection; empty where the whole cloud is looked at */
    plm_surfels surfels;
    plm_ground_scene scene;
} look;

static void look_free(look *it)
{
    plm_ground_scene_free(&it->scene);
    plm_surfels_free(&it->surfels);
    plm_cloud_free(&it->part);
}

static plm_status look_at(const plm_cloud *cloud, double resolution, look *it, plm_error *error)
{
    static const double up[3] = {0, 0, 1};
    plm_status status = plm_surfels_make(cloud, resolution, &it->surfels, error);
    return status == PLM_OK ? plm_ground_look(&it->surfels, up, &it->scene, error) : status;
}

/* The points below a height (z, origin not added) and within reach of a place, with their own, finer patches. */
static plm_status look_at_part(const plm_cloud *cloud, const double box[3][2], look *it, plm_error *error)
{
    uint32_t *row = plm_alloc(cloud->count, sizeof *row, error);
    if (!row) return PLM_E_MEMORY;
    size_t count = 0;
    for (size_t i = 0; i < cloud->count; i++) {
        bool inside = true;
        for (int a = 0; a < 3; a++)
            inside = inside && cloud->xyz[i][a] >= box[a][0] && (double)cloud->xyz[i][a] <= box[a][1];
        if (inside) row[count++] = (uint32_t)i;
    }
    plm_status status = PLM_OK;
    if (count >= fewest) status = plm_cloud_select(cloud, row, count, &it->part, error);
    plm_free(row);
    if (status == PLM_OK && count >= fewest) status = look_at(&it->part, fine, it, error);
    return status;
}

/* Replaces the best look by a better one, or drops the new one. */
static void keep_better(look *best, look *it, bool better)
{
    look *dropped = better ? best : it;
    look kept = better ? *it : *best;
    look_free(dropped);
    *best = kept;
    best->scene.stand.surfels = &best->surfels;
}

/* Looks at the whole cloud in fine and in coarse patches (thick noise makes two surfaces of one in fine ones), then, for
 * pots that are small beside the plant, at its lower parts. */
static plm_status look_around(const plm_cloud *cloud, look *best, plm_error *error)
{
    *best = (look){.scene = {.soil = -1, .table = -1}};
    plm_status status = look_at(cloud, fine, best, error);
    if (status == PLM_OK && best->scene.confidence == 0) {
        look it = {.scene = {.soil = -1, .table = -1}};
        status = look_at(cloud, coarse, &it, error);
        keep_better(best, &it, status == PLM_OK && it.scene.confidence > 0);
    }
    const plm_surfels *s = &best->surfels;
    double box[3][2];
    for (int a = 0; a < 3 && status == PLM_OK; a++) box[a][0] = -INFINITY, box[a][1] = INFINITY;
    for (size_t part = 0; part < PARTS && status == PLM_OK && best->scene.confidence == 0; part++) {
        look it = {.scene = {.soil = -1, .table = -1}};
        box[2][1] = s->low[2] + lower_part[part] * s->size[2] * s->cell;
        status = look_at_part(cloud, (const double(*)[2])box, &it, error);
        keep_better(best, &it, status == PLM_OK && it.scene.has_pot);
    }
    return status;
}

static plm_status find_automatically(const plm_cloud *cloud, uint8_t *label, plm_ground *ground, plm_error *error)
{
    look best;
    plm_ground_marks marks;
    bool *is_ground = NULL;
    plm_status status = look_around(cloud, &best, error);
    if (status == PLM_OK && best.scene.confidence > 0) {
        is_ground = plm_alloc(cloud->count, sizeof *is_ground, error);
        status = is_ground ? plm_ground_mark(cloud, &best.scene, is_ground, &marks, error) : PLM_E_MEMORY;
        if (status == PLM_OK) {
            report(cloud, &best.scene, &marks, ground);
            for (size_t i = 0; i < cloud->count; i++)
                if (is_ground[i]) label[i] = PLM_LABEL_GROUND;
        }
    } else if (status == PLM_OK) {
        *ground = (plm_ground){0};
    }
    plm_free(is_ground);
    look_free(&best);
    return status;
}

plm_status plm_find_ground(const plm_cloud *cloud, plm_ground_mode mode, double height, uint8_t *label,
                           plm_ground *ground, plm_error *error)
{
    if (mode == PLM_GROUND_HEIGHT) {
        if (!isfinite(height)) return plm_fail(error, PLM_E_ARGUMENT, "the ground's height is not a number");
        for (size_t i = 0; i < cloud->count; i++)
            if (cloud->origin[2] + (double)cloud->xyz[i][2] < height) label[i] = PLM_LABEL_GROUND;
        *ground = (plm_ground){.found = true, .soil_height = height};
        return PLM_OK;
    }
    if (mode == PLM_GROUND_NONE || cloud->count == 0) {
        *ground = (plm_ground){0};
        return PLM_OK;
    }
    if (mode != PLM_GROUND_AUTO) return plm_fail(error, PLM_E_ARGUMENT, "unknown ground mode %d", (int)mode);
    return find_automatically(cloud, label, ground, error);
}
