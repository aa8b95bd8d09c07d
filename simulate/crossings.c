/* simulate/crossings.c: organs that cut each other. Edges of one organ are cast as segments at the faces of the others.
 */
#include "simulate/crossings.h"
#include "cloud/linear.h"
#include "simulate/build.h"
#include "simulate/rays.h"

/* ---- While growing ---------------------------------------------------------------------------------------------- */

typedef struct growing_cut {
    const plm_built_stem *stem;
    const double *from, *to;
} growing_cut;

/* Distance of a point from a stem's axis, in radii of the stem there. */
static double radii_from_axis(const plm_built_stem *stem, const double point[3])
{
    double nearest = INFINITY;
    for (int k = 0; k <= PLM_CURVE_STEPS; k++) {
        const double *p = stem->axis.point[k];
        const double d[3] = {point[0] - p[0], point[1] - p[1], point[2] - p[2]};
        const double radius = plm_taper_at(&stem->taper, stem->axis.length * k / PLM_CURVE_STEPS, stem->axis.length);
        nearest = fmin(nearest, plm_norm(d) / radius);
    }
    return nearest;
}

/* Organs grow together inside the stem and just outside of it: such cuts do not count. */
static bool cuts_away_from_stem(uint32_t face, double t, void *user)
{
    (void)face;
    const growing_cut *cut = user;
    double point[3];
    for (int i = 0; i < 3; i++) point[i] = cut->from[i] + t * (cut->to[i] - cut->from[i]);
    return radii_from_axis(cut->stem, point) > 1.6;
}

plm_rays *plm_build_rays(plm_builder *builder)
{
    const plm_mesh *mesh = &builder->plant->mesh;
    plm_rays *rays = NULL;
    if (builder->status != PLM_OK || !mesh->triangle_count) return NULL;
    builder->status =
        plm_rays_build((const double(*)[3])mesh->vertex, mesh->vertex_count, (const uint32_t(*)[3])mesh->triangle, 0,
                       mesh->triangle_count, &rays, builder->error);
    return rays;
}

size_t plm_build_crossings(const plm_builder *builder, const plm_rays *earlier, size_t first, int stem)
{
    const plm_mesh *mesh = &builder->plant->mesh;
    size_t crossings = 0;
    if (builder->status != PLM_OK || !earlier) return 0;
#pragma omp parallel for schedule(static) reduction(+ : crossings)
    for (size_t f = first; f < mesh->triangle_count; f++) {
        for (int k = 0; k < 3; k++) {
            const uint32_t a = mesh->triangle[f][k], b = mesh->triangle[f][(k + 1) % 3];
            if (a > b) continue; /* inner edges once */
            growing_cut cut = {&builder->stem[stem], mesh->vertex[a], mesh->vertex[b]};
            crossings += plm_rays_cut(earlier, cut.from, cut.to, cuts_away_from_stem, &cut);
        }
    }
    return crossings;
}

/* ---- Of a grown plant ------------------------------------------------------------------------------------------- */

typedef struct pair_search {
    const plm_virtual_plant *plant;
    uint8_t *crosses; /* leaf_count x leaf_count */
    int32_t leaf;
    const double *from, *to;
} pair_search;

/* Blades that share a node grow together there: cuts within a twentieth of the leaf's length from its junction. */
static bool is_at_junction(const plm_true_leaf *leaf, const double from[3], const double to[3], double t)
{
    double squared = 0;
    for (int i = 0; i < 3; i++) squared += pow(from[i] + t * (to[i] - from[i]) - leaf->base[i], 2);
    return squared < pow(0.05 * leaf->length, 2);
}

static bool note_pair(uint32_t face, double t, void *user)
{
    pair_search *search = user;
    const plm_virtual_plant *plant = search->plant;
    const int32_t other = plant->mesh.face_organ[face];
    if (plant->face_label[face] != PLM_LABEL_LEAF || other == search->leaf) return false;
    if (is_at_junction(&plant->leaf[search->leaf], search->from, search->to, t)) return false;
    if (is_at_junction(&plant->leaf[other], search->from, search->to, t)) return false;
    const size_t low = (size_t)(other < search->leaf ? other : search->leaf);
    const size_t high = (size_t)(other < search->leaf ? search->leaf : other);
    search->crosses[low * plant->leaf_count + high] = 1;
    return false; /* go on: the segment may cut others too */
}

/* Bounding boxes of the leaves, low corner first: most edges are far from every other leaf. */
static void leaf_boxes(const plm_virtual_plant *plant, double (*box)[2][3])
{
    for (size_t k = 0; k < plant->leaf_count; k++)
        for (int i = 0; i < 3; i++) {
            box[k][0][i] = INFINITY;
            box[k][1][i] = -INFINITY;
        }
    for (size_t f = 0; f < plant->mesh.triangle_count; f++) {
        if (plant->face_label[f] != PLM_LABEL_LEAF) continue;
        double(*own)[3] = box[plant->mesh.face_organ[f]];
        for (int k = 0; k < 9; k++) {
            const double at = plant->mesh.vertex[plant->mesh.triangle[f][k / 3]][k % 3];
            own[0][k % 3] = fmin(own[0][k % 3], at);
            own[1][k % 3] = fmax(own[1][k % 3], at);
        }
    }
}

static bool is_near_another(const plm_virtual_plant *plant, const double (*box)[2][3], int32_t leaf, size_t face)
{
    const uint32_t *corner = plant->mesh.triangle[face];
    for (size_t k = 0; k < plant->leaf_count; k++) {
        bool is_apart = (int32_t)k == leaf;
        for (int i = 0; i < 3 && !is_apart; i++) {
            const double a = plant->mesh.vertex[corner[0]][i], b = plant->mesh.vertex[corner[1]][i],
                         c = plant->mesh.vertex[corner[2]][i];
            is_apart = fmin(a, fmin(b, c)) > box[k][1][i] || fmax(a, fmax(b, c)) < box[k][0][i];
        }
        if (!is_apart) return true;
    }
    return false;
}

plm_status plm_leaf_pairs_crossing(const plm_virtual_plant *plant, size_t *pairs, plm_error *error)
{
    const plm_mesh *mesh = &plant->mesh;
    const size_t leaves = plant->leaf_count;
    plm_rays *rays = NULL;
    pair_search search = {.plant = plant, .crosses = plm_alloc_zero(leaves * leaves, 1, error)};
    double(*box)[2][3] = plm_alloc(leaves, sizeof *box, error);
    plm_status status = search.crosses && box ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK)
        status = plm_rays_build((const double(*)[3])mesh->vertex, mesh->vertex_count,
                                (const uint32_t(*)[3])mesh->triangle, 0, mesh->triangle_count, &rays, error);
    if (status == PLM_OK) leaf_boxes(plant, box);
    for (size_t f = 0; status == PLM_OK && f < mesh->triangle_count; f++) {
        search.leaf = mesh->face_organ[f];
        if (plant->face_label[f] != PLM_LABEL_LEAF) continue;
        if (!is_near_another(plant, (const double(*)[2][3])box, search.leaf, f)) continue;
        for (int k = 0; k < 3; k++) {
            search.from = mesh->vertex[mesh->triangle[f][k]];
            search.to = mesh->vertex[mesh->triangle[f][(k + 1) % 3]];
            plm_rays_cut(rays, search.from, search.to, note_pair, &search);
        }
    }
    if (status == PLM_OK) {
        *pairs = 0;
        for (size_t i = 0; i < leaves * leaves; i++) *pairs += search.crosses[i];
    }
    plm_rays_free(rays);
    plm_free(box);
    plm_free(search.crosses);
    return status;
}
