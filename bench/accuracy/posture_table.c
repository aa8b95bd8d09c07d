/* bench/accuracy/posture_table.c: what train_posture.py learns from.
 *
 *     posture_table CLOUD...
 *
 * For each cloud one line to standard output: its path, then the signs of segment/frame.h for x, y, z, -x, -y, -z. Clouds
 * of too few points to tell are an error. */
#include "io/io.h"
#include "segment/frame.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
        plm_error error = {0};
        plm_cloud cloud = {0};
        plm_posture posture;
        plm_status status = plm_cloud_read(argv[i], NULL, &cloud, NULL, &error);
        if (status == PLM_OK) status = plm_find_posture(&cloud, &posture, &error);
        plm_cloud_free(&cloud);
        if (status == PLM_OK && !posture.is_known) status = plm_fail(&error, PLM_E_DEGENERATE, "too few points");
        if (status != PLM_OK) {
            fprintf(stderr, "posture_table: %s: %s\n", argv[i], error.message);
            return EXIT_FAILURE;
        }
        printf("%s", argv[i]);
        for (int axis = 0; axis < PLM_AXES; axis++)
            for (int k = 0; k < PLM_POSTURE_SIGNS; k++) printf(" %.9g", posture.sign[axis][k]);
        printf("\n");
    }
    return EXIT_SUCCESS;
}
