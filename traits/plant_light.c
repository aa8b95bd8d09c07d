/* traits/plant_light.c: absorbed light of the measured surfaces: leaves, and stems and petioles as tubes about their fitted lines. The
 * rays are the caller's (plm_measure_options.light): this module knows no ray tracer. */
#include "cloud/linear.h"
#include "traits/axis.h"
#include "traits/families.h"
#include "traits/leaf_surfaces.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { AROUND = 8, MOST_RINGS = 64 };

/* Rings along a tube: about one for each two diameters, more where it is long and thin. 0: no tube. */
static size_t ring_count(const plm_organ *organ)
{
    const plm_axis *axis = organ->axis;
    if (!axis || !(axis->radius > 0) || !(axis->length > 0)) return 0;
    return (size_t)fmin(fmax(axis->length / (4 * axis->radius), 4), MOST_RINGS);
}

/* The corners of a ring. Its sides together are as long as the circle: by Cauchy's formula it then casts the circle's shadow, on the mean. */
static void add_ring(const plm_axis *axis, double t, plm_mesh *mesh)
{
    double centre[3], tangent[3], u[3], v[3];
    const double radius = plm_axis_radius(axis, t) * PLM_PI / (AROUND * sin(PLM_PI / AROUND));
    plm_curve_point(&axis->line, t, centre);
    plm_curve_tangent(&axis->line, t, tangent);
    plm_cross(tangent, axis->line.across[0], v); /* the chord's axes: neighbouring rings do not twist */
    plm_normalise(v);
    plm_cross(v, tangent, u);
    for (int k = 0; k < AROUND; k++) {
        const double angle = 2 * PLM_PI * k / AROUND, x = radius * cos(angle), y = radius * sin(angle);
        for (int i = 0; i < 3; i++) mesh->vertex[mesh->vertex_count][i] = centre[i] + x * u[i] + y * v[i];
        mesh->vertex_count++;
    }
}

static void add_tube(const plm_organ *organ, int32_t group, plm_mesh *mesh, int32_t *face_group)
{
    const plm_axis *axis = organ->axis;
    const size_t rings = ring_count(organ);
    const uint32_t first = (uint32_t)mesh->vertex_count;
    for (size_t r = 0; r < rings; r++)
        add_ring(axis, axis->begin + (axis->end - axis->begin) * (double)r / (double)(rings - 1), mesh);
    for (uint32_t r = 0; r + 1 < rings; r++)
        for (uint32_t k = 0; k < AROUND; k++) {
            const uint32_t a = first + r * AROUND + k, b = first + r * AROUND + (k + 1) % AROUND;
            const uint32_t face[2][3] = {{a, b, b + AROUND}, {a, b + AROUND, a + AROUND}};
            for (int f = 0; f < 2; f++) {
                memcpy(mesh->triangle[mesh->triangle_count], face[f], sizeof face[f]);
                face_group[mesh->triangle_count++] = group;
            }
        }
}

static void add_leaf(const plm_organ *leaf, int32_t group, plm_mesh *mesh, int32_t *face_group)
{
    const plm_mesh *surface = &leaf->surface.mesh;
    const uint32_t first = (uint32_t)mesh->vertex_count;
    for (size_t k = 0; k < surface->vertex_count; k++, mesh->vertex_count++)
        for (int i = 0; i < 3; i++) mesh->vertex[mesh->vertex_count][i] = surface->origin[i] + surface->vertex[k][i];
    for (size_t f = 0; f < surface->triangle_count; f++) {
        for (int i = 0; i < 3; i++) mesh->triangle[mesh->triangle_count][i] = first + surface->triangle[f][i];
        face_group[mesh->triangle_count++] = group;
    }
}

