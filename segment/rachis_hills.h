/* segment/rachis_hills.h: leaflets at a compound leaf's sides that touch its last one. Internal. */
#ifndef PLANTIMETER_SEGMENT_RACHIS_HILLS_H
#define PLANTIMETER_SEGMENT_RACHIS_HILLS_H

#include "segment/junction.h"

/** Marks, of way->count points in the way's order, those of leaflets that lie beside the line along a part of it only, though
 * they touch the last one: hills of the distance from the line, with the saddle where they touch.
 * off, station  distance of each point from the line, and the line's station nearest to it.
 * reach         what is within is on the line, up to twice as far lies beside it.
 * longest       links longer than this do not hold blades together.
 * aside         points that are marked already are not looked at. PLM_E_MEMORY. */
plm_status plm_rachis_hills(const plm_leaf_way *way, const float *off, const uint32_t *station, double reach,
                            double longest, bool *aside, plm_error *error);

#endif
