/* tool/command_light.c: the `light` sub-command: absorbed light of meshes, and of the plants of a run of `measure`. */
#include "tool/command.h"
#include "tool/light_run.h"

#include <omp.h>
#include <stdio.h>
#include <string.h>

#define AT(field) .offset = offsetof(light_settings, field)

static const plm_option options[] = {
    {.letter = 'o',
     .name = "output",
     .argument = "DIR",
     .help = "write here (required)",
     .kind = PLM_OPTION_TEXT,
     AT(output)},
    {.name = "rays",
     .argument = "N",
     .help = "sent out by all sources together (default: 10000000)",
     .kind = PLM_OPTION_INTEGER,
     AT(rays),
     .minimum = 100,
     .maximum = 1000000000},
    {.name = "sources",
     .argument = "N",
     .help = "directions on the sky's hemisphere, in circles of twelve (default: 72)",
     .kind = PLM_OPTION_INTEGER,
     AT(sources),
     .minimum = 12,
     .maximum = 12000},
    {.name = "reflectance",
     .argument = "R[,G,B]",
     .help =
         "share of light that a face sends back, diffusely; one number for all bands, or red, green and blue (default: "
         "0,0.9,0: a leaf of pure green)",
     .kind = PLM_OPTION_TEXT,
     AT(reflectance)},
    {.name = "transmittance",
     .argument = "T[,G,B]",
     .help = "share that a face lets through, diffusely (default: 0.1)",
     .kind = PLM_OPTION_TEXT,
     AT(transmittance)},
    {.name = "power",
     .argument = "W",
     .help = "of all sources together, sent evenly at the sphere about the mesh (default: 1000)",
     .kind = PLM_OPTION_NUMBER,
     AT(power),
     .minimum = 0,
     .maximum = 1e12},
    {.name = "irradiance",
     .argument = "W_PER_M2",
     .help =
         "instead of --power: what all sources together bring to a square metre, each across its own direction; plants "
         "of different size can then be compared",
     .kind = PLM_OPTION_NUMBER,
     AT(irradiance),
     .minimum = 1e-12,
     .maximum = 1e9},
    {.name = "depth",
     .argument = "N",
     .help = "hits of one ray at most (default: 10)",
     .kind = PLM_OPTION_INTEGER,
     AT(depth),
     .minimum = 1,
     .maximum = 100},
    {.name = "unit",
     .argument = "m|cm|mm",
     .help = "of a MESH (default: m); a RUN knows its own",
     .kind = PLM_OPTION_CHOICE,
     AT(unit)},
    {.name = "up",
     .argument = "z|y|x|-z|-y|-x",
     .help = "axis of a MESH that points to the sky (default: z); a RUN knows its own",
     .kind = PLM_OPTION_CHOICE,
     AT(up)},
    {.name = "seed", .argument = "N", .help = "seed of the rays (default: 1)", .kind = PLM_OPTION_SEED, AT(seed)},
    {.name = "threads",
     .argument = "N",
     .help = "threads to use (default: all); the digits do not depend on it",
     .kind = PLM_OPTION_INTEGER,
     AT(threads),
     .minimum = 1,
     .maximum = 1024,
     .changes_nothing = true},
    {.letter = 'q',
     .name = "quiet",
     .help = "print nothing but errors",
     .kind = PLM_OPTION_FLAG,
     AT(is_quiet),
     .changes_nothing = true},
};

/* One number for all bands, or three. */
static bool parse_bands(const char *text, double band[PLM_LIGHT_BANDS])
{
    char copy[128];
    int count = 0;
    if (!text) return true;
    if (snprintf(copy, sizeof copy, "%s", text) >= (int)sizeof copy) return false;
    for (char *at = copy; at;) {
        char *comma = strchr(at, ',');
        if (comma) *comma = 0;
        if (count == PLM_LIGHT_BANDS || !plm_parse_number(at, &band[count++])) return false;
        at = comma ? comma + 1 : NULL;
    }
    if (count == 1)
        for (int b = 1; b < PLM_LIGHT_BANDS; b++) band[b] = band[0];
    return count == 1 || count == PLM_LIGHT_BANDS;
}

/* Usage that the parser cannot judge; gives the exit code, or -1. */
static int check(light_settings *settings)
{
    plm_light_options *light = &settings->light;
    plm_light_defaults(light);
    light->seed = settings->seed;
    light->rays = (uint64_t)settings->rays;
    light->around = 12;
    light->circles = settings->sources / 12;
    light->power = settings->power;
    light->irradiance = settings->irradiance;
    light->depth = settings->depth;
    if (!settings->output) return plm_usage_error(&plm_command_light, "--output is missing");
    if (settings->sources % 12)
        return plm_usage_error(&plm_command_light, "--sources %d: a multiple of 12 was expected", settings->sources);
    if (!parse_bands(settings->reflectance, light->reflectance))
        return plm_usage_error(&plm_command_light, "--reflectance: \"%s\"; one number or three were expected",
                               settings->reflectance);
    if (!parse_bands(settings->transmittance, light->transmittance))
        return plm_usage_error(&plm_command_light, "--transmittance: \"%s\"; one number or three were expected",
                               settings->transmittance);
    for (int b = 0; b < PLM_LIGHT_BANDS; b++)
        if (!(light->reflectance[b] >= 0 && light->transmittance[b] >= 0 &&
              light->reflectance[b] + light->transmittance[b] <= 1 + 1e-12))
            return plm_usage_error(
                &plm_command_light,
                "reflectance %g and transmittance %g: each must be 0 or more, both together at most 1",
                light->reflectance[b], light->transmittance[b]);
    return -1;
}

static int run(int argc, char **argv)
{
    light_settings settings = {.rays = 10000000, .sources = 72, .power = 1000, .depth = 10, .seed = 1};
    int code = plm_parse_options(&plm_command_light, &argc, argv, &settings);
    if (code >= 0) return code;
    if (argc < 1) return plm_usage_error(&plm_command_light, "which MESH, or which RUN of measure?");
    code = check(&settings);
    if (code >= 0) return code;
    if (settings.threads) omp_set_num_threads(settings.threads);
    return light_run(&settings, argv, (size_t)argc);
}

const plm_command plm_command_light = {
    .name = "light",
    .arguments = "[OPTION]... -o DIR MESH|RUN...",
    .summary = "absorbed light of each face and organ of a mesh",
    .description =
        "MESH is a PLY or OBJ of triangles or polygons, such as PLANT.mesh.ply of `simulate`; RUN is a folder that "
        "`measure -o` wrote: each of its plants is lit by its leaf surfaces, turned upright and in metres. Rays from "
        "sources "
        "on the sky are followed through diffuse reflection and transmission.\n\n"
        "DIR gets PLANT.light.ply of each (absorbed_w and absorbed_w_m2 of every face, and colours by them), light.csv "
        "(a row "
        "for each plant and each organ, with the standard error) and light.json (power sent out, absorbed and escaped, "
        "which "
        "add up; rays; seconds).\n\n"
        "The same seed gives the same digits on any number of threads.",
    .options = options,
    .option_count = COUNT(options),
    .run = run};
