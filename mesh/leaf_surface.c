/* mesh/leaf_surface.c: the one-sided surface of a leaf, its area and plane, and how far they can be trusted.
 *
 * The points are cut into parts and charts (leaf_points.c, leaf_charts.c); each chart's heights are smoothed
 * (leaf_sheet.c), its points triangulated in its plane and trimmed with a local alpha (leaf_patch.c, leaf_trim.c). The
 * sum of the triangles lacks what the sampling leaves at the rim, and has what noise along the surface adds there: both
 * are proportional to the length of the rim. The density of points gives a second area (leaf_density.c),
 * the better one the more noise there is between the points. */
#include "mesh/mesh.h"

#include "cloud/linear.h"
#include "cloud/sampling.h"
#include "cloud/voxel_pitch.h"
#include "mesh/leaf_density.h"
#include "mesh/leaf_mesh.h"
#include "mesh/leaf_trim.h"

#include <math.h>
#include <string.h>

enum {
    MOST_POINTS = 30000, /* more add no structure, only time */
    FEWEST_TRUSTED = 300 /* points of a leaf without PLM_SURFACE_LOW_DENSITY */
};

/* Circumradius up to which a triangle is leaf, in local spacings: random points exceed it once in a million. */
static const double alpha_factor = 2.3;
static const double alpha_step = 1.1;   /* for the sensitivity */
static const double largest_hole = 0.1; /* share of the leaf's area up to which a hole is filled */

/* Rim of the trimmed triangles against the true one, in spacings: inset by sampling (simulated discs with random points:
 * 0.40), outset by noise x = SD along the surface / spacing. */
static const double rim_inset = 0.41, rim_outset = 1.1, rim_bend = 0.37;
/* SD along the surface per SD across it: between 0.3 (along the normal only) and 1 (alike in all directions). */
static const double noise_along = 0.8;
/* Voxel means without those that lie apart: a voxel hit by one stray pixel counts as much as one hit by fifty, which nearly
 * makes up for the inset. Between the two families of virtual depth cameras it was measured on (0 and -0.7 in noise). */
static const double fused_inset = 0.10, fused_outset = 0.30, fused_outset_density = 0.62;
/* Where the voxels are known, how many pixels they have is known too, from how strongly the points gather about their middles
 * (cloud/voxel_pitch.h): the more there are, the farther out one of them makes a voxel at the rim. Outset in voxels = inset +
 * slope x gathering, of the half-density area and of the one above; from virtual plants of six kinds with true labels, in images
 * of 960 to 2800 columns. The half-density area has no interior to be read in where the leaf is a few voxels wide. */
static const double pixel_inset = 0.48, pixel_outset_density = 1.55, pixel_outset = 1.19;
/* Rim x voxel / area up to which the density alone counts, and from which it counts no more; from there on the correction fades to
 * where a leaf is so narrow that its few points do not tell how they gather. */
static const double density_wide = 0.3, density_narrow = 0.6, too_narrow = 1.2;
/* Noise over spacing up to which the triangles alone tell the area, at which both tell it alike, and from which the density alone does:
 * it needs no guess of the noise along the surface, but that the density is the same up to the rim. (Mean errors with true labels, before
 * and after, six kinds as splats: 0.85 and 0.76 % at 0.5, 1.35 and 1.09 at 1.1, 1.9 and 0.84 at 1.7, 5.6 and 3.4 at 2.2; 7.5 and 4.3
 * at 1.4 where noise is alike in all directions.) */
static const double noise_low = 0.3, noise_even = 1.2, noise_high = 2.4;
/* The centres of fitted discs stay inside the rim by about their own radius. */
static const double disc_inset = 1.0;
/* What is unsure in an area and in a plane: shares of what may be wrong, so that of all leaves 0.95 lie within 1.96 standard errors,
 * those whose labels are a little off as well. Likeliest under errors of Student's t with 4 degrees of freedom (2100 leaves of virtual
 * plants of eight kinds, clean, from depth cameras and as splats, and the development clouds with six times the weight), rounded up. */
/* The rim's place in spacings and in SD of the noise; noise over the leaf's width, squared: a narrow leaf has no inside. */
static const double rim_known = 0.05, rim_noise = 0.13, fused_known = 0.12, fused_noise = 0.03;
static const double narrow_unsure = 1.2, narrow_unsure_fused = 0.4;
static const double disc_unsure = 0.125, hole_unsure = 1, seam_unsure = 0.0006;
/* Relative step of alpha by which the area is let vary: alpha is chosen, not known. */
static const double alpha_unsure = 0.18;
/* Share of what the two areas are apart. */
static const double second_unsure = 0.25, second_unsure_fused = 0.75;

