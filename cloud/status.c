/* cloud/status.c: error messages and the names of statuses and labels. */
#include "cloud/cloud.h"

#include <stdio.h>

plm_status plm_fail(plm_error *error, plm_status status, const char *format, ...)
{
    if (!error) return status;
    error->status = status;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    return status;
}

const char *plm_status_name(plm_status status)
{
    static const char *const names[] = {
        [PLM_OK] = "ok",
        [PLM_E_ARGUMENT] = "bad argument",
        [PLM_E_MEMORY] = "out of memory",
        [PLM_E_READ] = "cannot read",
        [PLM_E_FORMAT] = "bad format",
        [PLM_E_WRITE] = "cannot write",
        [PLM_E_DEGENERATE] = "not determined by the points",
        [PLM_E_LIBRARY] = "a library failed",
        [PLM_E_TIME] = "no time left",
    };
    return (size_t)status < sizeof names / sizeof *names ? names[status] : "unknown status";
}

const char *plm_label_name(plm_label label)
{
    static const char *const names[PLM_LABEL_COUNT] = {"other", "stem", "petiole", "leaf", "ground"};
    return (unsigned)label < PLM_LABEL_COUNT ? names[label] : "unknown";
}
