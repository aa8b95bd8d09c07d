/* simulate/stage.c: the plant with pot, soil and table about it, ready for rays. */
#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "cloud/random.h"
#include "simulate/scan.h"

/* ---- Pot, soil and table ---------------------------------------------------------------------------------------- */

/* Profile (radius, z) of what turns about the pot's axis: table disc, pot wall, rim, soil. */
typedef struct profile {
    int count;
    double at[40][2];
} profile;

static void piece(profile *line, double radius, double z)
{
    line->at[line->count][0] = radius;
    line->at[line->count++][1] = z;
}

static void draw_surroundings(const plm_virtual_plant *plant, const plm_scan_options *options, plm_surroundings *place)
{
    const uint64_t key = plm_key(options->seed, 7);
    const double spread = fmax(plant->whole.width, 0.02), height = fmax(plant->whole.height, 0.02);
    const double lowest = plant->stem_count ? 0 : fmin(plant->whole.lowest, 0);
    *place = (plm_surroundings){.has_pot = options->has_pot, .has_table = options->has_table};
    place->radius = fmin(fmax((0.16 * height + 0.12 * spread) * (0.85 + 0.4 * plm_uniform_at(key, 0)), 0.025), 0.16);
    place->centre[0] = 0.05 * place->radius * plm_normal_at(key, 1);
    place->centre[1] = 0.05 * place->radius * plm_normal_at(key, 2);
    place->soil = lowest - 0.0001;
    place->rim = place->soil + (plm_uniform_at(key, 20) < 0.3 ? 0 : place->radius * 0.18 * plm_uniform_at(key, 21));
    place->table = place->has_pot ? place->rim - place->radius * (1.5 + 0.4 * plm_uniform_at(key, 22)) : place->soil;
}

/* A surface of revolution, roughened a little. */
static plm_status revolve(const profile *line, const double centre[2], double roughness, uint64_t key, plm_mesh *mesh,
                          plm_error *error)
{
    enum { AROUND = 96 };
    const size_t rings = (size_t)line->count;
    const plm_status status = plm_mesh_create(rings * AROUND, rings ? (rings - 1) * AROUND * 2 : 0, mesh, error);
    if (status != PLM_OK) return status;
    size_t faces = 0;
    for (size_t k = 0; k < rings * AROUND; k++) {
        const double angle = 2 * PLM_PI * (double)(k % AROUND) / AROUND;
        const double *at = line->at[k / AROUND];
        mesh->vertex[k][0] = centre[0] + at[0] * cos(angle);
        mesh->vertex[k][1] = centre[1] + at[0] * sin(angle);
        mesh->vertex[k][2] = at[1] + roughness * plm_normal_at(key, k);
    }
    for (size_t k = 0; k + 1 < rings; k++)
        for (size_t j = 0; j < AROUND; j++) {
            const uint32_t a = (uint32_t)(k * AROUND + j), b = (uint32_t)(k * AROUND + (j + 1) % AROUND);
            memcpy(mesh->triangle[faces++], (uint32_t[3]){a, b, b + AROUND}, sizeof *mesh->triangle);
            memcpy(mesh->triangle[faces++], (uint32_t[3]){a, b + AROUND, a + AROUND}, sizeof *mesh->triangle);
        }
    return PLM_OK;
}

static plm_status make_surroundings(const plm_surroundings *place, uint64_t seed, plm_mesh *mesh, plm_error *error)
{
    profile line = {0};
    *mesh = (plm_mesh){0};
    if (place->has_table) {
        const double far = place->has_pot ? place->radius * 2.2 : fmax(place->radius * 2.5, 0.06);
        for (int k = 0; k <= 6; k++) piece(&line, far * (1 - k / 6.0) + (place->has_pot ? 0.0 : 0), place->table);
    }
    if (place->has_pot) {
        const double foot = 0.75 * place->radius;
        line.count = place->has_table ? line.count - 2 : 0; /* the table's middle is under the pot */
        for (int k = 0; k <= 8; k++)
            piece(&line, foot + (place->radius - foot) * k / 8.0,
                  fmin(place->table + 0.0005, place->rim) + (place->rim - place->table - 0.0005) * k / 8.0);
        piece(&line, 0.93 * place->radius, place->rim);
        for (int k = 0; k <= 8; k++) piece(&line, 0.92 * place->radius * (1 - k / 8.0), place->soil);
    }
    if (!line.count) return PLM_OK;
    return revolve(&line, place->centre, 0.0002, plm_key(seed, 8), mesh, error);
}

/* ---- The stage -------------------------------------------------------------------------------------------------- */

