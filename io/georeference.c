/* io/georeference.c: from longitude and latitude or UTM to metres in a local frame, and back.
 *
 * The frame stands in the middle of the points' box in the earth-centred frame: so it does not matter that longitudes jump
 * at the date line and mean nothing at the poles. UTM is not just shifted: its metres are 0.9996 to 1.001 of true ones,
 * and its north is off by the meridian convergence. */
#include "cloud/linear.h"
#include "io/geographic.h"
#include "io/number.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { PIECE = 1024, PIECES = 64 };

plm_status plm_crs_parse(const char *text, plm_crs *crs, plm_error *error)
{
    static const char prefix[] = "utm:";
    plm_crs parsed = {.is_geodetic = strcasecmp(text, "geodetic") == 0};
    const size_t length = strlen(text), begin = sizeof prefix - 1;
    if (!parsed.is_geodetic) {
        if (strncasecmp(text, prefix, begin) != 0)
            return plm_fail(error, PLM_E_ARGUMENT,
                            "\"%s\" is no coordinate system; geodetic or utm:ZONE[N|S] was expected", text);
        const char last = length > begin ? text[length - 1] : 0;
        const bool has_side = last && strchr("NnSs", last);
        unsigned long long zone;
        if (!plm_number_whole(text + begin, length - begin - has_side, &zone) || zone < 1 || zone > 60)
            return plm_fail(error, PLM_E_ARGUMENT,
                            "\"%s\": the UTM zone is a number from 1 to 60 and N or S behind it, such as utm:32N",
                            text);
        parsed.utm_zone = (int)zone;
        parsed.is_south = last == 'S' || last == 's';
    }
    *crs = parsed;
    return PLM_OK;
}

/* Are the numbers in the range of the coordinate system? A plain message beats what a projection makes of them. */
static plm_status check_point(const plm_crs *crs, const double point[3], size_t row, plm_error *error)
{
    if (crs->is_geodetic) {
        if (fabs(point[0]) <= 360 && fabs(point[1]) <= 90) return PLM_OK;
        return plm_fail(
            error, PLM_E_ARGUMENT,
            "point %zu: longitude %.9g and latitude %.9g; -360 to 360 and -90 to 90 degrees were expected (x is "
            "longitude, y is latitude)",
            row + 1, point[0], point[1]);
    }
    /* UTM ends at 84 degrees north and 80 south, and GeographicLib half a degree and more beyond. */
    const double low = crs->is_south ? 9e5 : 0, high = crs->is_south ? 1e7 : 9.6e6;
    if (point[0] > 0 && point[0] < 1e6 && point[1] >= low && point[1] <= high) return PLM_OK;
    return plm_fail(
        error, PLM_E_ARGUMENT,
        "point %zu: easting %.9g and northing %.9g; 0 to 1000000 and %.0f to %.0f m were expected of UTM %s "
        "of the equator",
        row + 1, point[0], point[1], low, high, crs->is_south ? "south" : "north");
}

/** Points that one thread converts at a time. */
typedef struct piece {
    size_t first, count;
    double point[PIECE][3];
    double low[3], high[3]; /* in the earth-centred frame */
    plm_status status;
    plm_error error;
} piece;

typedef struct conversion {
    const plm_cloud *cloud;
    plm_georeference reference;
    piece *pieces;
    float (*local)[3]; /* out; NULL: only the bounds are wanted */
    double low[3], high[3];
} conversion;

static plm_status load_geodetic(const conversion *work, piece *at)
{
    const plm_cloud *cloud = work->cloud;
    for (size_t i = 0; i < at->count; i++) {
        for (int axis = 0; axis < 3; axis++)
            at->point[i][axis] = cloud->origin[axis] + (double)cloud->xyz[at->first + i][axis];
        const plm_status status = check_point(&work->reference.crs, at->point[i], at->first + i, &at->error);
        if (status != PLM_OK) return status;
    }
    return plm_geographic_to_geodetic(&work->reference.crs, at->point, at->count, &at->error);
}

static plm_status find_bounds(piece *at)
{
    const plm_status status = plm_geographic_to_earth(at->point, at->count, &at->error);
    for (int axis = 0; axis < 3; axis++) {
        at->low[axis] = INFINITY;
        at->high[axis] = -INFINITY;
        for (size_t i = 0; i < at->count; i++) {
            at->low[axis] = fmin(at->low[axis], at->point[i][axis]);
            at->high[axis] = fmax(at->high[axis], at->point[i][axis]);
        }
    }
    return status;
}

static plm_status convert(const conversion *work, piece *at)
{
    plm_status status = load_geodetic(work, at);
    if (status != PLM_OK) return status;
    if (!work->local) return find_bounds(at);
    status = plm_geographic_to_local(&work->reference, at->point, at->count, &at->error);
    for (size_t i = 0; i < at->count; i++)
        for (int axis = 0; axis < 3; axis++) work->local[at->first + i][axis] = (float)at->point[i][axis];
    return status;
}

/* Converts all points, PIECES pieces at a time. The first failure in the order of the cloud wins. */
static plm_status convert_all(conversion *work, plm_error *error)
{
    const size_t points = work->cloud->count;
    for (size_t first = 0; first < points; first += (size_t)PIECES * PIECE) {
#pragma omp parallel for schedule(dynamic) if (points > PIECE)
        for (int i = 0; i < PIECES; i++) {
            piece *at = &work->pieces[i];
            at->first = first + (size_t)i * PIECE;
            const size_t left = at->first < points ? points - at->first : 0;
            at->count = left < PIECE ? left : PIECE;
            at->status = convert(work, at);
        }
        for (int i = 0; i < PIECES; i++) {
            const piece *at = &work->pieces[i];
            if (at->status != PLM_OK) return plm_fail(error, at->status, "%s", at->error.message);
            for (int axis = 0; axis < 3 && !work->local; axis++) {
                work->low[axis] = fmin(work->low[axis], at->low[axis]);
                work->high[axis] = fmax(work->high[axis], at->high[axis]);
            }
        }
    }
    return PLM_OK;
}

