/* simulate/light_files.c: absorbed light by organ, and as a mesh to look at. */
#include <math.h>
#include <stdlib.h>

#include "cloud/linear.h"
#include "io/io.h"
#include "simulate/packed.h"
#include "simulate/scan.h"
#include "simulate/simulate.h"

/** A face and the place of its organ in the order of the groups. */
typedef struct ranked_face {
    int rank, label;
    int32_t organ;
    uint32_t face;
} ranked_face;

static int by_organ(const void *a, const void *b)
{
    const ranked_face *p = a, *q = b;
    if (p->rank != q->rank) return p->rank < q->rank ? -1 : 1;
    if (p->organ != q->organ) return p->organ < q->organ ? -1 : 1;
    return (p->face > q->face) - (p->face < q->face);
}

/* Stems, petioles, leaves, and then what is none of them. */
static int rank_of(int label)
{
    return label == PLM_LABEL_STEM ? 0 : label == PLM_LABEL_PETIOLE ? 1 : label == PLM_LABEL_LEAF ? 2 : 3 + label;
}

plm_status plm_light_groups(const plm_mesh *mesh, const uint8_t *face_label, int32_t *face_group,
                            plm_light_group **group, size_t *count, plm_error *error)
{
    *count = 0;
    *group = NULL;
    for (size_t f = 0; f < mesh->triangle_count; f++) face_group[f] = -1;
    if (!face_label && !mesh->face_organ) return PLM_OK;
    ranked_face *order = plm_alloc(mesh->triangle_count, sizeof *order, error);
    plm_light_group *made = plm_alloc(mesh->triangle_count, sizeof *made, error);
    if (!order || !made) {
        plm_free(order);
        plm_free(made);
        return PLM_E_MEMORY;
    }
    for (size_t f = 0; f < mesh->triangle_count; f++) {
        const int label = face_label ? face_label[f] : -1;
        order[f] = (ranked_face){rank_of(label), label, mesh->face_organ ? mesh->face_organ[f] : -1, (uint32_t)f};
    }
    qsort(order, mesh->triangle_count, sizeof *order, by_organ);
    for (size_t k = 0; k < mesh->triangle_count; k++) {
        const ranked_face *face = &order[k];
        double normal[3];
        if (k == 0 || face->rank != order[k - 1].rank || face->organ != order[k - 1].organ)
            made[(*count)++] = (plm_light_group){.label = face->label, .organ = face->organ};
        made[*count - 1].area += plm_face_normal(mesh, face->face, normal);
        made[*count - 1].face_count++;
        face_group[face->face] = (int32_t)(*count - 1);
    }
    plm_free(order);
    *group = made;
    return PLM_OK;
}

/* Dark blue, green, yellow, white: darker is less, also in grey. */
static void shade(double share, uint8_t rgb[3])
{
    static const double stop[5][3] = {{20, 20, 60}, {25, 80, 120}, {60, 150, 80}, {230, 210, 60}, {255, 255, 240}};
    const double at = 4 * fmin(fmax(share, 0), 1);
    const int k = (int)fmin(at, 3);
    for (int i = 0; i < 3; i++) rgb[i] = (uint8_t)(stop[k][i] + (at - k) * (stop[k + 1][i] - stop[k][i]) + 0.5);
}

static plm_status write_header(plm_output *output, const plm_mesh *mesh, bool is_labelled, plm_error *error)
{
    return plm_output_print(
        output, error,
        "ply\nformat binary_%s_endian 1.0\n"
        "comment absorbed_w is the power that the face absorbs, absorbed_w_m2 that over its area\n"
        "element vertex %zu\nproperty double x\nproperty double y\nproperty double z\n"
        "element face %zu\nproperty list uchar uint vertex_indices\nproperty float absorbed_w\n"
        "property float absorbed_w_m2\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
        "%s%send_header\n",
        plm_byte_order(), mesh->vertex_count, mesh->triangle_count, is_labelled ? "property uchar label\n" : "",
        mesh->face_organ ? "property int organ\n" : "");
}

/* Power over area of each face; gives the largest mean over the faces that is worth showing: three times the mean. */
static double densities(const plm_mesh *mesh, const plm_light *light, double *density)
{
    double area_sum = 0, power_sum = 0;
    for (size_t f = 0; f < mesh->triangle_count; f++) {
        double normal[3];
        const double area = plm_face_normal(mesh, f, normal);
        density[f] = area > 0 ? light->face_power[f] / area : 0;
        area_sum += area;
        power_sum += light->face_power[f];
    }
    return area_sum > 0 && power_sum > 0 ? 3 * power_sum / area_sum : 1;
}

static plm_status write_body(plm_output *output, const plm_mesh *mesh, const uint8_t *face_label,
                             const plm_light *light, const double *density, double most, plm_error *error)
{
    plm_status status = PLM_OK;
    for (size_t k = 0; k < mesh->vertex_count && status == PLM_OK; k++) {
        double place[3];
        for (int i = 0; i < 3; i++) place[i] = mesh->origin[i] + mesh->vertex[k][i];
        status = plm_output_write(output, place, sizeof place, error);
    }
    for (size_t f = 0; f < mesh->triangle_count && status == PLM_OK; f++) {
        const uint8_t corners = 3;
        const float power[2] = {(float)light->face_power[f], (float)density[f]};
        uint8_t rgb[3];
        plm_packed row = {.used = 0};
        shade(density[f] / most, rgb);
        plm_pack(&row, &corners, 1);
        plm_pack(&row, mesh->triangle[f], sizeof mesh->triangle[f]);
        plm_pack(&row, power, sizeof power);
        plm_pack(&row, rgb, sizeof rgb);
        if (face_label) plm_pack(&row, &face_label[f], 1);
        if (mesh->face_organ) plm_pack(&row, &mesh->face_organ[f], sizeof(int32_t));
        status = plm_output_write(output, row.bytes, row.used, error);
    }
    return status;
}

plm_status plm_light_write(const char *path, const plm_mesh *mesh, const uint8_t *face_label, const plm_light *light,
                           plm_error *error)
{
    double *density = plm_alloc(mesh->triangle_count, sizeof *density, error);
    if (!density) return PLM_E_MEMORY;
    const double most = densities(mesh, light, density);
    plm_output *output;
    plm_status status = plm_output_open(path, &output, error);
    if (status == PLM_OK) {
        status = write_header(output, mesh, face_label != NULL, error);
        if (status == PLM_OK) status = write_body(output, mesh, face_label, light, density, most, error);
        const plm_status closed = plm_output_close(output, status == PLM_OK, error);
        if (status == PLM_OK) status = closed;
    }
    plm_free(density);
    return status;
}