static void bounds(const plm_mesh *mesh, double centre[3], double *radius)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t k = 0; k < mesh->vertex_count; k++)
        for (int i = 0; i < 3; i++) {
            low[i] = fmin(low[i], mesh->vertex[k][i]);
            high[i] = fmax(high[i], mesh->vertex[k][i]);
        }
    *radius = 0;
    for (int i = 0; i < 3; i++) centre[i] = 0.5 * (low[i] + high[i]);
    for (size_t k = 0; k < mesh->vertex_count; k++) {
        const double d[3] = {mesh->vertex[k][0] - centre[0], mesh->vertex[k][1] - centre[1],
                             mesh->vertex[k][2] - centre[2]};
        *radius = fmax(*radius, plm_norm(d));
    }
    *radius *= 1.001;
}

static plm_status join(const plm_mesh *first, const plm_mesh *second, plm_mesh *both, plm_error *error)
{
    const plm_status status = plm_mesh_create(first->vertex_count + second->vertex_count,
                                              first->triangle_count + second->triangle_count, both, error);
    if (status != PLM_OK) return status;
    memcpy(both->vertex, first->vertex, first->vertex_count * sizeof *both->vertex);
    memcpy(both->triangle, first->triangle, first->triangle_count * sizeof *both->triangle);
    for (size_t k = 0; k < second->vertex_count; k++)
        memcpy(both->vertex[first->vertex_count + k], second->vertex[k], sizeof *both->vertex);
    for (size_t k = 0; k < second->triangle_count; k++)
        for (int i = 0; i < 3; i++)
            both->triangle[first->triangle_count + k][i] = second->triangle[k][i] + (uint32_t)first->vertex_count;
    return PLM_OK;
}

plm_status plm_stage_make(const plm_virtual_plant *plant, const plm_scan_options *options, plm_stage_set *stage,
                          plm_error *error)
{
    plm_stage_set made = {.plant = plant, .plant_faces = plant->mesh.triangle_count};
    plm_mesh around = {0};
    draw_surroundings(plant, options, &made.surroundings);
    plm_status status = make_surroundings(&made.surroundings, options->seed, &around, error);
    if (status == PLM_OK) status = join(&plant->mesh, &around, &made.mesh, error);
    if (status == PLM_OK)
        status =
            plm_rays_build((const double(*)[3])made.mesh.vertex, made.mesh.vertex_count,
                           (const uint32_t(*)[3])made.mesh.triangle, 0, made.mesh.triangle_count, &made.rays, error);
    if (status == PLM_OK) {
        bounds(&plant->mesh, made.centre, &made.radius);
        bounds(&made.mesh, made.target, &made.target_radius);
        *stage = made;
    } else {
        plm_stage_free(&made);
    }
    plm_mesh_free(&around);
    return status;
}

void plm_stage_free(plm_stage_set *stage)
{
    plm_mesh_free(&stage->mesh);
    plm_rays_free(stage->rays);
    stage->rays = NULL;
}

/* ---- Faces ------------------------------------------------------------------------------------------------------ */

double plm_face_normal(const plm_mesh *mesh, size_t face, double normal[3])
{
    const double *a = mesh->vertex[mesh->triangle[face][0]], *b = mesh->vertex[mesh->triangle[face][1]],
                 *c = mesh->vertex[mesh->triangle[face][2]];
    const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    plm_cross(u, v, normal);
    return 0.5 * plm_normalise(normal);
}

double plm_plant_area(const plm_virtual_plant *plant)
{
    double area = 0, normal[3];
    for (size_t f = 0; f < plant->mesh.triangle_count; f++) area += plm_face_normal(&plant->mesh, f, normal);
    return area;
}

plm_status plm_face_sampler_make(const plm_mesh *mesh, size_t count, plm_face_sampler *sampler, plm_error *error)
{
    double area = 0, normal[3];
    double *sum = plm_alloc(count, sizeof *sum, error);
    if (!sum) return PLM_E_MEMORY;
    for (size_t f = 0; f < count; f++) sum[f] = area += plm_face_normal(mesh, f, normal);
    *sampler = (plm_face_sampler){mesh, count, sum};
    return PLM_OK;
}

void plm_face_sampler_free(plm_face_sampler *sampler)
{
    plm_free(sampler->sum);
    sampler->sum = NULL;
}

uint32_t plm_face_sampler_draw(const plm_face_sampler *sampler, double pick, double u, double v, double point[3])
{
    const double wanted = pick * sampler->sum[sampler->count - 1];
    size_t low = 0, high = sampler->count - 1;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (sampler->sum[middle] > wanted)
            high = middle;
        else
            low = middle + 1;
    }
    if (u + v > 1) { /* fold the square onto the triangle */
        u = 1 - u;
        v = 1 - v;
    }
    const uint32_t *corner = sampler->mesh->triangle[low];
    for (int i = 0; i < 3; i++)
        point[i] = (1 - u - v) * sampler->mesh->vertex[corner[0]][i] + u * sampler->mesh->vertex[corner[1]][i] +
                   v * sampler->mesh->vertex[corner[2]][i];
    return (uint32_t)low;
}
