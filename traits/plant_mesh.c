/* traits/plant_mesh.c: leaf surfaces and tubes gathered into one mesh, for what is told by all of the plant's surface at once: light
 * that is absorbed, the shadow from above. */
#include "traits/plant_mesh.h"

#include "cloud/linear.h"
#include "traits/axis.h"

#include <math.h>
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

static void add_face(plm_mesh *mesh, const uint32_t corner[3], int32_t number, int32_t *face_organ)
{
    memcpy(mesh->triangle[mesh->triangle_count], corner, 3 * sizeof *corner);
    face_organ[mesh->triangle_count++] = number;
}

static void add_tube(const plm_organ *organ, bool closed, int32_t number, plm_mesh *mesh, int32_t *face_organ)
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
            for (int f = 0; f < 2; f++) add_face(mesh, face[f], number, face_organ);
        }
    for (uint32_t k = 1; closed && rings && k + 1 < AROUND; k++) {
        const uint32_t last = first + (uint32_t)(rings - 1) * AROUND;
        add_face(mesh, (uint32_t[3]){first, first + k + 1, first + k}, number, face_organ);
        add_face(mesh, (uint32_t[3]){last, last + k, last + k + 1}, number, face_organ);
    }
}

static void add_leaf(const plm_organ *leaf, int32_t number, plm_mesh *mesh, int32_t *face_organ)
{
    const plm_mesh *surface = &leaf->surface.mesh;
    const uint32_t first = (uint32_t)mesh->vertex_count;
    for (size_t k = 0; k < surface->vertex_count; k++, mesh->vertex_count++)
        for (int i = 0; i < 3; i++) mesh->vertex[mesh->vertex_count][i] = surface->origin[i] + surface->vertex[k][i];
    for (size_t f = 0; f < surface->triangle_count; f++) {
        const uint32_t *t = surface->triangle[f];
        add_face(mesh, (uint32_t[3]){first + t[0], first + t[1], first + t[2]}, number, face_organ);
    }
}

bool plm_organ_has_mesh(const plm_organ *organ)
{
    return organ->surface.mesh.triangle_count || ring_count(organ);
}

plm_status plm_scene_mesh(const plm_scene *scene, bool closed, plm_mesh *mesh, int32_t **face_organ, plm_error *error)
{
    size_t vertices = 0, triangles = 0;
    for (size_t k = 0; k < scene->organ_count; k++) {
        const size_t rings = ring_count(&scene->organ[k]);
        vertices += scene->organ[k].surface.mesh.vertex_count + rings * AROUND;
        triangles += scene->organ[k].surface.mesh.triangle_count +
                     (rings ? 2 * AROUND * (rings - 1) + (closed ? 2 * (AROUND - 2) : 0) : 0);
    }
    if (vertices > UINT32_MAX)
        return plm_fail(error, PLM_E_LIBRARY, "%zu vertices; one mesh holds %u", vertices, UINT32_MAX);
    plm_status status = plm_mesh_create(vertices, triangles, mesh, error);
    if (status != PLM_OK) return status;
    *face_organ = plm_alloc(triangles, sizeof **face_organ, error);
    if (!*face_organ) {
        plm_mesh_free(mesh);
        return PLM_E_MEMORY;
    }
    mesh->vertex_count = mesh->triangle_count = 0;
    for (size_t k = 0; k < scene->organ_count; k++) {
        add_leaf(&scene->organ[k], (int32_t)k, mesh, *face_organ);
        add_tube(&scene->organ[k], closed, (int32_t)k, mesh, *face_organ);
    }
    return PLM_OK;
}
