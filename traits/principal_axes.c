/* traits/principal_axes.c: along which axes the surface of a plant is spread. Points are no measure of area: scans see parts of a plant
 * better than others, and splats are up to thirty times denser on one leaf than on another. */
#include "traits/principal_axes.h"

#include "cloud/linear.h"
#include "cloud/voxel.h"
#include "traits/plant_mesh.h"

#include <math.h>
#include <string.h>

/* Voxels along the plant's longest side for its second moments; fewer where more than a share of them has one point. */
enum { FINEST_VOXELS = 200, COARSEST_VOXELS = 50 };
static const double most_lonely = 0.3;
/* A plane of any direction runs through so many cells for each that its area would fill; and points stand for so many times the area
 * that the usual spacing gives them at most: strays stand for no cell. */
static const double cells_crossed = 1.5, sparsest = 4;
/* A surface that leaves the plant's box by more than this share of its size is a fit gone wild. */
static const double slack = 0.1;
/* Turn of the axes times relative gap of the moments, radians, on 48 clean virtual plants and 180 in noise. */
static const double turn_of_surfaces = 0.006, turn_of_voxels = 0.02;

typedef struct moments {
    double area, first[3], second[6];
} moments;

static void add(moments *sum, double area, const double at[3])
{
    sum->area += area;
    for (int i = 0, k = 0; i < 3; i++) {
        sum->first[i] += area * at[i];
        for (int j = i; j < 3; j++, k++) sum->second[k] += area * at[i] * at[j];
    }
}

/** The plant's box about its middle. */
typedef struct box {
    double middle[3], size; /* size: its longest side */
} box;

/* By quadrature that is exact for second moments: a third of the area at the middle of each edge. */
static void add_triangle(moments *sum, const plm_mesh *mesh, size_t t, const box *plant, bool flat)
{
    double corner[3][3], a[3], b[3], across[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            corner[i][k] = mesh->vertex[mesh->triangle[t][i]][k] - plant->middle[k];
            if (!(fabs(corner[i][k]) < (0.5 + slack) * plant->size)) return;
        }
    for (int k = 0; k < 3; k++) {
        a[k] = corner[1][k] - corner[0][k];
        b[k] = corner[2][k] - corner[0][k];
    }
    plm_cross(a, b, across);
    const double area = 0.5 * plm_norm(across);
    for (int i = 0; i < 3; i++) {
        double middle[3];
        for (int k = 0; k < 3; k++) middle[k] = flat && k == 2 ? 0 : 0.5 * (corner[i][k] + corner[(i + 1) % 3][k]);
        add(sum, area / 3, middle);
    }
}

static plm_status of_surfaces(const plm_scene *scene, const box *plant, bool flat, moments *sum, plm_error *error)
{
    plm_mesh mesh;
    const plm_status status = plm_scene_mesh(scene, false, &mesh, error);
    if (status != PLM_OK) return status;
    for (size_t t = 0; t < mesh.triangle_count; t++) add_triangle(sum, &mesh, t, plant, flat);
    plm_mesh_free(&mesh);
    return PLM_OK;
}

/* The plant's points that no surface and no tube stands for (those of an organ with either are taken to lie on it): the caller's. */
static plm_status gather_rest(const plm_scene *scene, float (**rest)[3], size_t *count, plm_error *error)
{
    bool *stood_for = plm_alloc_zero(scene->cloud->count, sizeof *stood_for, error);
    *rest = stood_for ? plm_alloc(scene->plant_count, sizeof **rest, error) : NULL;
    *count = 0;
    for (size_t k = 0; *rest && k < scene->organ_count; k++)
        for (size_t i = 0; plm_organ_has_mesh(scene, &scene->organ[k]) && i < scene->organ[k].count; i++)
            stood_for[scene->organ[k].row[i]] = true;
    for (size_t i = 0; *rest && i < scene->plant_count; i++)
        if (!stood_for[scene->plant_row[i]]) memcpy((*rest)[(*count)++], scene->plant[i], sizeof **rest);
    plm_free(stood_for);
    return *rest ? PLM_OK : PLM_E_MEMORY;
}

