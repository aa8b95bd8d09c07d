/* reports/value_text.h: values as people read them. Internal to reports/ and tool/. */
#ifndef PLANTIMETER_REPORTS_VALUE_TEXT_H
#define PLANTIMETER_REPORTS_VALUE_TEXT_H

#include <stddef.h>

enum { PLM_VALUE_ROOM = 96 };

/** "182.40 ± 0.30 mm": two digits of the standard error say how many of the value are known. Without an error: six digits.
 * unit "1" and "" are left out. A point whatever the locale says. Gives out. */
const char *plm_value_text(double value, double std_error, const char *unit, char out[PLM_VALUE_ROOM]);

/** "leaf_insertion_angle" as "leaf insertion angle", cut to room. */
void plm_readable_name(const char *name, char *out, size_t room);

#endif
