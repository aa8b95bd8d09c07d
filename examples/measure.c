/* examples/measure.c: measures one plant by the C interface and prints its values.
 *
 *     cc measure.c $(pkg-config --cflags --libs plantimeter) -o measure && ./measure plant.ply [TRAITS] */
#include <plantimeter/plantimeter.h>

#include <stdio.h>

int main(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "usage: %s CLOUD [TRAITS]\n", argv[0]);
        return 2;
    }
    plm_error error = {0};
    plm_cloud cloud;
    plm_unit_scale scale;
    if (plm_cloud_read(argv[1], NULL, &cloud, NULL, &error) != PLM_OK ||
        plm_scale_guess(&cloud, &scale, &error) != PLM_OK) {
        fprintf(stderr, "%s\n", error.message);
        return 3;
    }
    plm_cloud_rescale(&cloud, scale.metres_per_unit);

    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = argc > 2 ? argv[2] : NULL; /* only what these need is run; NULL: all */
    plm_measurement plant;
    if (plm_measure(&cloud, &options, &plant, &error) != PLM_OK) { /* takes the cloud over */
        fprintf(stderr, "%s\n", error.message);
        return 1;
    }
    for (size_t i = 0; i < plant.value_count; i++) {
        const plm_trait_value *row = &plant.value[i];
        const plm_estimate *estimate = &row->estimate;
        const double factor = plm_unit_factor(row->trait->unit);
        printf("%-8s%3d  %-24s", plm_level_name(row->trait->level), row->organ_id, row->trait->name);
        if (estimate->state == PLM_STATE_OK)
            printf("%.4g +- %.2g %s\n", estimate->value * factor, estimate->std_error * factor,
                   plm_unit_name(row->trait->unit));
        else
            printf("%s\n", estimate->reason);
    }
    plm_measurement_free(&plant);
    return 0;
}
