/* traits/leaf_surfaces.c: what the traits of leaves ask of a surface. */
#include "traits/leaf_surfaces.h"

unsigned plm_surface_estimate_flags(const plm_leaf_surface *surface)
{
    static const struct {
        unsigned surface, estimate;
    } same[] = {
        {PLM_SURFACE_LOW_DENSITY, PLM_FLAG_LOW_DENSITY},
        {PLM_SURFACE_OCCLUDED, PLM_FLAG_OCCLUDED},
        {PLM_SURFACE_CURVED, PLM_FLAG_CURVED},
        {PLM_SURFACE_ALPHA_SENSITIVE, PLM_FLAG_ALPHA_SENSITIVE},
    };
    unsigned flags = 0;
    for (size_t i = 0; i < sizeof same / sizeof *same; i++)
        if (surface->flags & same[i].surface) flags |= same[i].estimate;
    return flags;
}

bool plm_leaf_has_surface(const plm_organ *leaf, plm_estimate *out)
{
    if (leaf->surface.mesh.triangle_count > 0) {
        out->flags |= plm_surface_estimate_flags(&leaf->surface);
        return true;
    }
    plm_trait_failed(out, "%s", leaf->surface_reason[0] ? leaf->surface_reason : "no surface was made");
    return false;
}
