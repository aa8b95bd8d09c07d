/* tool/reading.h: options about inputs, shared by the sub-commands that read clouds, and reading by them. */
#ifndef PLANTIMETER_TOOL_READING_H
#define PLANTIMETER_TOOL_READING_H

#include "io/io.h"
#include "tool/command.h"
#include "traits/traits.h"

/** What the options say about an input. All zero but scale: the defaults. */
typedef struct reading_settings {
    const char *labels, *organs, *columns, *crs, *known_length, *scale_from;
    int label_scheme, unit, up;
    int stem_label;
    double scale, minimum_opacity; /* scale 0: not given */
    int splat_points;
} reading_settings;

/** The rows of these options: a command's `shared` table. */
enum { READING_OPTION_COUNT = 13 };
extern const plm_option reading_options[READING_OPTION_COUNT];

/** A cloud as the measurement wants it, and what became of the file on the way. */
typedef struct loaded_cloud {
    plm_cloud cloud; /* metres; local east-north-up where georeferenced */
    plm_read_report report;
    plm_unit_scale scale;
    bool is_georeferenced;
    plm_georeference georeference;
    float (*original)[3]; /* the file's coordinates, kept on demand; NULL else */
    double original_origin[3];
} loaded_cloud;

/** Checks what the parser could not: combinations, texts of --crs, --known-length and --scale-from. PLM_E_ARGUMENT. */
plm_status check_reading(const reading_settings *settings, plm_error *error);

/** Reads a cloud and brings it to metres. keep_original: the file's coordinates too. The caller frees it. */
plm_status load_cloud(const char *path, const reading_settings *settings, bool keep_original, loaded_cloud *loaded,
                      plm_error *error);
void free_loaded(loaded_cloud *loaded);

#endif