/* Puts the frame into the middle of the points' box in the earth-centred frame. */
static plm_status find_middle(conversion *work, plm_error *error)
{
    double middle[1][3];
    plm_status status = convert_all(work, error);
    for (int axis = 0; axis < 3; axis++) middle[0][axis] = work->low[axis] / 2 + work->high[axis] / 2;
    if (status == PLM_OK) status = plm_geographic_from_earth(middle, 1, error);
    work->reference.longitude = middle[0][0];
    work->reference.latitude = middle[0][1];
    work->reference.height = middle[0][2];
    return status;
}

/* Longitudes on both sides of the date line are 360 degrees apart, and float offsets hold only coarse steps of that. */
static plm_status check_date_line(const conversion *work, plm_error *error)
{
    if (!work->reference.crs.is_geodetic) return PLM_OK;
    double reach = 0, size = 0;
    for (size_t i = 0; i < work->cloud->count; i++) reach = fmax(reach, fabs((double)work->cloud->xyz[i][0]));
    for (int axis = 0; axis < 3; axis++) size = fmax(size, work->high[axis] - work->low[axis]);
    const double metres_a_degree = 111320 * cos(plm_radians(work->reference.latitude));
    const double step = reach * 0x1p-24 * metres_a_degree;
    if (reach < 90 || step <= 1e-6 * size) return PLM_OK;
    return plm_fail(
        error, PLM_E_ARGUMENT,
        "the longitudes lie on both sides of the date line: float numbers hold only steps of %.2g m of that; "
        "write longitudes beyond 180 (180.00001 in place of -179.99999)",
        step);
}

/* Direction of grid north in the local frame, at its origin: where a point goes that lies 1 m further north. Normals are
 * along the axes of a grid; beside longitudes and latitudes they can only be along east, north and up already. */
static plm_status grid_north(const plm_georeference *reference, double *east, double *north, plm_error *error)
{
    double point[1][3] = {{reference->longitude, reference->latitude, reference->height}};
    *east = 0;
    *north = 1;
    if (reference->crs.is_geodetic) return PLM_OK;
    plm_status status = plm_geographic_from_geodetic(&reference->crs, point, 1, error);
    point[0][1] += 1;
    if (status == PLM_OK) status = plm_geographic_to_geodetic(&reference->crs, point, 1, error);
    if (status == PLM_OK) status = plm_geographic_to_local(reference, point, 1, error);
    if (status != PLM_OK) return status;
    const double length = hypot(point[0][0], point[0][1]);
    *east = point[0][0] / length;
    *north = point[0][1] / length;
    return PLM_OK;
}

static void turn_normals(plm_cloud *cloud, double east, double north)
{
    for (size_t i = 0; cloud->normal && i < cloud->count; i++) {
        const double x = (double)cloud->normal[i][0], y = (double)cloud->normal[i][1];
        cloud->normal[i][0] = (float)(x * north + y * east);
        cloud->normal[i][1] = (float)(y * north - x * east);
    }
}

plm_status plm_cloud_georeference(plm_cloud *cloud, const plm_crs *crs, plm_georeference *reference, plm_error *error)
{
    if (cloud->count == 0) return plm_fail(error, PLM_E_DEGENERATE, "an empty cloud has no place on the earth");
    conversion work = {.cloud = cloud,
                       .reference = {.crs = *crs},
                       .low = {INFINITY, INFINITY, INFINITY},
                       .high = {-INFINITY, -INFINITY, -INFINITY}};
    double east = 0, north = 1;
    float(*local)[3] = plm_alloc(cloud->count, sizeof *local, error);
    work.pieces = local ? plm_alloc(PIECES, sizeof *work.pieces, error) : NULL;
    plm_status status = work.pieces ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) status = find_middle(&work, error);
    if (status == PLM_OK) status = check_date_line(&work, error);
    if (status == PLM_OK) status = grid_north(&work.reference, &east, &north, error);
    work.local = local;
    if (status == PLM_OK) status = convert_all(&work, error);
    if (status == PLM_OK) {
        memcpy(cloud->xyz, local, cloud->count * sizeof *local);
        memset(cloud->origin, 0, sizeof cloud->origin);
        turn_normals(cloud, east, north);
        *reference = work.reference;
    }
    plm_free(work.pieces);
    plm_free(local);
    return status;
}

plm_status plm_georeference_locate(const plm_georeference *reference, const double local[3], double *longitude,
                                   double *latitude, double *height, plm_error *error)
{
    double point[1][3];
    memcpy(point[0], local, sizeof point[0]);
    const plm_status status = plm_geographic_from_local(reference, point, 1, error);
    if (status != PLM_OK) return status;
    *longitude = point[0][0];
    *latitude = point[0][1];
    *height = point[0][2];
    return PLM_OK;
}

plm_status plm_georeference_restore(const plm_georeference *reference, const double local[3],
                                    double file_coordinates[3], plm_error *error)
{
    double point[1][3];
    memcpy(point[0], local, sizeof point[0]);
    plm_status status = plm_geographic_from_local(reference, point, 1, error);
    if (status == PLM_OK) status = plm_geographic_from_geodetic(&reference->crs, point, 1, error);
    if (status == PLM_OK) memcpy(file_coordinates, point[0], sizeof point[0]);
    return status;
}
