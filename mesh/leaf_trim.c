/* mesh/leaf_trim.c: the alpha-shape of a patch with local alpha (a triangle counts while its circumcircle is small
 * against the spacing around it; Edelsbrunner, Kirkpatrick and Seidel 1983), islands and holes. */
#include "mesh/leaf_trim.h"

#include "cloud/linear.h"
#include "cloud/selection.h"

#include <string.h>

enum {
    SMALLEST_ISLAND = 8 /* triangles */
};

static const double sparse_ratio = 3.0; /* local spacing over the patch's: half-hidden */

bool plm_patch_owns(const plm_leaf_patch *patch, size_t t)
{
    const uint32_t *corner = patch->triangulation.corner[t];
    const size_t a = patch->owner[corner[0]], b = patch->owner[corner[1]], c = patch->owner[corner[2]];
    size_t most = a < b ? (a < c ? a : c) : (b < c ? b : c);
    if (a == b || a == c) most = a;
    if (b == c) most = b;
    return most == patch->self;
}

/* Area of a triangle: in the chart plane, times the mean secant of its corners. */
static double area_of(const plm_leaf_patch *patch, size_t t)
{
    const uint32_t *corner = patch->triangulation.corner[t];
    const double *a = patch->uvz[corner[0]], *b = patch->uvz[corner[1]], *c = patch->uvz[corner[2]];
    const double flat = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    return flat * (patch->secant[corner[0]] + patch->secant[corner[1]] + patch->secant[corner[2]]) / 3;
}

static double spacing_of(const plm_leaf_patch *patch, size_t t)
{
    const uint32_t *corner = patch->triangulation.corner[t];
    return (patch->spacing[corner[0]] + patch->spacing[corner[1]] + patch->spacing[corner[2]]) / 3;
}

/* Walks from start over triangles that have start's state and are not seen yet; lists them. Gives how many. touches: the
 * walk came to the hull. */
static size_t walk(const plm_triangulation *mesh, const uint8_t *state, bool *seen, size_t start, uint32_t *list,
                   bool *touches)
{
    size_t end = 0;
    *touches = false;
    seen[start] = true;
    list[end++] = (uint32_t)start;
    for (size_t at = 0; at < end; at++)
        for (int i = 0; i < 3; i++) {
            const uint32_t next = mesh->across[list[at]][i];
            if (next == PLM_NO_TRIANGLE) {
                *touches = true;
            } else if (!seen[next] && state[next] == state[start]) {
                seen[next] = true;
                list[end++] = next;
            }
        }
    return end;
}

static void set_state(uint8_t *state, const uint32_t *list, size_t count, uint8_t value)
{
    for (size_t i = 0; i < count; i++) state[list[i]] = value;
}

static plm_status drop_islands(const plm_leaf_patch *patch, uint8_t *state, plm_error *error)
{
    const plm_triangulation *mesh = &patch->triangulation;
    bool *seen = plm_alloc_zero(mesh->count, sizeof *seen, error);
    uint32_t *list = plm_alloc(mesh->count, sizeof *list, error);
    const bool good = seen && list;
    for (size_t t = 0; good && t < mesh->count; t++) {
        bool touches;
        if (seen[t] || state[t] == PLM_TRIANGLE_OUT) continue;
        const size_t size = walk(mesh, state, seen, t, list, &touches);
        if (size < SMALLEST_ISLAND && 4 * size < mesh->count) set_state(state, list, size, PLM_TRIANGLE_OUT);
    }
    plm_free(seen);
    plm_free(list);
    return good ? PLM_OK : PLM_E_MEMORY;
}

static plm_status fill_holes(const plm_leaf_patch *patch, double largest, uint8_t *state, double *gap, plm_error *error)
{
    const plm_triangulation *mesh = &patch->triangulation;
    bool *seen = plm_alloc_zero(mesh->count, sizeof *seen, error);
    uint32_t *list = plm_alloc(mesh->count, sizeof *list, error);
    const bool good = seen && list;
    double whole = 0;
    for (size_t t = 0; good && t < mesh->count; t++)
        if (state[t] != PLM_TRIANGLE_OUT) whole += area_of(patch, t);
    for (size_t t = 0; good && t < mesh->count; t++) {
        bool touches;
        if (seen[t] || state[t] != PLM_TRIANGLE_OUT) continue;
        const size_t size = walk(mesh, state, seen, t, list, &touches);
        if (touches) continue;
        double area = 0, own = 0;
        for (size_t j = 0; j < size; j++) {
            const double part = area_of(patch, list[j]);
            area += part;
            if (plm_patch_owns(patch, list[j])) own += part;
        }
        if (area <= largest * whole)
            set_state(state, list, size, PLM_TRIANGLE_HOLE);
        else
            *gap += own;
    }
    plm_free(seen);
    plm_free(list);
    return good ? PLM_OK : PLM_E_MEMORY;
}

/* Adds the sides of a triangle beyond which there is no leaf. */
static void add_rim(const plm_leaf_patch *patch, const uint8_t *state, size_t t, plm_trim_sums *sums)
{
    for (int i = 0; i < 3; i++) {
        const uint32_t across = patch->triangulation.across[t][i];
        if (across != PLM_NO_TRIANGLE && state[across] != PLM_TRIANGLE_OUT) continue;
        const uint32_t a = patch->triangulation.corner[t][(i + 1) % 3], b = patch->triangulation.corner[t][(i + 2) % 3];
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = patch->uvz[a][k] - patch->uvz[b][k];
        sums->boundary += plm_norm(d);
    }
}

static plm_status add_sums(const plm_leaf_patch *patch, const uint8_t *state, plm_trim_sums *sums, plm_error *error)
{
    double *sorted = plm_alloc(patch->count, sizeof *sorted, error);
    if (!sorted) return PLM_E_MEMORY;
    if (patch->count) memcpy(sorted, patch->spacing, patch->count * sizeof *sorted);
    const double sparse = patch->count ? sparse_ratio * plm_select_quantile(sorted, patch->count, 0.5) : 0;
    plm_free(sorted);
    for (size_t t = 0; t < patch->triangulation.count; t++) {
        if (state[t] == PLM_TRIANGLE_OUT || !plm_patch_owns(patch, t)) continue;
        const double area = area_of(patch, t), spacing = spacing_of(patch, t);
        sums->area += area;
        sums->spacing_area += area * spacing;
        if (state[t] == PLM_TRIANGLE_HOLE) sums->hole_area += area;
        if (spacing > sparse) sums->sparse_area += area;
        add_rim(patch, state, t, sums);
    }
    return PLM_OK;
}

plm_status plm_leaf_trim(const plm_leaf_patch *patch, const plm_trim *trim, uint8_t *state, plm_trim_sums *sums,
                         plm_error *error)
{
    double gap = 0;
    for (size_t t = 0; t < patch->triangulation.count; t++) {
        const double limit = trim->radius > 0 ? trim->radius : trim->factor * spacing_of(patch, t);
        state[t] = patch->circumradius[t] <= limit ? PLM_TRIANGLE_IN : PLM_TRIANGLE_OUT;
    }
    plm_status status = drop_islands(patch, state, error);
    if (status == PLM_OK) status = fill_holes(patch, trim->largest_hole, state, &gap, error);
    if (status == PLM_OK) status = add_sums(patch, state, sums, error);
    if (status == PLM_OK) sums->gap_area += gap;
    return status;
}
