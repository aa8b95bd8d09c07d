/* tests/support/tubes.c: points on made-up tubes. */
#include "support/tubes.h"

#include "cloud/linear.h"
#include "support/test.h"

/* Unit chord, the side of the bow (horizontal), and the third direction. */
static double frame(const test_tube *tube, double chord[3], double side[3], double third[3])
{
    for (int k = 0; k < 3; k++) chord[k] = tube->end[k] - tube->base[k];
    const double length = plm_normalise(chord);
    plm_frame_of_axis(chord, side, third);
    return length;
}

void test_tube_axis(const test_tube *tube, double t, double point[3])
{
    double chord[3], side[3], third[3];
    const double length = frame(tube, chord, side, third);
    for (int k = 0; k < 3; k++)
        point[k] = tube->base[k] + t * length * chord[k] + 4 * tube->bow * t * (1 - t) * side[k];
}

void test_tube_points(const test_tube *tube, size_t count, uint64_t *state, double (*xyz)[3])
{
    double chord[3], side[3], third[3];
    const double length = frame(tube, chord, side, third);
    for (size_t i = 0; i < count; i++) {
        const double t = test_uniform(state);
        const double angle = tube->arc[0] + (tube->arc[1] - tube->arc[0]) * test_uniform(state);
        const double slope = 4 * tube->bow * (1 - 2 * t) / length, stretch = hypot(1, slope);
        double radius = tube->radius[0] + t * (tube->radius[1] - tube->radius[0]);
        if (tube->flare_length > 0) radius += tube->flare * exp(-t * length / tube->flare_length);
        double at[3];
        test_tube_axis(tube, t, at);
        for (int k = 0; k < 3; k++) {
            const double across = (side[k] - slope * chord[k]) / stretch; /* in the bow's plane, at right angles */
            xyz[i][k] =
                at[k] + radius * (cos(angle) * across + sin(angle) * third[k]) + tube->noise * test_normal(state);
        }
    }
}
