/* segment/sheet_surface.h: a plant without tubes as a smooth surface: thinned points moved onto it, their normals, and links
 * that lead along it. Internal. */
#ifndef PLANTIMETER_SEGMENT_SHEET_SURFACE_H
#define PLANTIMETER_SEGMENT_SHEET_SURFACE_H

#include "segment/graph.h"
#include "segment/thinning.h"

typedef struct plm_sheet_surface {
    plm_thinned thinned;
    double spacing;     /**< of the thinned points: edge of a square that holds one, median */
    float (*xyz)[3];    /**< thinned.count rows: the points moved across the surface onto its middle */
    float (*normal)[3]; /**< unit, either sign */
    plm_graph near;     /**< over xyz: all neighbours */
    plm_graph graph;    /**< of these, the ones that lie in each other's plane; may be in pieces */
} plm_sheet_surface;

/** noise: sigma across surfaces. The result is the caller's: plm_sheet_surface_free. PLM_E_DEGENERATE where points are too few for
 * one, PLM_E_MEMORY, or as plm_thin. */
plm_status plm_sheet_surface_make(const float (*xyz)[3], size_t count, double noise, plm_sheet_surface *surface,
                                  plm_error *error);

void plm_sheet_surface_free(plm_sheet_surface *surface);

#endif
