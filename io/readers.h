/* io/readers.h: the readers of the formats; io/cloud_read.c has the table of them. Internal to io/.
 *
 * Each gets all bytes of the file, options that are not NULL, and a report that it fills in (format is set already). */
#ifndef PLANTIMETER_IO_READERS_H
#define PLANTIMETER_IO_READERS_H

#include "io/columns.h"

typedef plm_status plm_reader(const plm_bytes *bytes, const plm_read_options *options, plm_cloud *cloud,
                              plm_read_report *report, plm_error *error);

plm_reader plm_ply_read;
plm_reader plm_pcd_read;
plm_reader plm_las_read;
plm_reader plm_text_read;

#endif
