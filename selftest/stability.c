/* selftest/stability.c: the groups of cases, one after the other. */
#include "selftest/checks.h"

#include <string.h>

plm_status plm_selftest_stability(plm_check_table *table, const char *only, void (*progress)(const char *group),
                                  plm_error *error)
{
    static const struct {
        const char *name;
        void (*run)(plm_checker *checker);
    } groups[] = {
        {"meshes", plm_stability_meshes},
        {"hulls", plm_stability_hulls},
        {"eigenvectors", plm_stability_eigenvectors},
        {"leaves", plm_stability_leaves},
        {"tubes", plm_stability_tubes},
        {"plants", plm_stability_plants},
        {"numbers", plm_stability_numbers},
        {"places", plm_stability_places},
    };
    plm_checker checker = {.table = table, .status = PLM_OK, .error = error};
    bool is_known = !only;
    for (size_t i = 0; i < sizeof groups / sizeof *groups && checker.status == PLM_OK; i++) {
        if (only && strcmp(only, groups[i].name) != 0) continue;
        is_known = true;
        if (progress) progress(groups[i].name);
        groups[i].run(&checker);
    }
    if (!is_known)
        return plm_fail(
            error, PLM_E_ARGUMENT,
            "there is no group of cases \"%s\"; there are meshes, hulls, eigenvectors, leaves, tubes, plants, "
            "numbers and places",
            only);
    return checker.status;
}
