/* traits/table.c: one row a trait. The CSV, the plan, `plantimeter traits` and docs/traits.md are all made from it. */
#include "traits/families.h"

#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

static const plm_trait traits[] = {
    {.name = "leaf_count",
     .level = PLM_PLANT,
     .unit = PLM_NUMBER,
     .needs = PLM_NEEDS_ORGANS,
     .measure = plm_trait_leaf_count,
     .definition = "number of leaves, cotyledons included; a compound leaf is one leaf",
     .source = "design",
     .ontology = "TO:0000241"},
    {.name = "leaflet_count",
     .level = PLM_PLANT,
     .unit = PLM_NUMBER,
     .needs = PLM_NEEDS_ORGANS,
     .measure = plm_trait_leaflet_count,
     .definition = "number of leaflets of all compound leaves",
     .source = "design",
     .ontology = ""},
};

const plm_trait *plm_traits(size_t *count)
{
    *count = COUNT(traits);
    return traits;
}

const plm_trait *plm_trait_find(const char *name)
{
    for (size_t i = 0; i < COUNT(traits); i++)
        if (!strcmp(traits[i].name, name)) return &traits[i];
    return NULL;
}

const char *plm_level_name(plm_level level)
{
    static const char *const names[PLM_LEVEL_COUNT] = {"plant", "stem", "petiole", "leaf"};
    return (unsigned)level < PLM_LEVEL_COUNT ? names[level] : "unknown";
}

static const struct unit_row {
    const char *name;
    double factor;
} units[PLM_UNIT_COUNT] = {
    [PLM_MILLIMETRE] = {"mm", 1e3}, [PLM_SQUARE_CM] = {"cm2", 1e4},
    [PLM_CUBIC_CM] = {"cm3", 1e6},  [PLM_DEGREE] = {"deg", 180 / 3.14159265358979323846},
    [PLM_NUMBER] = {"1", 1},
};

const char *plm_unit_name(plm_unit unit)
{
    return (unsigned)unit < PLM_UNIT_COUNT ? units[unit].name : "unknown";
}

double plm_unit_factor(plm_unit unit)
{
    return (unsigned)unit < PLM_UNIT_COUNT ? units[unit].factor : 1;
}
