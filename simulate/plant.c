/* simulate/plant.c: the table of kinds, and growing a plant of one of them. */
#include <string.h>

#include "cloud/nearest_name.h"
#include "simulate/models.h"
#include "simulate/truth.h"

typedef struct kind_row {
    plm_plant_kind kind;
    void (*grow)(plm_builder *builder);
} kind_row;

static const kind_row table[] = {
    {{"eggplant", "seedling of 8 to 16 cm, two cotyledons, 2 to 5 ovate leaves"}, plm_grow_eggplant},
    {{"pepper", "seedling of 9 to 19 cm, 3 to 8 pointed leaves"}, plm_grow_pepper},
    {{"okra", "seedling of 10 to 20 cm, 2 to 5 lobed leaves"}, plm_grow_okra},
    {{"cucumber", "seedling of 8 to 19 cm, large cotyledons, 2 to 6 heart-shaped leaves"}, plm_grow_cucumber},
    {{"tomato", "young plant of 0.3 to 0.7 m, 6 to 10 compound leaves"}, plm_grow_tomato},
    {{"soybean", "plant of 0.2 to 0.5 m, trifoliate leaves"}, plm_grow_soybean},
    {{"maize", "plant of 0.4 to 1.2 m, 6 to 10 strap leaves"}, plm_grow_maize},
    {{"arabidopsis", "rosette of 6 to 14 leaves"}, plm_grow_arabidopsis},
    {{"lettuce", "head of 10 to 20 leaves"}, plm_grow_lettuce},
    {{"single_leaf", "one blade"}, plm_grow_single_leaf},
    {{"bare_stem", "a stem, with or without branches"}, plm_grow_bare_stem},
    {{"tomato_large", "laser-scanning paper: 21 internodes, 1.7 m, two trusses"}, plm_grow_tomato_large},
    {{"cucumber_large", "laser-scanning paper: 17 leaves, 2.0 m"}, plm_grow_cucumber_large},
    {{"maize_large", "laser-scanning paper: 14 leaves, 2.5 m"}, plm_grow_maize_large},
    {{"arabidopsis_large", "laser-scanning paper: rosette of 10 leaves, radius 6 cm"}, plm_grow_arabidopsis_large},
};

enum { KINDS = sizeof table / sizeof *table };

const plm_plant_kind *plm_plant_kind_at(size_t index)
{
    return index < KINDS ? &table[index].kind : NULL;
}

static const char *kind_name(const void *rows, size_t k)
{
    return ((const kind_row *)rows)[k].kind.name;
}

static plm_status unknown_kind(const char *kind, plm_error *error)
{
    const char *nearest = plm_nearest_name(kind, kind_name, table, KINDS);
    return plm_fail(error, PLM_E_ARGUMENT, "unknown kind of plant \"%.40s\"%s%s%s", kind,
                    nearest ? "; did you mean " : "", nearest ? nearest : "", nearest ? "?" : "");
}

plm_status plm_plant_grow(const char *kind, const plm_plant_options *options, plm_virtual_plant *plant,
                          plm_error *error)
{
    plm_plant_options filled = *options;
    plm_virtual_plant made;
    plm_builder builder;
    size_t row = 0;
    while (row < KINDS && strcmp(table[row].kind.name, kind) != 0) row++;
    if (row == KINDS) return unknown_kind(kind, error);
    if (filled.resolution == 0) filled.resolution = 1;
    if (!(filled.resolution >= 0.02 && filled.resolution <= 8))
        return plm_fail(error, PLM_E_ARGUMENT, "resolution %g; 0.02 to 8 was expected", filled.resolution);
    plm_builder_start(&builder, kind, &filled, &made, error);
    table[row].grow(&builder);
    if (builder.status == PLM_OK) builder.status = plm_truth_from_faces(&made, error);
    const plm_status status = plm_builder_finish(&builder);
    if (status == PLM_OK) *plant = made;
    return status;
}

void plm_virtual_plant_free(plm_virtual_plant *plant)
{
    if (!plant) return;
    plm_mesh_free(&plant->mesh);
    plm_free(plant->face_label);
    plm_free(plant->face_leaflet);
    plm_free(plant->vertex_rim);
    plm_free(plant->vertex_radius);
    plm_free(plant->stem);
    plm_free(plant->petiole);
    plm_free(plant->leaf);
    plm_free(plant->leaflet);
    *plant = (plm_virtual_plant){0};
}
