/* segment/tube_weights.h: the logistic formula of segment/tube_class.c: rows are ball sizes, columns features. Fitted once
 * to virtual plants, by a script that was not kept. Internal. */
#ifndef PLANTIMETER_SEGMENT_TUBE_WEIGHTS_H
#define PLANTIMETER_SEGMENT_TUBE_WEIGHTS_H

static const double TUBE_BIAS = 4.52241;
static const double TUBE_WEIGHT[6][6] = {
    {0.520902, -1.4288, 1.13295, -3.8686, 17.9445, 4.53056},
    {-1.19133, -0.517081, 4.50263, -10.243, 7.09455, 0.566589},
    {-2.24619, 0.0475147, 6.84109, -14.7202, 14.4606, -4.15646},
    {-5.1856, 5.88207, 16.2122, -8.09356, -6.08724, -0.380431},
    {-4.94245, 6.05646, 4.27689, -16.2238, -12.3052, -0.220724},
    {-1.5751, -3.5214, -2.12853, -5.31609, 26.4116, -10.6186},
};

#endif
