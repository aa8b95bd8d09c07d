/* reports/value_text.c: values as people read them. */
#include "reports/value_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *plm_value_text(double value, double std_error, const char *unit, char out[PLM_VALUE_ROOM])
{
    if (isfinite(std_error) && std_error > 0) {
        const double magnitude = floor(log10(std_error));
        const int decimals = magnitude >= 1 ? 0 : magnitude < -8 ? 9 : 1 - (int)magnitude;
        snprintf(out, PLM_VALUE_ROOM, "%.*f ± %.*f", decimals, value, decimals, std_error);
    } else {
        snprintf(out, PLM_VALUE_ROOM, "%.6g", value);
    }
    for (char *c = out; *c; c++)
        if (*c == ',') *c = '.'; /* a locale may put a comma there */
    const size_t length = strlen(out);
    if (*unit && strcmp(unit, "1")) snprintf(out + length, PLM_VALUE_ROOM - length, " %s", unit);
    return out;
}

void plm_readable_name(const char *name, char *out, size_t room)
{
    snprintf(out, room, "%s", name);
    for (char *c = out; *c; c++)
        if (*c == '_') *c = ' ';
}
