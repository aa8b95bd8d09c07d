/* reports/assets.h: files that the library carries (cmake/PlantimeterAssets.cmake). Internal to reports/. */
#ifndef PLANTIMETER_REPORTS_ASSETS_H
#define PLANTIMETER_REPORTS_ASSETS_H

#include <stddef.h>

/** Bytes, a zero behind them that size does not count. three is of size 0 where three.js was not there at build time. */
extern const unsigned char plm_asset_style[], plm_asset_viewer[], plm_asset_three[], plm_asset_ontology[];
extern const size_t plm_asset_style_size, plm_asset_viewer_size, plm_asset_three_size, plm_asset_ontology_size;

#endif