/* What all patches add up to. */
typedef struct surface_work {
    plm_leaf_points points;
    plm_leaf_draft draft;
    plm_trim_sums sums, tighter, looser; /* at alpha, and a step to either side of it */
    plm_density_areas density;
    double noise;
    double across[3];    /* sum over points of the squared components of their chart's normal */
    double layers;       /* sum over points of the half distance of layers, squared */
    double gathering[3]; /* about the voxels' middles, where these are known */
    bool fused, has_voxels;
    size_t chart_count;
} surface_work;

/* ---- One chart after another ----------------------------------------------------------------------------------- */

/* Trims at alpha, and a step to either side of it for the sensitivity; state is left as alpha has it. */
static plm_status trim_patch(double radius, plm_leaf_patch *patch, surface_work *work, plm_error *error)
{
    plm_trim trim = {alpha_factor / alpha_step, radius / alpha_step, largest_hole};
    plm_status status = plm_leaf_trim(patch, &trim, patch->state, &work->tighter, error);
    trim = (plm_trim){alpha_factor * alpha_step, radius * alpha_step, largest_hole};
    if (status == PLM_OK) status = plm_leaf_trim(patch, &trim, patch->state, &work->looser, error);
    trim = (plm_trim){alpha_factor, radius, largest_hole};
    if (status == PLM_OK) status = plm_leaf_trim(patch, &trim, patch->state, &work->sums, error);
    return status;
}

static plm_status add_chart(const uint32_t *row, size_t count, const plm_leaf_charts *charts, size_t chart,
                            double radius, surface_work *work, plm_error *error)
{
    plm_leaf_patch patch = {0};
    plm_status status = plm_leaf_patch_make(&work->points, row, count, charts, chart, work->noise, &patch, error);
    if (status == PLM_OK) status = trim_patch(radius, &patch, work, error);
    if (status == PLM_OK) status = plm_leaf_density(&patch, patch.state, charts, &work->density, error);
    if (status == PLM_OK) status = plm_leaf_draft_add(&work->draft, &patch, patch.state, error);
    work->layers += (double)patch.member_count * patch.layers * patch.layers;
    for (int k = 0; k < 3; k++)
        work->across[k] += (double)patch.member_count * patch.chart.normal[k] * patch.chart.normal[k];
    plm_leaf_patch_free(&patch);
    return status;
}

static plm_status add_part(size_t part, uint32_t *row, double radius, surface_work *work, plm_error *error)
{
    size_t count = 0;
    for (size_t i = 0; i < work->points.count; i++)
        if (work->points.component[i] == part) row[count++] = (uint32_t)i;
    plm_leaf_charts charts = {0};
    const size_t first = work->draft.count;
    plm_status status = plm_leaf_charts_make(&work->points, row, count, work->noise, &charts, error);
    for (size_t k = 0; k < charts.count && status == PLM_OK; k++)
        status = add_chart(row, count, &charts, k, radius, work, error);
    if (status == PLM_OK && charts.count > 1) status = plm_leaf_draft_mend(&work->draft, first, error);
    work->chart_count += charts.count;
    plm_leaf_charts_free(&charts);
    return status;
}

static plm_status gather(const float (*xyz)[3], size_t count, const plm_surface_options *options, surface_work *work,
                         plm_error *error)
{
    plm_status status = plm_leaf_points_make(xyz, count, MOST_POINTS, options->fused, &work->points, error);
    if (status != PLM_OK) return status;
    const plm_leaf_points *points = &work->points;
    work->fused = options->fused < 0 ? points->fused : options->fused > 0;
    work->has_voxels = work->fused && options->voxel > 0;
    if (work->has_voxels) plm_voxel_gathering(xyz, count, options->voxel, work->gathering);
    work->noise = options->noise;
    if (options->noise < 0)
        status = plm_noise_measure(points->index, (const float(*)[3])points->xyz, points->count, &work->noise, error);
    if (status == PLM_OK) status = plm_leaf_draft_create(points->count, &work->draft, error);
    uint32_t *row = status == PLM_OK ? plm_alloc(points->count, sizeof *row, error) : NULL;
    if (status == PLM_OK && !row) status = PLM_E_MEMORY;
    for (size_t part = 0; part < points->component_count && status == PLM_OK; part++)
        status = add_part(part, row, options->alpha, work, error);
    plm_free(row);
    return status;
}

/* ---- What it measures -------------------------------------------------------------------------------------------- */

static double square(double x)
{
    return x * x;
}

/* How strongly the points gather about the voxels' middles along the leaf: across it noise and the sheet's place in the grid
 * decide. */
static double gathering_along(const surface_work *work)
{
    double sum = 0, weight = 0;
    for (int k = 0; k < 3; k++) {
        const double along = (double)work->points.count - work->across[k];
        sum += along * work->gathering[k];
        weight += along;
    }
    return weight > 0 ? sum / weight : 0;
}

