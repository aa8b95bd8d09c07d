/* segment/leaflet_shape.c: leaflets are longer than wide, and hang at an end. */
#include "segment/leaflet_shape.h"

#include "cloud/linear.h"

static const double LONGER = 1.3;  /* SD along the way from the base to the middle over SD across */
static const double ALONG = 0.95;  /* cosine of that way and the longest axis */
static const double BEHIND = 0.02; /* share of the points behind the base */
static const double ASIDE = 0.85;  /* the same cosine at a side, at most */

plm_piece_shape plm_piece_shape_of(const double (*xyz)[3], size_t count)
{
    plm_piece_shape shape = {0};
    double moment[6] = {0}, value[3];
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) shape.middle[a] += xyz[i][a] / (double)count;
    for (size_t i = 0; i < count; i++) {
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = xyz[i][a] - shape.middle[a];
        for (int a = 0, m = 0; a < 3; a++)
            for (int b = a; b < 3; b++) moment[m++] += d[a] * d[b];
    }
    plm_eigen3(moment, value, shape.axis);
    shape.across = sqrt(fmax(value[1], 0) / (double)count);
    return shape;
}

/* Direction within the piece's plane from a place to its middle; gives how far that is. */
static double way_to_middle(const plm_piece_shape *shape, const double place[3], double way[3])
{
    for (int a = 0; a < 3; a++) way[a] = shape->middle[a] - place[a];
    const double off = plm_dot(way, shape->axis[2]);
    for (int a = 0; a < 3; a++) way[a] -= off * shape->axis[2][a];
    return plm_normalise(way);
}

bool plm_hangs_at(const double (*xyz)[3], size_t count, const plm_piece_shape *shape, const double place[3])
{
    double way[3], across[3], along2 = 0, across2 = 0;
    size_t behind = 0;
    way_to_middle(shape, place, way);
    if (fabs(plm_dot(way, shape->axis[0])) < ALONG) return false;
    plm_cross(way, shape->axis[2], across);
    for (size_t i = 0; i < count; i++) {
        double d[3], from[3];
        for (int a = 0; a < 3; a++) {
            d[a] = xyz[i][a] - shape->middle[a];
            from[a] = xyz[i][a] - place[a];
        }
        along2 += plm_dot(d, way) * plm_dot(d, way);
        across2 += plm_dot(d, across) * plm_dot(d, across);
        behind += plm_dot(from, way) < 0;
    }
    return along2 >= LONGER * LONGER * across2 && (double)behind <= BEHIND * (double)count;
}

bool plm_is_at_side(const plm_piece_shape *shape, const double place[3])
{
    double way[3];
    const double off = way_to_middle(shape, place, way);
    return off > shape->across && fabs(plm_dot(way, shape->axis[0])) < ASIDE;
}
