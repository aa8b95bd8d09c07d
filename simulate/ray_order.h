/* simulate/ray_order.h: an order of rays in which neighbours run side by side. Internal. */
#ifndef PLANTIMETER_SIMULATE_RAY_ORDER_H
#define PLANTIMETER_SIMULATE_RAY_ORDER_H

#include "simulate/rays.h"

/** Puts count rays (at most PLM_RAY_BATCH) into order along a curve that keeps neighbours together (Morton's, over 64 x 64 cells):
 * order[i] is the ray that comes i-th. x and y: where each ray is in the unit square; what lies outside counts as its rim. */
void plm_ray_order(const float *x, const float *y, size_t count, uint16_t *order);

#endif
