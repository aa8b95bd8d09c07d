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
    {.name = "total_leaf_area",
     .level = PLM_PLANT,
     .unit = PLM_SQUARE_CM,
     .needs = PLM_NEEDS_SURFACE,
     .measure = plm_trait_total_leaf_area,
     .definition = "sum of the one-sided areas of all leaves",
     .source = "seedling paper, Eq. 22",
     .ontology = ""},
    {.name = "leaf_area",
     .level = PLM_LEAF,
     .unit = PLM_SQUARE_CM,
     .needs = PLM_NEEDS_SURFACE,
     .measure = plm_trait_leaf_area,
     .definition = "one-sided area of the leaf surface, rim bias from sampling and noise corrected",
     .source = "seedling paper, Eq. 22",
     .ontology = "TO:0000540"},
    {.name = "leaf_inclination",
     .level = PLM_LEAF,
     .unit = PLM_DEGREE,
     .needs = PLM_NEEDS_SURFACE | PLM_NEEDS_ZENITH,
     .measure = plm_trait_leaf_inclination,
     .definition = "angle between the leaf's area-weighted best-fit plane normal and zenith, 0 to 90",
     .source = "seedling paper, Eq. 24",
     .ontology = "TO:0000206"},
    {.name = "facet_inclination_mean",
     .level = PLM_LEAF,
     .unit = PLM_DEGREE,
     .needs = PLM_NEEDS_SURFACE | PLM_NEEDS_ZENITH,
     .measure = plm_trait_facet_inclination_mean,
     .definition = "area-weighted mean of the angles between facet normals and zenith, 0 to 90",
     .source = "design",
     .ontology = ""},
    {.name = "facet_inclination_sd",
     .level = PLM_LEAF,
     .unit = PLM_DEGREE,
     .needs = PLM_NEEDS_SURFACE | PLM_NEEDS_ZENITH,
     .measure = plm_trait_facet_inclination_sd,
     .definition = "area-weighted standard deviation of the angles between facet normals and zenith",
     .source = "design",
     .ontology = ""},
    {.name = "leaf_azimuth",
     .level = PLM_LEAF,
     .unit = PLM_DEGREE,
     .needs = PLM_NEEDS_SURFACE | PLM_NEEDS_ZENITH,
     .measure = plm_trait_leaf_azimuth,
     .definition =
         "ground projection of blade base to tip, from +x towards +y, 0 to 360 (compound: petiole base to last tip)",
     .source = "design",
     .ontology = ""},
    {.name = "leaf_azimuth_from_stem",
     .level = PLM_LEAF,
     .unit = PLM_DEGREE,
     .needs = PLM_NEEDS_SURFACE | PLM_NEEDS_ZENITH,
     .measure = plm_trait_leaf_azimuth_from_stem,
     .definition = "ground projection of plant base to leaf centroid, from +x towards +y, 0 to 360",
     .source = "design",
     .ontology = ""},
    {.name = "leaf_length",
     .level = PLM_LEAF,
     .unit = PLM_MILLIMETRE,
     .needs = PLM_NEEDS_SURFACE,
     .measure = plm_trait_leaf_length,
     .definition = "arc along the midrib from junction to tip (compound: first leaflet junction along the rachis to "
                   "the last tip)",
     .source = "design",
     .ontology = "TO:0000135"},
    {.name = "leaf_width",
     .level = PLM_LEAF,
     .unit = PLM_MILLIMETRE,
     .needs = PLM_NEEDS_SURFACE,
     .measure = plm_trait_leaf_width,
     .definition = "largest cross-section along the surface (compound: extent across the leaf in its plane)",
     .source = "design",
     .ontology = "TO:0000370"},
    {.name = "flatness",
     .level = PLM_LEAF,
     .unit = PLM_NUMBER,
     .needs = PLM_NEEDS_SURFACE,
     .measure = plm_trait_leaf_flatness,
     .definition =
         "smallest over middle eigenvalue of the sheet's second moments; towards 1 the leaf's plane is not defined",
     .source = "design",
     .ontology = ""},
    {.name = "leaf_alpha",
     .level = PLM_LEAF,
     .unit = PLM_MILLIMETRE,
     .needs = PLM_NEEDS_SURFACE,
     .measure = plm_trait_leaf_alpha,
     .definition =
         "largest circumradius of the leaf surface's triangles (mean over the leaf where it follows the spacing)",
     .source = "Edelsbrunner, Kirkpatrick and Seidel 1983",
     .ontology = ""},
    {.name = "leaf_alpha_sensitivity",
     .level = PLM_LEAF,
     .unit = PLM_NUMBER,
     .needs = PLM_NEEDS_SURFACE,
     .measure = plm_trait_leaf_alpha_sensitivity,
     .definition = "d ln A / d ln alpha: relative change of the area per relative change of alpha",
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
