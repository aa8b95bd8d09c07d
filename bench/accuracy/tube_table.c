/* bench/accuracy/tube_table.c: what train_tubes.py learns from.
 *
 *     tube_table LABELLED_CLOUD...
 *
 * For each cloud and each of three sizes of the balls, to standard output: the number of working points (uint32), then for each
 * the features of segment/tube_class.h, how many points its ball of R holds, and its label, all float32. Ground and what is
 * of no organ are left out: floaters and ghosts as if they had been told, fruit and tassels too. */
#include "io/io.h"
#include "segment/sketch.h"

#include <stdio.h>
#include <string.h>

enum { SIZES = 3 };
static const double SIZE[SIZES] = {1, 0.75, 1.33}; /* of R as it is found: on other plants it may be found elsewhere */

/* The label that most points of a working one have. */
static plm_status vote(const plm_sketch *sketch, const uint8_t *label, size_t count, float *voted, plm_error *error)
{
    uint32_t(*votes)[PLM_LABEL_COUNT] = plm_alloc_zero(sketch->working.count, sizeof *votes, error);
    if (!votes) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) votes[sketch->working.voxels.owner[sketch->base.voxels.owner[i]]][label[i]]++;
    for (size_t w = 0; w < sketch->working.count; w++) {
        int most = 0;
        for (int k = 1; k < PLM_LABEL_COUNT; k++)
            if (votes[w][k] > votes[w][most]) most = k;
        voted[w] = (float)most;
    }
    plm_free(votes);
    return PLM_OK;
}

static void write_rows(const plm_sketch *sketch, const float *voted)
{
    const uint32_t rows = (uint32_t)sketch->working.count;
    fwrite(&rows, sizeof rows, 1, stdout);
    for (size_t w = 0; w < rows; w++) {
        const float of_point[2] = {(float)sketch->point[w].count, voted[w]};
        fwrite(sketch->point[w].feature, sizeof sketch->point[w].feature, 1, stdout);
        fwrite(of_point, sizeof of_point, 1, stdout);
    }
}

static plm_status write_sketch(plm_sketch *sketch, const uint8_t *label, size_t count, plm_error *error)
{
    float *voted = plm_alloc(sketch->working.count, sizeof *voted, error);
    plm_status status = voted ? vote(sketch, label, count, voted, error) : PLM_E_MEMORY;
    const double radius = sketch->scale.radius;
    for (int k = 0; status == PLM_OK && k < SIZES; k++) {
        sketch->scale.radius = SIZE[k] * radius;
        status = plm_tube_points((const float(*)[3])sketch->base.xyz, sketch->base.count, &sketch->working,
                                 &sketch->scale, sketch->point, error);
        if (status == PLM_OK) write_rows(sketch, voted);
    }
    plm_free(voted);
    return status;
}

static plm_status write_table(const plm_cloud *cloud, plm_error *error)
{
    plm_sketch sketch = {0};
    float(*xyz)[3] = plm_alloc(cloud->count, sizeof *xyz, error);
    uint8_t *label = plm_alloc(cloud->count, sizeof *label, error);
    plm_status status = xyz && label ? PLM_OK : PLM_E_MEMORY;
    size_t count = 0;
    for (size_t i = 0; status == PLM_OK && i < cloud->count; i++) {
        if (cloud->label[i] == PLM_LABEL_GROUND || cloud->label[i] == PLM_LABEL_OTHER) continue;
        memcpy(xyz[count], cloud->xyz[i], sizeof *xyz);
        label[count++] = cloud->label[i];
    }
    if (status == PLM_OK) status = plm_sketch_make((const float(*)[3])xyz, count, 0, PLM_TUBES_ANY, &sketch, error);
    if (status == PLM_OK) status = write_sketch(&sketch, label, count, error);
    plm_sketch_free(&sketch);
    plm_free(xyz);
    plm_free(label);
    return status;
}

int main(int count, char **path)
{
    const plm_read_options options = {.label_field = "label"};
    for (int i = 1; i < count; i++) {
        plm_error error = {0};
        plm_cloud cloud = {0};
        plm_status status = plm_cloud_read(path[i], &options, &cloud, NULL, &error);
        if (status == PLM_OK) status = write_table(&cloud, &error);
        plm_cloud_free(&cloud);
        if (status != PLM_OK) {
            fprintf(stderr, "%s: %s\n", path[i], error.message);
            return 1;
        }
    }
    if (fflush(stdout) == 0 && !ferror(stdout)) return 0;
    fprintf(stderr, "the table could not be written\n");
    return 1;
}
