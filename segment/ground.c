/* segment/ground.c: ground, pot and table of a cloud whose z is up. What is looked for is in ground_scene.c, how the
 * points are told apart in ground_mark.c. */
#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "segment/ground_mark.h"
#include "segment/segment.h"

static const double resolution = 200; /* voxels along the diagonal of the cloud */

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

static plm_status find_automatically(const plm_cloud *cloud, uint8_t *label, plm_ground *ground, plm_error *error)
{
    static const double up[3] = {0, 0, 1};
    plm_surfels surfels = {0};
    plm_ground_scene scene = {.soil = -1, .table = -1};
    plm_ground_marks marks;
    bool *is_ground = NULL;
    plm_status status = plm_surfels_make(cloud, resolution, &surfels, error);
    if (status == PLM_OK) status = plm_ground_look(&surfels, up, &scene, error);
    if (status == PLM_OK && scene.confidence > 0) {
        is_ground = plm_alloc(cloud->count, sizeof *is_ground, error);
        status = is_ground ? plm_ground_mark(cloud, &scene, is_ground, &marks, error) : PLM_E_MEMORY;
        if (status == PLM_OK) {
            report(cloud, &scene, &marks, ground);
            for (size_t i = 0; i < cloud->count; i++)
                if (is_ground[i]) label[i] = PLM_LABEL_GROUND;
        }
    } else if (status == PLM_OK) {
        *ground = (plm_ground){0};
    }
    plm_free(is_ground);
    plm_ground_scene_free(&scene);
    plm_surfels_free(&surfels);
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