/* 1 up to begin, 0 from end on. */
static double falling(double x, double begin, double end)
{
    return fmin(fmax((end - x) / (end - begin), 0), 1);
}

/* Area of voxel means; second: what the density says. */
static double fused_area(const surface_work *work, const plm_surface_options *options, double spacing, double *second)
{
    const plm_trim_sums *sums = &work->sums;
    const double noise = work->noise, rim = sums->boundary;
    const double area = sums->area + rim * (fused_inset * spacing - fused_outset * fmin(noise, spacing));
    *second = work->density.half - fused_outset_density * noise * rim;
    if (!work->has_voxels) return area;
    const double gathering = gathering_along(work), border = rim * options->voxel;
    *second = work->density.half + border * (pixel_inset - pixel_outset_density * gathering);
    const double narrow = border / sums->area, known = falling(narrow, density_narrow, too_narrow);
    const double first = area + known * border * (pixel_inset - pixel_outset * gathering);
    const double share = falling(narrow, density_wide, density_narrow);
    return share * *second + (1 - share) * first;
}

/* Area of points that are no voxel means; apart: out, how far what the density says is from what the triangles say; x: noise over
 * spacing. The centres of discs are sparse at the rim: their density says little. */
static double scattered_area(const surface_work *work, const plm_surface_options *options, double spacing, double x,
                             double *apart)
{
    const plm_trim_sums *sums = &work->sums;
    const double along = noise_along * x, outset = rim_outset * along * along / (1 + rim_bend * along);
    const double inset = spacing * (rim_inset - outset) + disc_inset * options->extent;
    const double first = sums->area + sums->boundary * inset;
    if (!(work->density.half > 0)) return first;
    *apart = work->density.half - first;
    if (options->extent > 0) return first;
    return first + *apart * (1 - 0.5 * (falling(x, noise_low, noise_even) + falling(x, noise_even, noise_high)));
}

/* The area and its standard error. What is unsure: where the rim is, holes that were filled, seams, alpha, and what the second
 * area says. */
static void measure_area(const surface_work *work, const plm_surface_options *options, plm_leaf_surface *out)
{
    const plm_trim_sums *sums = &work->sums;
    const double s = out->spacing, sigma = work->noise, rim = sums->boundary;
    /* Layers lie apart across the leaf, not along it. */
    const double layers = work->layers / (double)work->points.count;
    const double x = sqrt(fmax(sigma * sigma - layers, 0)) / s;
    double rim_error, apart = 0;
    if (work->fused) {
        double second;
        out->area = fused_area(work, options, s, &second);
        if (work->density.half > 0) apart = second - out->area;
        rim_error = rim * sqrt(square(fused_known * s) + square(fused_noise * sigma));
    } else {
        out->area = scattered_area(work, options, s, x, &apart);
        rim_error =
            rim * sqrt(square(rim_known * s) + square(rim_noise * sigma) + square(disc_unsure * options->extent));
    }
    const double blurred = square(rim * sigma) / sums->area;
    const double narrow = fmin((work->fused ? narrow_unsure_fused : narrow_unsure) * blurred, sums->area);
    const double holes = hole_unsure * (sums->hole_area + sums->gap_area);
    const double seams = sums->area * seam_unsure * sqrt((double)work->chart_count);
    const double alpha = alpha_unsure * out->alpha_sensitivity * sums->area;
    const double unsure = (work->fused ? second_unsure_fused : second_unsure) * apart;
    out->area_std_error =
        sqrt(square(rim_error) + square(narrow) + square(holes) + square(seams) + square(alpha) + square(unsure));
    out->boundary_length = rim;
    out->holes_filled = sums->hole_area;
}

/* Tilt against zenith of the best-fit plane of the density raster: a second opinion on the mesh's. */
static double density_tilt(const plm_density_areas *density)
{
    double moment[6], value[3], axis[3][3];
    for (int i = 0, k = 0; i < 3; i++)
        for (int j = i; j < 3; j++, k++)
            moment[k] = density->second[k] - density->first[i] * density->first[j] / density->half;
    plm_eigen3(moment, value, axis);
    return atan2(hypot(axis[2][0], axis[2][1]), fabs(axis[2][2]));
}

/* Standard error of the plane's direction: scatter of the points, views shifted against each other, what the second
 * raster says, how little a bent leaf determines a plane, one narrower than its noise, and a few points: they miss a rim as wide as
 * the spacing, unevenly, since few lie along it. */
