/* io/geographic.cpp: coordinates on the WGS 84 ellipsoid by GeographicLib. The contract is in geographic.h. */
#include "io/geographic.h"

#include "cloud/guard.hpp"

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/UTMUPS.hpp>

namespace
{
const char library[] = "GeographicLib";
const double across_equator = 1e7; /* metres between the northings of the two hemispheres */

GeographicLib::LocalCartesian frame_of(const plm_georeference *reference)
{
    return GeographicLib::LocalCartesian(reference->latitude, reference->longitude, reference->height);
}
} // namespace

extern "C" plm_status plm_geographic_to_geodetic(const plm_crs *crs, double (*point)[3], size_t count, plm_error *error)
{
    return plm_guard(error, library, [&] {
        for (size_t i = 0; i < count && !crs->is_geodetic; i++) {
            double latitude, longitude;
            GeographicLib::UTMUPS::Reverse(crs->utm_zone, !crs->is_south, point[i][0], point[i][1], latitude,
                                           longitude);
            point[i][0] = longitude;
            point[i][1] = latitude;
        }
        return PLM_OK;
    });
}

extern "C" plm_status plm_geographic_from_geodetic(const plm_crs *crs, double (*point)[3], size_t count,
                                                   plm_error *error)
{
    return plm_guard(error, library, [&] {
        for (size_t i = 0; i < count && !crs->is_geodetic; i++) {
            int zone;
            bool is_north;
            double easting, northing;
            GeographicLib::UTMUPS::Forward(point[i][1], point[i][0], zone, is_north, easting, northing, crs->utm_zone);
            if (is_north == crs->is_south) northing += crs->is_south ? across_equator : -across_equator;
            point[i][0] = easting;
            point[i][1] = northing;
        }
        return PLM_OK;
    });
}

extern "C" plm_status plm_geographic_to_earth(double (*point)[3], size_t count, plm_error *error)
{
    return plm_guard(error, library, [&] {
        for (size_t i = 0; i < count; i++) {
            double *p = point[i];
            GeographicLib::Geocentric::WGS84().Forward(p[1], p[0], p[2], p[0], p[1], p[2]);
        }
        return PLM_OK;
    });
}

extern "C" plm_status plm_geographic_from_earth(double (*point)[3], size_t count, plm_error *error)
{
    return plm_guard(error, library, [&] {
        for (size_t i = 0; i < count; i++) {
            double *p = point[i];
            GeographicLib::Geocentric::WGS84().Reverse(p[0], p[1], p[2], p[1], p[0], p[2]);
        }
        return PLM_OK;
    });
}

extern "C" plm_status plm_geographic_to_local(const plm_georeference *reference, double (*point)[3], size_t count,
                                              plm_error *error)
{
    return plm_guard(error, library, [&] {
        const GeographicLib::LocalCartesian frame = frame_of(reference);
        for (size_t i = 0; i < count; i++) {
            double *p = point[i];
            frame.Forward(p[1], p[0], p[2], p[0], p[1], p[2]);
        }
        return PLM_OK;
    });
}

extern "C" plm_status plm_geographic_from_local(const plm_georeference *reference, double (*point)[3], size_t count,
                                                plm_error *error)
{
    return plm_guard(error, library, [&] {
        const GeographicLib::LocalCartesian frame = frame_of(reference);
        for (size_t i = 0; i < count; i++) {
            double *p = point[i];
            frame.Reverse(p[0], p[1], p[2], p[1], p[0], p[2]);
        }
        return PLM_OK;
    });
}
