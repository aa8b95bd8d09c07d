/* reports/view_file.c: a measured plant thinned and quantised for the page's 3D view. */
#include "reports/view_file.h"

#include "cloud/subset.h"
#include "reports/base64.h"
#include "reports/picture_view.h"
#include "reports/run_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 65535, MOST_POINTS = 200000, MOST_TRIANGLES = 20000, MOST_ORGANS = 65000 };

/** Class and number of what a point or triangle belongs to. */
typedef struct organ_key {
    int label, number;
} organ_key;

/** The view under way. Coordinates are offsets from the cloud's origin. */
typedef struct view_draft {
    const plm_measurement *measurement;
    uint32_t *row; /* the points that are shown */
    size_t point_count;
    plm_mesh leaves;
    double low[3], step;
    organ_key *organ; /* sorted */
    size_t organ_count;
} view_draft;

/* ---- What is there ----------------------------------------------------------------------------------------------- */

static organ_key key_of(const plm_cloud *cloud, size_t i)
{
    const int label = cloud->label && cloud->label[i] < PLM_LABEL_COUNT ? cloud->label[i] : PLM_LABEL_OTHER;
    const bool is_organ = label >= PLM_LABEL_STEM && label <= PLM_LABEL_LEAF && cloud->organ && cloud->organ[i] >= 0;
    return (organ_key){label, is_organ ? cloud->organ[i] : -1};
}

static int compare_keys(const void *a, const void *b)
{
    const organ_key *x = a, *y = b;
    const int order = (x->label > y->label) - (x->label < y->label);
    return order ? order : (x->number > y->number) - (x->number < y->number);
}

static uint16_t place_of(const view_draft *draft, organ_key key)
{
    const organ_key *found = bsearch(&key, draft->organ, draft->organ_count, sizeof key, compare_keys);
    return found ? (uint16_t)(found - draft->organ) : 0;
}

/* Every class and number that points and triangles have, each once. */
static plm_status list_organs(view_draft *draft, plm_error *error)
{
    const plm_mesh *leaves = &draft->leaves;
    draft->organ = plm_alloc(draft->point_count + leaves->triangle_count + 1, sizeof *draft->organ, error);
    if (!draft->organ) return PLM_E_MEMORY;
    size_t count = 0;
    for (size_t i = 0; i < draft->point_count; i++)
        draft->organ[count++] = key_of(&draft->measurement->cloud, draft->row[i]);
    for (size_t i = 0; leaves->face_organ && i < leaves->triangle_count; i++)
        draft->organ[count++] = (organ_key){PLM_LABEL_LEAF, leaves->face_organ[i]};
    qsort(draft->organ, count, sizeof *draft->organ, compare_keys);
    for (size_t i = 0; i < count; i++)
        if (i == 0 || compare_keys(&draft->organ[draft->organ_count - 1], &draft->organ[i]))
            draft->organ[draft->organ_count++] = draft->organ[i];
    if (draft->organ_count > MOST_ORGANS) draft->organ_count = MOST_ORGANS;
    return PLM_OK;
}

static plm_status thin(view_draft *draft, size_t most, plm_error *error)
{
    const plm_cloud *cloud = &draft->measurement->cloud;
    draft->row = plm_alloc(cloud->count, sizeof *draft->row, error);
    if (!draft->row) return PLM_E_MEMORY;
    /* The hash takes about as many as are wanted: ask for a little less, and cut what is over. */
    const size_t wanted = cloud->count > most ? most - most / 50 : most;
    draft->point_count = plm_sample_rows((const float(*)[3])cloud->xyz, cloud->count, wanted, draft->row);
    if (draft->point_count > most) draft->point_count = most;
    return PLM_OK;
}

/* ---- The bounding cube ------------------------------------------------------------------------------------------- */

static void stretch(double low[3], double high[3], const double point[3])
{
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = fmin(low[axis], point[axis]);
        high[axis] = fmax(high[axis], point[axis]);
    }
}

static void mesh_vertex(const view_draft *draft, const plm_mesh *mesh, size_t i, double point[3])
{
    for (int axis = 0; axis < 3; axis++)
        point[axis] = mesh->vertex[i][axis] + mesh->origin[axis] - draft->measurement->cloud.origin[axis];
}

static void find_cube(view_draft *draft)
{
    const plm_measurement *m = draft->measurement;
    double high[3] = {-INFINITY, -INFINITY, -INFINITY}, point[3], size = 0;
    for (int axis = 0; axis < 3; axis++) draft->low[axis] = INFINITY;
    for (size_t i = 0; i < draft->point_count; i++) {
        for (int axis = 0; axis < 3; axis++) point[axis] = m->cloud.xyz[draft->row[i]][axis];
        stretch(draft->low, high, point);
    }
    const plm_mesh *const meshes[] = {&draft->leaves, &m->hull};
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < meshes[k]->vertex_count; i++) {
            mesh_vertex(draft, meshes[k], i, point);
            stretch(draft->low, high, point);
        }
    for (int axis = 0; axis < 3; axis++) {
        size = fmax(size, high[axis] - draft->low[axis]);
        if (!isfinite(draft->low[axis])) draft->low[axis] = 0;
    }
    draft->step = size > 0 ? size / STEPS : 1;
}

static void put_number(unsigned char *to, uint16_t number)
{
    to[0] = (unsigned char)(number & 255);
    to[1] = (unsigned char)(number >> 8);
}

