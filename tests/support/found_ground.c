/* tests/support/found_ground.c: how well ground is told from a plant. */
#include "support/found_ground.h"

#include "support/test.h"

found_ground ground_in(const plm_cloud *cloud)
{
    plm_error error = {0};
    found_ground o = {0};
    uint8_t *label = calloc(cloud->count + 1, 1);
    assert_ok(plm_find_ground(cloud, PLM_GROUND_AUTO, 0, label, &o.ground, &error));
    double both = 0, either = 0, plant = 0, kept = 0, ground = 0, lowest[2] = {INFINITY, INFINITY};
    for (size_t i = 0; i < cloud->count; i++) {
        const bool truth = cloud->label[i] == PLM_LABEL_GROUND, said = label[i] == PLM_LABEL_GROUND;
        if (cloud->label[i] == PLM_LABEL_OTHER) continue; /* strays near the ground have no right answer */
        both += truth && said;
        either += truth || said;
        plant += !truth;
        ground += truth;
        kept += !truth && !said;
        if (!truth) lowest[0] = fmin(lowest[0], cloud->xyz[i][2]);
        if (!said) lowest[1] = fmin(lowest[1], cloud->xyz[i][2]);
    }
    o.lower = lowest[0] - lowest[1];
    o.iou = either > 0 ? both / either : 1;
    o.kept = plant > 0 ? kept / plant : 1;
    o.left = ground > 0 ? 1 - both / ground : 0;
    free(label);
    return o;
}

found_ground ground_in_grown(const char *kind, bool is_arched, const plm_scan_options *options, bool coloured)
{
    plm_error error = {0};
    plm_virtual_plant plant;
    plm_scan scan;
    assert_ok(
        plm_plant_grow(kind, &(plm_plant_options){.seed = options->seed, .is_arched = is_arched}, &plant, &error));
    assert_ok(plm_scan_plant(&plant, options, &scan, &error));
    plm_cloud cloud = scan.cloud;
    if (!coloured) cloud.rgb = NULL;
    const found_ground o = ground_in(&cloud);
    plm_scan_free(&scan);
    plm_virtual_plant_free(&plant);
    return o;
}

found_ground ground_in_plant(const char *kind, const plm_scan_options *options, bool coloured)
{
    return ground_in_grown(kind, false, options, coloured);
}
