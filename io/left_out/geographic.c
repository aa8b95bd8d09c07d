/* io/left_out/geographic.c: stands in for io/geographic.cpp in a build without GeographicLib (PLANTIMETER_GEOREFERENCE=OFF). */
#include "io/geographic.h"

static plm_status left_out(plm_error *error)
{
    return plm_fail(error, PLM_E_ARGUMENT,
                    "georeferencing is left out of this build (PLANTIMETER_GEOREFERENCE=OFF); measure without --crs");
}

plm_status plm_geographic_to_geodetic(const plm_crs *crs, double (*point)[3], size_t count, plm_error *error)
{
    (void)crs, (void)point, (void)count;
    return left_out(error);
}

plm_status plm_geographic_from_geodetic(const plm_crs *crs, double (*point)[3], size_t count, plm_error *error)
{
    (void)crs, (void)point, (void)count;
    return left_out(error);
}

plm_status plm_geographic_to_earth(double (*point)[3], size_t count, plm_error *error)
{
    (void)point, (void)count;
    return left_out(error);
}

plm_status plm_geographic_from_earth(double (*point)[3], size_t count, plm_error *error)
{
    (void)point, (void)count;
    return left_out(error);
}

plm_status plm_geographic_to_local(const plm_georeference *reference, double (*point)[3], size_t count,
                                   plm_error *error)
{
    (void)reference, (void)point, (void)count;
    return left_out(error);
}

plm_status plm_geographic_from_local(const plm_georeference *reference, double (*point)[3], size_t count,
                                     plm_error *error)
{
    (void)reference, (void)point, (void)count;
    return left_out(error);
}
