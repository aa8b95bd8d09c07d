/* io/geographic.h: coordinates on the WGS 84 ellipsoid by GeographicLib. Adapter: the contract is pure C. Internal to io/.
 *
 * Each function converts count points in place. "Geodetic" is longitude and latitude in degrees and height in metres. All
 * may fail with PLM_E_LIBRARY and GeographicLib's text, or PLM_E_MEMORY; the points are then of no use. */
#ifndef PLANTIMETER_IO_GEOGRAPHIC_H
#define PLANTIMETER_IO_GEOGRAPHIC_H

#include "io/io.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Coordinates of crs to geodetic, and back. */
plm_status plm_geographic_to_geodetic(const plm_crs *crs, double (*point)[3], size_t count, plm_error *error);
plm_status plm_geographic_from_geodetic(const plm_crs *crs, double (*point)[3], size_t count, plm_error *error);

/** Geodetic to metres in the earth-centred frame, and back. */
plm_status plm_geographic_to_earth(double (*point)[3], size_t count, plm_error *error);
plm_status plm_geographic_from_earth(double (*point)[3], size_t count, plm_error *error);

/** Geodetic to metres in the east-north-up frame of reference, and back. */
plm_status plm_geographic_to_local(const plm_georeference *reference, double (*point)[3], size_t count,
                                   plm_error *error);
plm_status plm_geographic_from_local(const plm_georeference *reference, double (*point)[3], size_t count,
                                     plm_error *error);

#ifdef __cplusplus
}
#endif
#endif
