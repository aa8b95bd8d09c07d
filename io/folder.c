/* io/folder.c: folders that results go into. */
#include "io/io.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

plm_status plm_folder_make(const char *folder, plm_error *error)
{
    char path[4096];
    if (!*folder) return plm_fail(error, PLM_E_WRITE, "the name of the folder is empty");
    if (snprintf(path, sizeof path, "%s", folder) >= (int)sizeof path)
        return plm_fail(error, PLM_E_WRITE, "%.60s...: the path is too long", folder);
    for (char *at = path + 1;; at++) {
        if (*at && *at != '/') continue;
        const char behind = *at;
        *at = 0;
        if (mkdir(path, 0777) != 0 && errno != EEXIST)
            return plm_fail(error, PLM_E_WRITE, "%s: the folder cannot be made: %s", path, strerror(errno));
        *at = behind;
        if (!behind) break;
    }
    struct stat found;
    if (stat(folder, &found) == 0 && S_ISDIR(found.st_mode)) return PLM_OK;
    return plm_fail(error, PLM_E_WRITE, "%s: is no folder", folder);
}
