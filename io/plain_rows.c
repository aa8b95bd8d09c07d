/* io/plain_rows.c: strided copies without a look at types in the loop. */
#include "io/plain_rows.h"

#include "io/origin.h"

#include <math.h>
#include <string.h>

/* Have the three columns from first on this type and layout, so that one address and stride does for all? */
static bool are_adjacent(const plm_roles *roles, plm_role first, plm_scalar type)
{
    for (unsigned k = 0; k < 3; k++) {
        const plm_column *column = roles->column[first + k], *before = roles->column[first + (k ? k - 1 : 0)];
        if (!column || column->type != type || column->is_swapped || column->scale != 0 || column->mask) return false;
        if (k && (column->stride != before->stride || column->data != before->data + plm_scalar_size(type)))
            return false;
    }
    return true;
}

bool plm_plain_places_are(const plm_roles *roles)
{
    return !roles->is_splat && !roles->column[PLM_ROLE_WITHHELD] && are_adjacent(roles, PLM_ROLE_X, PLM_FLOAT32);
}

bool plm_plain_colours_are(const plm_roles *roles)
{
    return !roles->is_splat && are_adjacent(roles, PLM_ROLE_RED, PLM_UINT8);
}

static const unsigned char *row_at(const plm_roles *roles, plm_role role, size_t row)
{
    return roles->column[role]->data + row * roles->column[role]->stride;
}

/* Four lanes at once, the last of them unused: it is emptied, as what follows a place may read as NaN. Plain loops over the three coordinates take twice as long. */
typedef float lanes __attribute__((vector_size(16)));
typedef int32_t masks __attribute__((vector_size(16)));

static inline lanes choose(masks which, lanes yes, lanes no)
{
    return (lanes)((which & (masks)yes) | (~which & (masks)no));
}

bool plm_plain_bounds(const plm_roles *roles, size_t first, size_t count, double low[3], double high[3])
{
    const unsigned char *from = row_at(roles, PLM_ROLE_X, first);
    const size_t stride = roles->column[PLM_ROLE_X]->stride;
    const lanes farthest = {PLM_FARTHEST, PLM_FARTHEST, PLM_FARTHEST, PLM_FARTHEST};
    lanes least = {INFINITY, INFINITY, INFINITY}, most = -least;
    const masks used = {-1, -1, -1, 0};
    masks is_good = {-1, -1, -1, -1};
    for (size_t i = 0; i < count; i++, from += stride) {
        lanes v = {0};
        if (i + 1 < count)
            memcpy(&v, from, sizeof v); /* three floats, and what follows: another row does */
        else
            memcpy(&v, from, 3 * sizeof(float));
        v = (lanes)((masks)v & used);
        least = choose(v < least, v, least);
        most = choose(v > most, v, most);
        is_good &= (v <= farthest) & (v >= -farthest); /* NaN is neither */
    }
    for (int k = 0; k < 3; k++) {
        low[k] = (double)least[k];
        high[k] = (double)most[k];
    }
    return is_good[0] && is_good[1] && is_good[2];
}

void plm_plain_places(const plm_roles *roles, size_t first, size_t count, const double origin[3], float (*xyz)[3])
{
    const unsigned char *from = row_at(roles, PLM_ROLE_X, first);
    const size_t stride = roles->column[PLM_ROLE_X]->stride;
    if (origin[0] == 0 && origin[1] == 0 && origin[2] == 0) {
        for (size_t i = 0; i < count; i++) memcpy(xyz[i], from + i * stride, sizeof xyz[i]);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        float v[3];
        memcpy(v, from + i * stride, sizeof v);
        for (int k = 0; k < 3; k++) xyz[i][k] = (float)((double)v[k] - origin[k]);
    }
}

void plm_plain_colours(const plm_roles *roles, size_t first, size_t count, uint8_t (*rgb)[3])
{
    const unsigned char *from = row_at(roles, PLM_ROLE_RED, first);
    const size_t stride = roles->column[PLM_ROLE_RED]->stride;
    for (size_t i = 0; i < count; i++) memcpy(rgb[i], from + i * stride, sizeof rgb[i]);
}
