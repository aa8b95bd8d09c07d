/* tests/support/tubes.h: points on made-up tubes of known shape. */
#ifndef PLANTIMETER_TEST_TUBES_H
#define PLANTIMETER_TEST_TUBES_H

#include <stddef.h>
#include <stdint.h>

/** A tube over the chord from base to end that bows sideways (towards the horizontal normal of the chord) by bow at half
 * length, as a parabola; radius linear from radius[0] at the base to radius[1], wider by flare at the base, which falls off by e in
 * flare_length along the chord (0: no flare). Points lie between the directions arc[0] and arc[1] (radians; from the side of the
 * bow), with isotropic normal noise. */
typedef struct test_tube {
    double base[3], end[3], bow, radius[2], flare, flare_length, arc[2], noise;
} test_tube;

/** Writes count points of the tube's surface. */
void test_tube_points(const test_tube *tube, size_t count, uint64_t *state, double (*xyz)[3]);

/** A point of the tube's axis, t from 0 at the base to 1. */
void test_tube_axis(const test_tube *tube, double t, double point[3]);

#endif
