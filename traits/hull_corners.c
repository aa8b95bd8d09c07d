/* traits/hull_corners.c: the hull's volume behind its corners. In first order a hull grows by the area of each face times how far it
 * moves (the surface area measure of H. Minkowski, 1903), which the points about its corners tell. Corners that lie near each other are of
 * one tip or rim, and err alike; others on their own. Condition: the error is that of the gaps behind corners, some 0.3 of them, and in
 * noise a third of that along the surface. */
#include "traits/hull_corners.h"

#include "cloud/linear.h"
#include "traits/sample_end.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    AROUND = 120,      /* points about a corner */
    TELLING = 60,      /* of them, that tell its end along a normal; */
    ONE_TIP = 60,      /* corners within the distance of so many points are of one tip */
    MOST_FACES = 1000, /* that are looked at, the largest */
    NOISY_FACES = 120  /* in noise, where a corner takes longer: on 230 scans 300 tell the same within 0.02 % */
};

/* Of the noise along the surface: ends at a plant's corners, tips more often than edges, come out too low by so much, as a blurred tip
 * looks like an edge with more of it (184 virtual splats of 0.2 to 0.8 mm of noise and 12 to 120 thousand points ask for 0.25 to 0.4,
 * crossed ellipses without tips for none). */
static const double end_lost = 0.25;
/* Noise along the surface per noise across it, of voxel means: what 220 virtual scans by depth cameras ask for (heights ask for 0.7). */
static const double fused_along = 0.8;

typedef struct face {
    double area, normal[3];
    uint32_t number;
} face;

/** A corner's part in what the hull lacks. */
typedef struct corner_gain {
    double gain, error;
} corner_gain;

static int larger_face(const void *a, const void *b)
{
    const face *x = a, *y = b;
    if (x->area != y->area) return x->area > y->area ? -1 : 1;
    return (x->number > y->number) - (x->number < y->number);
}

/* All faces, the largest first. Gives their area. */
static double sort_faces(const plm_mesh *hull, face *of)
{
    double area = 0;
    for (size_t f = 0; f < hull->triangle_count; f++) {
        const uint32_t *t = hull->triangle[f];
        double side[2][3];
        for (int k = 0; k < 3; k++)
            for (int s = 0; s < 2; s++) side[s][k] = hull->vertex[t[s + 1]][k] - hull->vertex[t[0]][k];
        plm_cross(side[0], side[1], of[f].normal);
        of[f].area = 0.5 * plm_normalise(of[f].normal);
        of[f].number = (uint32_t)f;
        area += of[f].area;
    }
    qsort(of, hull->triangle_count, sizeof *of, larger_face);
    return area;
}

static void query_of(const double vertex[3], float query[3])
{
    for (int k = 0; k < 3; k++) query[k] = (float)vertex[k];
}

/** Some faces of a hull, the largest, and what each of their corners tells. */
typedef struct corners {
    const plm_mesh *hull;
    face *of;
    corner_gain (*part)[3];
    size_t faces;
    double whole; /* the hull's area over theirs */
} corners;

static const double *place_of(const corners *c, size_t number, int corner)
{
    return c->hull->vertex[c->hull->triangle[c->of[number].number][corner]];
}

/* How far the surface goes on behind a corner along a normal. */
static corner_gain behind(const double vertex[3], const double normal[3], const plm_index *index, const float (*xyz)[3])
{
    float query[3];
    uint32_t row[AROUND];
    plm_height height[AROUND];
    size_t places = 0;
    query_of(vertex, query);
    const size_t found = plm_index_nearest(index, query, AROUND, row, NULL);
    for (size_t i = 0; i < found;
         i++) { /* points that were written twice are next to each other, and tell nothing more */
        if (i && memcmp(xyz[row[i]], xyz[row[i - 1]], sizeof xyz[row[i]]) == 0) continue;
        double offset[3];
        for (int k = 0; k < 3; k++) offset[k] = (double)xyz[row[i]][k] - vertex[k];
        height[places++] = (plm_height){plm_dot(offset, normal), 0, 0};
    }
    corner_gain gain = {0};
    if (places < 2) return gain;
    plm_end_of_corner(height, places, TELLING, &gain.gain, &gain.error);
    gain.gain = fmax(gain.gain, 0);
    return gain;
}

