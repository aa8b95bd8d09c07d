/* traits/plant_mesh.c: leaf surfaces and tubes gathered into one mesh, for what is told by all of the plant's surface at once: light
 * that is absorbed, the shadow from above; and leaf surfaces alone, as they are written. */
#include "traits/plant_mesh.h"

#include "cloud/linear.h"
#include "traits/axis.h"

#include <math.h>
#include <string.h>

enum { AROUND = 8, MOST_RINGS = 64 };
/* Of the plant's noise, and a spacing: points farther off a tube than that are none of it. */
static const double OFF = 2;

/* Rings along a tube: about one for each two diameters, more where it is long and thin. 0: no tube, or one that the points do not lie
 * on (they are of several strands, or of a blade). */
static size_t ring_count(const plm_scene *scene, const plm_organ *organ)
{
    const plm_axis *axis = organ->axis;
    if (!axis || !(axis->radius > 0) || !(axis->length > 0)) return 0;
    if (axis->noise > OFF * scene->sampling.noise + scene->sampling.spacing) return 0;
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

static void add_face(plm_mesh *mesh, const uint32_t corner[3], int32_t number)
{
    memcpy(mesh->triangle[mesh->triangle_count], corner, 3 * sizeof *corner);
    mesh->face_organ[mesh->triangle_count++] = number;
}

static void add_tube(const plm_scene *scene, const plm_organ *organ, bool closed, int32_t number, plm_mesh *mesh)
{
    const plm_axis *axis = organ->axis;
    const size_t rings = ring_count(scene, organ);
    const uint32_t first = (uint32_t)mesh->vertex_count;
    for (size_t r = 0; r < rings; r++)
        add_ring(axis, axis->begin + (axis->end - axis->begin) * (double)r / (double)(rings - 1), mesh);
    for (uint32_t r = 0; r + 1 < rings; r++)
        for (uint32_t k = 0; k < AROUND; k++) {
            const uint32_t a = first + r * AROUND + k, b = first + r * AROUND + (k + 1) % AROUND;
            add_face(mesh, (uint32_t[3]){a, b, b + AROUND}, number);
            add_face(mesh, (uint32_t[3]){a, b + AROUND, a + AROUND}, number);
        }
    for (uint32_t k = 1; closed && rings && k + 1 < AROUND; k++) {
        const uint32_t last = first + (uint32_t)(rings - 1) * AROUND;
        add_face(mesh, (uint32_t[3]){first, first + k + 1, first + k}, number);
        add_face(mesh, (uint32_t[3]){last, last + k, last + k + 1}, number);
    }
}

static void add_leaf(const plm_organ *leaf, int32_t number, plm_mesh *mesh)
{
    const plm_mesh *surface = &leaf->surface.mesh;
    const uint32_t first = (uint32_t)mesh->vertex_count;
    for (size_t k = 0; k < surface->vertex_count; k++, mesh->vertex_count++)
        for (int i = 0; i < 3; i++) mesh->vertex[mesh->vertex_count][i] = surface->origin[i] + surface->vertex[k][i];
    for (size_t f = 0; f < surface->triangle_count; f++) {
        const uint32_t *t = surface->triangle[f];
        add_face(mesh, (uint32_t[3]){first + t[0], first + t[1], first + t[2]}, number);
    }
}

bool plm_organ_has_mesh(const plm_scene *scene, const plm_organ *organ)
{
    return organ->surface.mesh.triangle_count || ring_count(scene, organ);
}

/* An empty mesh with room for the surfaces of all leaves and so many more vertices and faces. */
static plm_status make_room(const plm_scene *scene, size_t vertices, size_t triangles, plm_mesh *mesh, plm_error *error)
{
    for (size_t k = 0; k < scene->organ_count; k++) {
        vertices += scene->organ[k].surface.mesh.vertex_count;
        triangles += scene->organ[k].surface.mesh.triangle_count;
    }
    if (vertices > UINT32_MAX)
        return plm_fail(error, PLM_E_LIBRARY, "%zu vertices; one mesh holds %u", vertices, UINT32_MAX);
    const plm_status status = plm_mesh_create(vertices, triangles, mesh, error);
    if (status != PLM_OK) return status;
    mesh->face_organ = plm_alloc(triangles, sizeof *mesh->face_organ, error);
    if (!mesh->face_organ) {
        plm_mesh_free(mesh);
        return PLM_E_MEMORY;
    }
    mesh->vertex_count = mesh->triangle_count = 0;
    return PLM_OK;
}

plm_status plm_scene_mesh(const plm_scene *scene, bool closed, plm_mesh *mesh, plm_error *error)
{
    size_t vertices = 0, triangles = 0;
    for (size_t k = 0; k < scene->organ_count; k++) {
        const size_t rings = ring_count(scene, &scene->organ[k]);
        vertices += rings * AROUND;
        if (rings) triangles += 2 * AROUND * (rings - 1) + (closed ? 2 * (AROUND - 2) : 0);
    }
    const plm_status status = make_room(scene, vertices, triangles, mesh, error);
    for (size_t k = 0; status == PLM_OK && k < scene->organ_count; k++) {
        add_leaf(&scene->organ[k], (int32_t)k, mesh);
        add_tube(scene, &scene->organ[k], closed, (int32_t)k, mesh);
    }
    return status;
}

plm_status plm_scene_leaf_mesh(const plm_scene *scene, plm_mesh *mesh, plm_error *error)
{
    plm_mesh made;
    const plm_status status = make_room(scene, 0, 0, &made, error);
    if (status != PLM_OK) return status;
    memcpy(made.origin, scene->cloud->origin, sizeof made.origin);
    for (size_t k = 0; k < scene->organ_count; k++) add_leaf(&scene->organ[k], scene->organ[k].id, &made);
    *mesh = made;
    return PLM_OK;
}
