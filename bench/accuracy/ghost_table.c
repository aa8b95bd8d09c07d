/* bench/accuracy/ghost_table.c: what train_ghosts.py learns from.
 *
 *     ghost_table LABELLED_CLOUD...
 *
 * For each cloud, to standard output: the number of points (uint32), then for each the features of segment/ghosts.h, its
 * label, and how far the next point of the plant is that is not the point itself, all float32. Ground is left out, as
 * cleaning does. */
#include "cloud/neighbours.h"
#include "io/io.h"
#include "segment/ghosts.h"
#include "segment/thinning.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { BUDGET = 80000 }; /* as segment/clean.c has it */

/* The label that most points of a thinned one have. */
static int voted(const plm_thinned *thinned, size_t v, const uint8_t *label)
{
    unsigned votes[PLM_LABEL_COUNT] = {0};
    int most = 0;
    for (uint32_t m = thinned->voxels.first[v]; m < thinned->voxels.first[v + 1]; m++)
        votes[label[thinned->voxels.member[m]]]++;
    for (int k = 1; k < PLM_LABEL_COUNT; k++)
        if (votes[k] > votes[most]) most = k;
    return most;
}

/* Rows of the table of features, labels and distances to the plant. */
static plm_status write_rows(const plm_thinned *thinned, const uint8_t *label, float (*feature)[PLM_GHOST_FEATURES],
                             plm_error *error)
{
    const float(*xyz)[3] = (const float(*)[3])thinned->xyz;
    float(*plant)[3] = plm_alloc(thinned->count, sizeof *plant, error);
    int *voice = plm_alloc(thinned->count, sizeof *voice, error);
    plm_index *index = NULL;
    plm_status status = plant && voice ? PLM_OK : PLM_E_MEMORY;
    size_t count = 0;
    for (size_t v = 0; v < thinned->count && status == PLM_OK; v++)
        if ((voice[v] = voted(thinned, v, label)) != PLM_LABEL_OTHER) memcpy(plant[count++], xyz[v], sizeof *plant);
    if (status == PLM_OK) status = plm_index_build((const float(*)[3])plant, count, &index, error);
    for (size_t v = 0; v < thinned->count && status == PLM_OK; v++) {
        uint32_t row[2];
        float squared[2] = {0}, values[2] = {(float)voice[v]};
        plm_index_nearest(index, xyz[v], 2, row, squared);
        values[1] = sqrtf(squared[voice[v] != PLM_LABEL_OTHER]);
        fwrite(feature[v], sizeof *feature, 1, stdout);
        fwrite(values, sizeof values, 1, stdout);
    }
    plm_index_free(index);
    plm_free(plant);
    plm_free(voice);
    return status;
}

static plm_status write_table(const plm_cloud *cloud, plm_error *error)
{
    plm_thinned thinned = {0};
    double cell = 0;
    size_t count = 0;
    float(*xyz)[3] = plm_alloc(cloud->count, sizeof *xyz, error);
    uint8_t *label = plm_alloc(cloud->count, sizeof *label, error);
    float(*feature)[PLM_GHOST_FEATURES] = NULL;
    plm_status status = xyz && label ? PLM_OK : PLM_E_MEMORY;
    for (size_t i = 0; i < cloud->count && status == PLM_OK; i++) {
        if (cloud->label[i] == PLM_LABEL_GROUND) continue;
        memcpy(xyz[count], cloud->xyz[i], sizeof *xyz);
        label[count++] = cloud->label[i];
    }
    const float(*points)[3] = (const float(*)[3])xyz;
    if (status == PLM_OK && count > BUDGET) status = plm_thin_cell(points, count, BUDGET, &cell, error);
    if (status == PLM_OK) status = plm_thin(points, count, cell, &thinned, error);
    if (status == PLM_OK && !(feature = plm_alloc(thinned.count, sizeof *feature, error))) status = PLM_E_MEMORY;
    if (status == PLM_OK) status = plm_ghost_features((const float(*)[3])thinned.xyz, thinned.count, feature, error);
    const uint32_t rows = (uint32_t)thinned.count;
    if (status == PLM_OK) fwrite(&rows, sizeof rows, 1, stdout);
    if (status == PLM_OK) status = write_rows(&thinned, label, feature, error);
    plm_free(feature);
    plm_thinned_free(&thinned);
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