/* Sums the errors of corners that are of one tip, which are those of the same points, and the squares of the sums. gain: one a
 * vertex, overwritten. */
static double squares_of_tips(const plm_mesh *hull, const plm_index *index, corner_gain *gain)
{
    double squares = 0;
    for (size_t v = 0; v < hull->vertex_count; v++) {
        if (!(gain[v].error > 0)) continue;
        float query[3], squared[ONE_TIP];
        query_of(hull->vertex[v], query);
        const size_t found = plm_index_nearest(index, query, ONE_TIP, NULL, squared);
        const double reach = found ? sqrt((double)squared[found - 1]) : 0;
        double sum = 0;
        for (size_t w = v; w < hull->vertex_count; w++) {
            if (!(gain[w].error > 0)) continue;
            if (w != v && plm_distance(hull->vertex[v], hull->vertex[w]) > reach) continue;
            sum += gain[w].error;
            gain[w].error = 0;
        }
        squares += sum * sum;
    }
    return squares;
}

static void free_corners(corners *c)
{
    plm_free(c->of);
    plm_free(c->part);
}

static plm_status take_corners(const plm_mesh *hull, size_t most, corners *c, plm_error *error)
{
    *c = (corners){.hull = hull, .faces = hull->triangle_count < most ? hull->triangle_count : most};
    c->of = plm_alloc(hull->triangle_count, sizeof *c->of, error);
    c->part = plm_alloc(c->faces, sizeof *c->part, error);
    if (!c->of || !c->part) return PLM_E_MEMORY;
    const double area = sort_faces(hull, c->of);
    double seen = 0;
    for (size_t f = 0; f < c->faces; f++) seen += c->of[f].area;
    c->whole = seen > 0 ? area / seen : 1;
    return PLM_OK;
}

static plm_status sum_up(const corners *c, const plm_index *index, double *lacking, double *std_error, plm_error *error)
{
    corner_gain *gain = plm_alloc_zero(c->hull->vertex_count, sizeof *gain, error);
    if (!gain) return PLM_E_MEMORY;
    *lacking = 0;
    for (size_t f = 0; f < c->faces; f++)
        for (int k = 0; k < 3; k++) {
            *lacking += c->of[f].area / 3 * c->part[f][k].gain;
            gain[c->hull->triangle[c->of[f].number][k]].error += c->of[f].area / 3 * c->part[f][k].error;
        }
    *lacking *= c->whole;
    *std_error = c->whole * sqrt(squares_of_tips(c->hull, index, gain));
    plm_free(gain);
    return PLM_OK;
}

plm_status plm_hull_corners(const plm_mesh *hull, const plm_index *index, const float (*xyz)[3], double *lacking,
                            double *std_error, plm_error *error)
{
    corners c;
    plm_status status = take_corners(hull, MOST_FACES, &c, error);
    if (status == PLM_OK) {
#pragma omp parallel for schedule(dynamic, 16)
        for (size_t f = 0; f < c.faces; f++)
            for (int k = 0; k < 3; k++) c.part[f][k] = behind(place_of(&c, f, k), c.of[f].normal, index, xyz);
        status = sum_up(&c, index, lacking, std_error, error);
    }
    free_corners(&c);
    return status;
}

/* ---- In noise -------------------------------------------------------------------------------------------------- */

/** The points about the corners, each once, as they were projected. */
typedef struct surroundings {
    uint32_t (*near)[AROUND]; /* of each corner: rows, and how many */
    size_t *nears;
    uint32_t *place; /* of each row, among those that are about some corner; NONE */
    uint32_t *row;   /* of these, and how they were projected; on_surface: whether they were */
    plm_projection *onto;
    bool *on_surface;
    size_t rows;
} surroundings;

static const uint32_t NONE = UINT32_MAX;

static void free_surroundings(surroundings *s)
{
    plm_free(s->near);
    plm_free(s->nears);
    plm_free(s->place);
    plm_free(s->row);
    plm_free(s->onto);
    plm_free(s->on_surface);
}

