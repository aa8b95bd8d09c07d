/* io/mesh_write.c: meshes as PLY, OBJ and STL. */
#include "io/mesh_openmesh.h"

#include <math.h>
#include <string.h>
#include <strings.h>

/* Organs in well-parted colours: hues a golden angle apart, in turn light and dark. -1, no organ, is grey. */
static void organ_colour(int32_t organ, uint8_t rgb[3])
{
    if (organ < 0) {
        memset(rgb, 160, 3);
        return;
    }
    const double golden = 0.61803398874989485, turn = fmod(organ * golden, 1) * 6;
    const double value = organ % 2 ? 200 : 245, least = 0.3 * value;
    for (int k = 0; k < 3; k++) {
        const double away =
            fabs(fmod(turn - 2 * k + 9, 6) - 3); /* sextants between this hue and pure red, green, blue */
        const double share = away < 1 ? 1 : away < 2 ? 2 - away : 0;
        rgb[k] = (uint8_t)(least + (value - least) * share + 0.5);
    }
}

static plm_status check_mesh(const plm_mesh *mesh, plm_error *error)
{
    if (mesh->vertex_count > INT32_MAX)
        return plm_fail(error, PLM_E_ARGUMENT, "a mesh of %zu vertices; at most %d can be written", mesh->vertex_count,
                        INT32_MAX);
    for (size_t i = 0; i < mesh->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            if (mesh->triangle[i][k] >= mesh->vertex_count)
                return plm_fail(error, PLM_E_ARGUMENT, "triangle %zu names vertex %u of a mesh of %zu vertices", i,
                                mesh->triangle[i][k], mesh->vertex_count);
    return PLM_OK;
}

/* Would float coordinates with the origin added lose more than 1e-7 of the mesh's size? */
static bool is_far(const plm_mesh *mesh)
{
    double size = 0, loss = 0;
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < mesh->vertex_count; i++) {
            const double local = mesh->vertex[i][axis], at = mesh->origin[axis] + local;
            low = fmin(low, local);
            high = fmax(high, local);
            loss = fmax(loss, fabs((double)(float)at - at));
        }
        size = fmax(size, high - low);
    }
    return loss > 1e-7 * size;
}

static uint8_t (*organ_colours(const plm_mesh *mesh, plm_error *error))[3]
{
    uint8_t(*colour)[3] = plm_alloc(mesh->triangle_count, sizeof *colour, error);
    for (size_t i = 0; colour && i < mesh->triangle_count; i++) organ_colour(mesh->face_organ[i], colour[i]);
    return colour;
}

plm_status plm_mesh_write(const char *path, const plm_mesh *mesh, plm_error *error)
{
    static const char *const formats[] = {"PLY", "OBJ", "STL"};
    static const double zero[3] = {0, 0, 0};
    const char *ending = strrchr(path, '.'), *format = NULL;
    for (size_t i = 0; ending && i < sizeof formats / sizeof *formats; i++)
        if (strcasecmp(ending + 1, formats[i]) == 0) format = formats[i];
    if (!format)
        return plm_fail(error, PLM_E_ARGUMENT, "%s: a name that ends in .ply, .obj or .stl was expected", path);
    plm_status status = check_mesh(mesh, error);
    if (status != PLM_OK) return status;
    uint8_t(*colour)[3] = mesh->face_organ ? organ_colours(mesh, error) : NULL;
    if (mesh->face_organ && !colour) return PLM_E_MEMORY;
    plm_output *output;
    status = plm_output_open(path, &output, error);
    if (status == PLM_OK) {
        status = plm_mesh_openmesh_write(mesh, is_far(mesh) ? zero : mesh->origin, (const uint8_t(*)[3])colour, format,
                                         output, error);
        const plm_status closed = plm_output_close(output, status == PLM_OK, error);
        if (status == PLM_OK) status = closed;
    }
    plm_free(colour);
    return status;
}
