/* tests/fuzz/fuzz.c: what every reader promises of a cloud that it accepts. */
#include "fuzz.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void require(bool holds, const char *what)
{
    if (holds) return;
    fprintf(stderr, "broken: %s\n", what);
    abort();
}

static bool is_offset(float value)
{
    return fabsf(value) < 1e19f; /* NaN is not */
}

static void check_cloud(const plm_cloud *cloud, const plm_read_options *options, const plm_read_report *report)
{
    const uint64_t dropped = report->dropped_not_finite + report->dropped_transparent + report->dropped_withheld;
    const size_t pieces = report->format == PLM_FORMAT_SPLAT && options->splat_points == 5 ? 5 : 1;
    require(cloud->count > 0 && cloud->count == (report->rows - dropped) * pieces,
            "kept and dropped rows make all rows");
    require(!options->label_field == !cloud->label, "labels come when they are asked for");
    for (size_t i = 0; i < cloud->count; i++) {
        for (int k = 0; k < 3; k++) require(is_offset(cloud->xyz[i][k]), "offsets are finite");
        if (cloud->label) require(cloud->label[i] < PLM_LABEL_COUNT, "labels are classes");
        if (cloud->organ) require(cloud->organ[i] >= -1, "organs are numbered from 0, or -1");
        if (cloud->source) require(cloud->source[i] < report->rows, "sources are rows");
        if (cloud->opacity && report->format == PLM_FORMAT_SPLAT)
            require(cloud->opacity[i] > 0 && cloud->opacity[i] <= 1, "opacity is a share");
    }
    for (int k = 0; k < 3; k++) require(isfinite(cloud->origin[k]) != 0, "the origin is finite");
    require(memchr(report->fields, 0, sizeof report->fields) != NULL, "the fields end");
}

void fuzz_reader(plm_reader *read, plm_format format, const uint8_t *data, size_t size)
{
    static const plm_read_options options[] = {
        {0},
        {.label_field = "label", .splat_points = 5},
        {.label_field = "4", .label_scheme = PLM_LABELS_INSTANCES, .stem_label = 1, .columns = "x,y,z,label"},
    };
    uint8_t *exact = malloc(size ? size : 1); /* a block of its own, so that a sanitizer sees its end */
    if (!exact) return;
    memcpy(exact, data, size);
    const plm_bytes bytes = plm_bytes_wrap(exact, size, "fuzz");
    for (size_t i = 0; size && i < sizeof options / sizeof *options; i++) {
        plm_error error = {0};
        plm_cloud cloud = {0};
        plm_read_report report = {.format = format};
        const plm_status status = read(&bytes, &options[i], &cloud, &report, &error);
        if (status == PLM_OK) {
            check_cloud(&cloud, &options[i], &report);
            plm_cloud_free(&cloud);
        } else {
            require(error.status == status && error.message[0], "a failure has a message");
            require(!cloud.xyz, "a failure leaves the cloud alone");
        }
    }
    free(exact);
}