static plm_status find_near(const corners *c, const plm_subset *points, surroundings *s, plm_error *error)
{
    const size_t all = 3 * c->faces;
    s->near = plm_alloc(all, sizeof *s->near, error);
    s->nears = plm_alloc(all, sizeof *s->nears, error);
    s->place = plm_alloc(points->count, sizeof *s->place, error);
    s->row = plm_alloc(all * AROUND, sizeof *s->row, error);
    if (!s->near || !s->nears || !s->place || !s->row) return PLM_E_MEMORY;
    for (size_t i = 0; i < points->count; i++) s->place[i] = NONE;
    for (size_t i = 0; i < all; i++) {
        float query[3];
        query_of(place_of(c, i / 3, (int)(i % 3)), query);
        s->nears[i] = plm_index_nearest(points->index, query, AROUND, s->near[i], NULL);
        for (size_t k = 0; k < s->nears[i]; k++) {
            const uint32_t row = s->near[i][k];
            if (s->place[row] != NONE) continue;
            s->place[row] = (uint32_t)s->rows;
            s->row[s->rows++] = row;
        }
    }
    return PLM_OK;
}

static plm_status project_surroundings(const plm_subset *points, const bool *use, double noise, surroundings *s,
                                       plm_error *error)
{
    s->onto = plm_alloc(s->rows, sizeof *s->onto, error);
    s->on_surface = plm_alloc(s->rows, sizeof *s->on_surface, error);
    if (!s->onto || !s->on_surface) return PLM_E_MEMORY;
#pragma omp parallel for schedule(dynamic, 64)
    for (size_t i = 0; i < s->rows; i++) {
        const uint32_t row = s->row[i];
        s->on_surface[i] = use[points->few_row ? points->few_row[row] : row] &&
                           plm_project_to_surface(points, points->xyz[row], noise, &s->onto[i]);
    }
    return PLM_OK;
}

static double mean_along(const plm_height *height, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += height[i].along;
    return sum / (double)count;
}

/* corner: its number among all that are looked at. */
static corner_gain noisy_behind(const corners *c, size_t corner, const surroundings *s, const plm_subset *points,
                                const plm_blur *blur)
{
    const double *normal = c->of[corner / 3].normal, *vertex = place_of(c, corner / 3, (int)(corner % 3));
    const double at = plm_dot(vertex, normal);
    plm_height height[AROUND];
    size_t places = 0;
    for (size_t i = 0; i < s->nears[corner]; i++) {
        const uint32_t row = s->near[corner][i], place = s->place[row];
        const float(*xyz)[3] = points->xyz;
        const bool again = i && memcmp(xyz[row], xyz[s->near[corner][i - 1]], sizeof xyz[row]) == 0;
        if (again || !s->on_surface[place]) continue;
        plm_projected_height(&s->onto[place], xyz[row], normal, blur, &height[places]);
        height[places++].at -= at;
    }
    corner_gain gain = {0, blur->sampling->noise};
    double depth;
    if (places < 2) return gain;
    plm_end_of_sample(height, places, &gain.gain, &gain.error, &depth);
    gain.gain += end_lost * mean_along(height, places < PLM_END_FEWEST ? places : PLM_END_FEWEST);
    return gain;
}

plm_status plm_hull_noisy_corners(const plm_mesh *hull, const plm_subset *points, const bool *use,
                                  const plm_sampling *sampling, double *lacking, double *std_error, plm_error *error)
{
    corners c;
    surroundings s = {0};
    plm_status status = take_corners(hull, NOISY_FACES, &c, error);
    if (status == PLM_OK) status = find_near(&c, points, &s, error);
    if (status == PLM_OK) status = project_surroundings(points, use, sampling->noise, &s, error);
    if (status == PLM_OK) {
        const plm_blur blur = {sampling, fused_along, false};
#pragma omp parallel for schedule(dynamic, 4)
        for (size_t i = 0; i < 3 * c.faces; i++) c.part[i / 3][i % 3] = noisy_behind(&c, i, &s, points, &blur);
        status = sum_up(&c, points->index, lacking, std_error, error);
    }
    free_surroundings(&s);
    free_corners(&c);
    return status;
}