static size_t voxels_of(const plm_voxels *voxels, uint32_t points)
{
    size_t count = 0;
    for (size_t i = 0; i < voxels->count; i++) count += voxels->size[i] == points;
    return count;
}

/* Cells that the surface runs through over those that have a point: the others are told by how many have one or two (A. Chao 1984). */
static double unseen(const plm_voxels *voxels)
{
    const double ones = (double)voxels_of(voxels, 1), twos = (double)voxels_of(voxels, 2);
    return 1 + 0.5 * ones * fmax(ones - 1, 0) / ((twos + 1) * (double)voxels->count);
}

/* Voxels that each count as one piece of area, as small as the sampling allows. usual: spacing of the plant's points, 0: not known. */
static plm_status of_voxels(const float (*xyz)[3], size_t count, double usual, const box *plant, bool flat,
                            moments *sum, plm_error *error)
{
    plm_voxels voxels = {0};
    plm_status status = PLM_OK;
    double cell = plant->size / FINEST_VOXELS;
    for (;; cell /= 0.7) {
        plm_voxels_free(&voxels);
        status = plm_voxel_thin(xyz, count, cell, &voxels, error);
        if (status != PLM_OK || cell > plant->size / COARSEST_VOXELS) break;
        if ((double)voxels_of(&voxels, 1) < most_lonely * (double)voxels.count) break;
    }
    const double piece = status == PLM_OK ? unseen(&voxels) * cell * cell / cells_crossed : 0;
    for (size_t i = 0; status == PLM_OK && i < voxels.count; i++) {
        double at[3], area = piece;
        if (usual > 0) area = fmin(area, sparsest * usual * usual * voxels.size[i]);
        for (int k = 0; k < 3; k++) at[k] = flat && k == 2 ? 0 : voxels.xyz[i][k] - plant->middle[k];
        add(sum, area, at);
    }
    plm_voxels_free(&voxels);
    return status;
}

static box box_of(const plm_scene *scene)
{
    box plant = {.size = 0};
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < scene->plant_count; i++) {
            low = fmin(low, scene->plant[i][k]);
            high = fmax(high, scene->plant[i][k]);
        }
        plant.middle[k] = 0.5 * (low + high);
        plant.size = fmax(plant.size, high - low);
    }
    return plant;
}

plm_status plm_principal_axes(const plm_scene *scene, bool flat, plm_principal *axes, plm_error *error)
{
    const box plant = box_of(scene);
    if (!(plant.size > 0)) return plm_fail(error, PLM_E_DEGENERATE, "all points of the plant are in one place");
    moments sum = {0};
    plm_status status = of_surfaces(scene, &plant, flat, &sum, error);
    if (status != PLM_OK) return status;
    const double by_surfaces = sum.area;
    float(*rest)[3];
    size_t count;
    status = gather_rest(scene, &rest, &count, error);
    if (status == PLM_OK && count)
        status = of_voxels((const float(*)[3])rest, count, scene->sampling.spacing, &plant, flat, &sum, error);
    plm_free(rest);
    if (status != PLM_OK) return status;
    if (!(sum.area > 0)) return plm_fail(error, PLM_E_DEGENERATE, "the plant has no surface that has an area");
    for (int i = 0, k = 0; i < 3; i++)
        for (int j = i; j < 3; j++, k++)
            sum.second[k] = sum.second[k] / sum.area - sum.first[i] / sum.area * sum.first[j] / sum.area;
    if (flat) sum.second[5] = -sum.second[0] - sum.second[3]; /* z comes last, also where rounding leaves less than 0 */
    plm_eigen3(sum.second, axes->value, axes->axis);
    axes->turn = turn_of_voxels - (turn_of_voxels - turn_of_surfaces) * by_surfaces / sum.area;
    return PLM_OK;
}
