/* tests/support/scene.h: small made-up scenes for the tests of segment/: a plant, a pot, a table, as labelled points. */
#ifndef PLANTIMETER_TESTS_SCENE_H
#define PLANTIMETER_TESTS_SCENE_H

#include "cloud/cloud.h"

/** What a scene holds. Lengths in units of the scene, about 1 = the plant's height; soil at z = 0. */
typedef struct test_scene {
    size_t points;          /**< room; parts stop growing there */
    bool rosette;           /**< leaves lie low and spread from the base, else they sit along a stem */
    double leaf_length;     /**< 0: no leaves */
    bool flat_leaves;       /**< horizontal and plane */
    double pot_radius;      /**< 0: no pot */
    double pot_height, rim; /**< rim over the soil */
    bool square;
    double table_radius;    /**< 0: no table; under the pot, else it is the soil */
    double noise, outliers; /**< standard deviation; share of stray points */
    double spacing;
    uint64_t seed;
} test_scene;

/** Makes the cloud with colour and labels. Points that nothing could see (soil below the pot's wall, ...) are not made.
 * The caller frees it. */
plm_status test_scene_make(const test_scene *scene, plm_cloud *cloud, plm_error *error);

#endif