static void measure_plane(const surface_work *work, plm_leaf_surface *out)
{
    const double width = sqrt(out->plane.eigenvalue[1]);
    const double flatness = out->plane.eigenvalue[2] / out->plane.eigenvalue[1];
    const double tilt = atan2(hypot(out->plane.normal[0], out->plane.normal[1]), fabs(out->plane.normal[2]));
    const double scatter = 1.3 * work->noise / (sqrt((double)work->points.count) * width);
    const double views = work->fused ? 0.02e-3 / width : 0;
    const double second = work->density.half > 0 ? 0.65 * (density_tilt(&work->density) - tilt) : 0;
    const double bend = plm_radians(0.09 * sqrt(fmax(flatness, 0)) / fmax(1 - flatness, 1e-3));
    const double rim = 8 * sqrt(fmax(flatness, 0)) * pow((double)work->points.count, -0.9);
    const double narrow = 0.25 * fmin(square(work->noise / width), 1); /* noise is as deep as the leaf is wide */
    const double least = plm_radians(0.006);
    out->plane_std_error = sqrt(square(scatter) + square(views) + square(second) + square(bend) + square(rim) +
                                square(narrow) + square(least));
    if (flatness > 0.2) out->flags |= PLM_SURFACE_CURVED;
}

/* Area-weighted mean and SD of the facets' inclinations. */
static void measure_facets(plm_leaf_surface *out)
{
    const plm_mesh *mesh = &out->mesh;
    double area = 0, mean = 0, squares = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double a[3], b[3], normal[3];
        for (int i = 0; i < 3; i++) {
            a[i] = mesh->vertex[mesh->triangle[t][1]][i] - mesh->vertex[mesh->triangle[t][0]][i];
            b[i] = mesh->vertex[mesh->triangle[t][2]][i] - mesh->vertex[mesh->triangle[t][0]][i];
        }
        plm_cross(a, b, normal);
        const double weight = plm_norm(normal);
        if (!(weight > 0)) continue;
        const double tilt = atan2(hypot(normal[0], normal[1]), fabs(normal[2]));
        area += weight; /* West's running mean and sum of squares */
        const double step = tilt - mean;
        mean += step * weight / area;
        squares += weight * step * (tilt - mean);
    }
    out->facet_inclination_mean = mean;
    out->facet_inclination_sd = area > 0 ? sqrt(squares / area) : 0;
}

static void raise_flags(const surface_work *work, size_t count, plm_leaf_surface *out)
{
    const plm_trim_sums *sums = &work->sums;
    if (count < FEWEST_TRUSTED) out->flags |= PLM_SURFACE_LOW_DENSITY;
    if (sums->hole_area + sums->gap_area > 0.02 * sums->area || sums->sparse_area > 0.05 * sums->area)
        out->flags |= PLM_SURFACE_OCCLUDED;
    if (fabs(out->alpha_sensitivity) > 0.1) out->flags |= PLM_SURFACE_ALPHA_SENSITIVE;
}

static plm_status finish(surface_work *work, size_t count, const plm_surface_options *options, plm_leaf_surface *out,
                         plm_error *error)
{
    out->noise = work->noise;
    out->component_count = work->points.component_count;
    out->chart_count = work->chart_count;
    if (!(work->sums.area > 0)) {
        if (options->alpha > 0)
            return plm_fail(error, PLM_E_DEGENERATE,
                            "no triangle has a circumradius below alpha = %g m; leave alpha "
                            "to be found, or make it larger",
                            options->alpha);
        return plm_fail(error, PLM_E_DEGENERATE, "the leaf's %zu points span no surface", count);
    }
    out->spacing = work->sums.spacing_area / work->sums.area;
    out->alpha = options->alpha > 0 ? options->alpha : alpha_factor * out->spacing;
    out->alpha_sensitivity =
        log(work->looser.area / fmax(work->tighter.area, 1e-3 * work->looser.area)) / (2 * log(alpha_step));
    measure_area(work, options, out);
    plm_status status =
        plm_leaf_draft_finish(&work->draft, out->area, 0.8 * out->spacing, &out->mesh, &out->area_mesh, error);
    if (status == PLM_OK) status = plm_mesh_plane(&out->mesh, &out->plane, error);
    if (status != PLM_OK) return status;
    measure_plane(work, out);
    measure_facets(out);
    raise_flags(work, count, out);
    return PLM_OK;
}

plm_status plm_leaf_surface_make(const float (*xyz)[3], size_t count, const plm_surface_options *options,
                                 plm_leaf_surface *surface, plm_error *error)
{
    surface_work work = {0};
    plm_leaf_surface made = {0};
    plm_status status = gather(xyz, count, options, &work, error);
    if (status == PLM_OK) status = finish(&work, count, options, &made, error);
    plm_leaf_draft_free(&work.draft);
    plm_leaf_points_free(&work.points);
    if (status == PLM_OK)
        *surface = made;
    else
        plm_leaf_surface_free(&made);
    return status;
}

void plm_leaf_surface_free(plm_leaf_surface *surface)
{
    if (!surface) return;
    plm_mesh_free(&surface->mesh);
    *surface = (plm_leaf_surface){0};
}