/* All surfaces as one mesh; the group of a face is the number of its organ in the scene. */
static plm_status gather(const plm_scene *scene, plm_mesh *mesh, int32_t **face_group, plm_error *error)
{
    size_t vertices = 0, triangles = 0;
    for (size_t k = 0; k < scene->organ_count; k++) {
        const size_t rings = ring_count(&scene->organ[k]);
        vertices += scene->organ[k].surface.mesh.vertex_count + rings * AROUND;
        triangles += scene->organ[k].surface.mesh.triangle_count + (rings ? 2 * AROUND * (rings - 1) : 0);
    }
    if (vertices > UINT32_MAX)
        return plm_fail(error, PLM_E_LIBRARY, "%zu vertices; one mesh holds %u", vertices, UINT32_MAX);
    plm_status status = plm_mesh_create(vertices, triangles, mesh, error);
    if (status != PLM_OK) return status;
    *face_group = plm_alloc(triangles, sizeof **face_group, error);
    if (!*face_group) {
        plm_mesh_free(mesh);
        return PLM_E_MEMORY;
    }
    mesh->vertex_count = mesh->triangle_count = 0;
    for (size_t k = 0; k < scene->organ_count; k++) {
        add_leaf(&scene->organ[k], (int32_t)k, mesh, *face_group);
        add_tube(&scene->organ[k], (int32_t)k, mesh, *face_group);
    }
    return PLM_OK;
}

plm_status plm_scene_light(plm_scene *scene, plm_error *error)
{
    plm_mesh mesh;
    int32_t *face_group = NULL;
    if (!scene->options->light) {
        snprintf(scene->light_reason, sizeof scene->light_reason,
                 "no ray tracer was given (plm_measure_options.light)");
        return PLM_OK;
    }
    plm_status status = gather(scene, &mesh, &face_group, error);
    if (status != PLM_OK) return status;
    double *power = plm_alloc(scene->organ_count, sizeof *power, error);
    double *std_error = plm_alloc(scene->organ_count, sizeof *std_error, error);
    if (!power || !std_error)
        status = PLM_E_MEMORY;
    else if (mesh.triangle_count == 0)
        snprintf(scene->light_reason, sizeof scene->light_reason, "no organ has a surface");
    else
        status = scene->options->light(&mesh, face_group, scene->organ_count, scene->options->seed, power, std_error,
                                       &scene->absorbed, &scene->absorbed_error, error);
    for (size_t k = 0; status == PLM_OK && mesh.triangle_count && k < scene->organ_count; k++) {
        scene->organ[k].absorbed = power[k];
        scene->organ[k].absorbed_error = std_error[k];
    }
    plm_free(power);
    plm_free(std_error);
    plm_free(face_group);
    plm_mesh_free(&mesh);
    return status;
}

static const char *const method = "rays through leaf surfaces and tubes";

/* An area that is wrong by a share makes the light wrong by about that share. */
static double with_area_error(double power, double ray_error, double area, double area_error)
{
    return area > 0 ? hypot(ray_error, power * area_error / area) : ray_error;
}

plm_status plm_trait_absorbed_radiation(const plm_scene *scene, const plm_organ *organ, plm_estimate *out,
                                        plm_error *error)
{
    if (scene->light_reason[0]) return plm_not_applicable(out, "%s", scene->light_reason);
    plm_estimate area = {.value = 0};
    const plm_status status = plm_trait_total_leaf_area(scene, organ, &area, error);
    if (status != PLM_OK) return status;
    const bool has_area = area.state == PLM_STATE_OK;
    out->value = scene->absorbed;
    out->std_error = has_area ? with_area_error(scene->absorbed, scene->absorbed_error, area.value, area.std_error)
                              : scene->absorbed_error;
    out->flags |= area.flags;
    out->method = method;
    return PLM_OK;
}

plm_status plm_trait_leaf_absorbed_radiation(const plm_scene *scene, const plm_organ *leaf, plm_estimate *out,
                                             plm_error *error)
{
    (void)error;
    if (!plm_leaf_has_surface(leaf, out)) return PLM_OK;
    if (scene->light_reason[0]) return plm_not_applicable(out, "%s", scene->light_reason);
    out->value = leaf->absorbed;
    out->std_error =
        with_area_error(leaf->absorbed, leaf->absorbed_error, leaf->surface.area, leaf->surface.area_std_error);
    out->method = method;
    return PLM_OK;
}
