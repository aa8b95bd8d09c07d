/* io/json_file.c: JSON by jansson through the library's seams: its memory, its files, the user's texts. */
#include "io/json_file.h"

#include "io/io.h"

static void *seam_alloc(size_t size)
{
    return plm_alloc(size, 1, NULL);
}

void plm_json_use_seam(void)
{
    json_set_alloc_funcs(seam_alloc, plm_free);
}

plm_status plm_json_check(const json_t *object, plm_error *error)
{
    return object ? PLM_OK : plm_fail(error, PLM_E_MEMORY, "out of memory while writing JSON");
}

/* How many bytes of UTF-8 begin at text: 0 where there are none (RFC 3629: no overlong forms, no surrogates). */
static size_t sequence_length(const unsigned char *text)
{
    const unsigned char first = text[0];
    const size_t length = first < 0x80   ? 1
                          : first < 0xc2 ? 0
                          : first < 0xe0 ? 2
                          : first < 0xf0 ? 3
                          : first < 0xf5 ? 4
                                         : 0;
    for (size_t i = 1; i < length; i++)
        if ((text[i] & 0xc0) != 0x80) return 0;
    const bool is_overlong = (first == 0xe0 && text[1] < 0xa0) || (first == 0xf0 && text[1] < 0x90);
    const bool is_no_character = (first == 0xed && text[1] >= 0xa0) || (first == 0xf4 && text[1] >= 0x90);
    return is_overlong || is_no_character ? 0 : length;
}

/* Names of files and fields may hold bytes that are no UTF-8; JSON may not. */
json_t *plm_json_text(const char *text)
{
    char *clean = plm_strdup(text, NULL);
    if (!clean) return NULL;
    for (unsigned char *at = (unsigned char *)clean; *at;) {
        const size_t length = sequence_length(at);
        if (length == 0) *at = '?';
        at += length ? length : 1;
    }
    json_t *made = json_string(clean);
    plm_free(clean);
    return made;
}

typedef struct dump {
    plm_output *output;
    plm_status status;
    plm_error *error;
} dump;

static int dump_bytes(const char *buffer, size_t size, void *data)
{
    dump *d = data;
    d->status = plm_output_write(d->output, buffer, size, d->error);
    return d->status == PLM_OK ? 0 : -1;
}

plm_status plm_json_write(const char *path, const json_t *object, int digits, plm_error *error)
{
    plm_status status = plm_json_check(object, error);
    dump d = {.error = error};
    if (status == PLM_OK) status = plm_output_open(path, &d.output, error);
    if (status != PLM_OK) return status;
    if (json_dump_callback(object, dump_bytes, &d, JSON_INDENT(1) | JSON_REAL_PRECISION((size_t)digits)) != 0)
        status = d.status != PLM_OK ? d.status : plm_json_check(NULL, error);
    if (status == PLM_OK) status = plm_output_write(d.output, "\n", 1, error);
    const plm_status closed = plm_output_close(d.output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}