static void put_point(const view_draft *draft, const double point[3], unsigned char *to)
{
    for (int axis = 0; axis < 3; axis++) {
        const double steps = (point[axis] - draft->low[axis]) / draft->step + 0.5;
        put_number(to + 2 * axis, (uint16_t)fmax(0, fmin(STEPS, steps)));
    }
}

/* ---- JSON ---------------------------------------------------------------------------------------------------------- */

/* Bytes as a base64 string of JSON; they are freed. */
static json_t *packed(unsigned char *bytes, size_t size)
{
    char *text = bytes ? plm_base64(bytes, size, NULL) : NULL;
    json_t *made = text ? json_string_nocheck(text) : NULL;
    plm_free(text);
    plm_free(bytes);
    return made;
}

static json_t *points_json(const view_draft *draft)
{
    const plm_cloud *cloud = &draft->measurement->cloud;
    unsigned char *xyz = plm_alloc(draft->point_count, 6, NULL), *organ = plm_alloc(draft->point_count, 2, NULL);
    for (size_t i = 0; xyz && organ && i < draft->point_count; i++) {
        const float *at = cloud->xyz[draft->row[i]];
        put_point(draft, (const double[3]){at[0], at[1], at[2]}, xyz + 6 * i);
        put_number(organ + 2 * i, place_of(draft, key_of(cloud, draft->row[i])));
    }
    return json_pack("{s:I,s:I,s:o,s:o}", "count", (json_int_t)draft->point_count, "of", (json_int_t)cloud->count,
                     "xyz", packed(xyz, 6 * draft->point_count), "organ", packed(organ, 2 * draft->point_count));
}

/* A mesh of at most 65536 vertices; organ: NULL, or the triangles' organs. */
static json_t *mesh_json(const view_draft *draft, const plm_mesh *mesh)
{
    if (!mesh->triangle_count || mesh->vertex_count > STEPS + 1) return json_null();
    unsigned char *xyz = plm_alloc(mesh->vertex_count, 6, NULL), *corner = plm_alloc(mesh->triangle_count, 6, NULL);
    unsigned char *organ = plm_alloc(mesh->triangle_count, 2, NULL);
    for (size_t i = 0; xyz && i < mesh->vertex_count; i++) {
        double point[3];
        mesh_vertex(draft, mesh, i, point);
        put_point(draft, point, xyz + 6 * i);
    }
    for (size_t i = 0; corner && organ && i < mesh->triangle_count; i++) {
        for (int k = 0; k < 3; k++) put_number(corner + 6 * i + 2 * k, (uint16_t)mesh->triangle[i][k]);
        const organ_key leaf = {PLM_LABEL_LEAF, mesh->face_organ ? mesh->face_organ[i] : -1};
        put_number(organ + 2 * i, place_of(draft, leaf));
    }
    return json_pack("{s:I,s:I,s:o,s:o,s:o}", "vertices", (json_int_t)mesh->vertex_count, "triangles",
                     (json_int_t)mesh->triangle_count, "xyz", packed(xyz, 6 * mesh->vertex_count), "corner",
                     packed(corner, 6 * mesh->triangle_count), "organ", packed(organ, 2 * mesh->triangle_count));
}

static json_t *organs_json(const view_draft *draft)
{
    json_t *organs = json_array();
    for (size_t i = 0; organs && i < draft->organ_count; i++) {
        const plm_label label = (plm_label)draft->organ[i].label;
        const plm_rgb colour = plm_organ_colour(label, draft->organ[i].number);
        char hex[8];
        snprintf(hex, sizeof hex, "#%02x%02x%02x", colour.r, colour.g, colour.b);
        json_t *organ = json_pack("{s:s,s:i,s:s}", "organ", plm_label_name(label), "organ_id", draft->organ[i].number,
                                  "colour", hex);
        if (json_array_append_new(organs, organ) != 0) {
            json_decref(organs);
            return NULL;
        }
    }
    return organs;
}

static plm_status write_draft(const view_draft *draft, const char *path, const char *plant_id, plm_error *error)
{
    plm_json_use_seam();
    json_t *root = json_pack("{s:s,s:o,s:[f,f,f],s:f,s:o,s:o,s:o,s:o}", "format", "plantimeter-view-1", "plant_id",
                             plm_json_text(plant_id), "low", draft->low[0], draft->low[1], draft->low[2], "step",
                             draft->step, "organs", organs_json(draft), "points", points_json(draft), "leaves",
                             mesh_json(draft, &draft->leaves), "hull", mesh_json(draft, &draft->measurement->hull));
    const plm_status status = plm_json_write(path, root, PLM_JSON_DIGITS, error);
    json_decref(root);
    return status;
}

plm_status plm_write_view(const char *path, const char *plant_id, const plm_measurement *measurement,
                          const plm_view_limits *limits, plm_error *error)
{
    view_draft draft = {.measurement = measurement};
    const size_t triangles = limits && limits->triangles ? limits->triangles : MOST_TRIANGLES;
    plm_status status = thin(&draft, limits && limits->points ? limits->points : MOST_POINTS, error);
    if (status == PLM_OK && measurement->leaves.triangle_count)
        status = plm_mesh_decimate(&measurement->leaves, triangles, &draft.leaves, error);
    if (status == PLM_OK) status = list_organs(&draft, error);
    if (status == PLM_OK) {
        find_cube(&draft);
        status = write_draft(&draft, path, plant_id, error);
    }
    plm_free(draft.organ);
    plm_free(draft.row);
    plm_mesh_free(&draft.leaves);
    return status;
}
