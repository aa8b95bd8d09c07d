/* segment/ground_scene.c: what makes soil, pot and table different from leaves. A pot has a wall all around, is opaque,
 * is closed near its rim, has the plant above and nothing but a table below. Soil or table without a pot is one level
 * that is flatter and larger than any leaf, has the plant above it, on its inside, and nothing below. Colour only moves
 * the bounds: a level as green as the plant must be flatter and larger. */
#include "segment/ground_scene.h"

#include <math.h>
#include <string.h>

#include "cloud/linear.h"

/* Radius of a pot over the size of all that was looked at, and height over radius: where it is slimmer and longer, it may be a stem. (Of
 * heads 0.045 and 0.08; no pot of 44, virtual or real, is as long and without soil.) */
static const double SLIM = 0.085, LONG = 2.3;
/* Patches below a pot, over all: a floor's rest below one that is seen all around, next to none (strays) below a wall that is hardly
 * seen. A level leaf whose rim hangs down makes such a wall (coverage 0.58), with 0.036 below it, of its stem; 0.0007 at most below
 * 20 pots, seen from 0.95 of all directions and more. */
static const double BELOW = 0.1, BELOW_LEAST = 0.01, POT_COVERAGE = 0.55;
/* Radii of the pot within which patches are its own: a wide table about it is no reason for a larger plant. */
static const double ABOUT = 1.1;
/* Of its own patches, those above a pot at least; fewer where it is closed and seen all around, as what bears a small
 * rosette is (of 216 virtual plants without a pot, heads among them, none comes this far). Such a rosette may stand no higher than
 * the rim: what is above the soil within so many radii counts there. */
static const double ABOVE = 0.01, ABOVE_SURE = 0.003, SURE_COVERAGE = 0.9, SURE_LID = 0.5, WITHIN = 0.8;

/* ---- Colour --------------------------------------------------------------------------------------------------- */

/* Excess green over brightness (Woebbecke et al. 1995): 0 for grey, 0.2 to 0.6 for leaves. */
static double greenness(const float colour[3])
{
    const double sum = (double)colour[0] + colour[1] + colour[2];
    return sum > 0 ? (2 * (double)colour[1] - colour[0] - colour[2]) / sum : 0;
}

/* +1: the level is not green and what is above it is; -1: no such difference although there is colour; 0: no colour. */
static int colour_speaks(const plm_stand *t, const plm_level *level)
{
    if (!t->surfels->colour) return 0;
    const double cell = t->surfels->cell;
    double sum[2] = {0}, n[2] = {0};
    for (size_t k = 0; k < t->surfels->count; k++) {
        const double off = t->place[k][2] - plm_level_height(level, t->place[k][0], t->place[k][1]);
        const int part = off > 3 * cell ? 1 : fabs(off) < cell && t->upright[k] > 0.8 ? 0 : -1;
        if (part < 0) continue;
        sum[part] += greenness(t->surfels->colour[k]);
        n[part]++;
    }
    if (!(n[0] > 0 && n[1] > 0)) return 0;
    return sum[1] / n[1] - sum[0] / n[0] > 0.12 ? 1 : -1;
}

/* ---- Soil or table without a pot ------------------------------------------------------------------------------ */

typedef struct level_facts {
    double below;  /* share of all patches that are clearly below the plane and not under its outline */
    double under;  /* share below the plane, under its outline */
    double above;  /* share clearly above */
    double height; /* of what is above, over the level's size */
    double inward; /* of the patches just above the level, the share well inside of its outline; 1 for none */
    double over;   /* of the patches above, the share over its outline */
    double reach;  /* the level's size over the horizontal size of all patches */
} level_facts;

static level_facts facts_of(const plm_stand *t, const plm_level *level)
{
    const double cell = t->surfels->cell, slack = fmax(3 * cell, 4 * level->scatter);
    const double all = (double)t->surfels->count;
    level_facts f = {0};
    double touch = 0, inner = 0, top = 0;
    float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t k = 0; k < t->surfels->count; k++) {
        const float *p = t->place[k];
        const double off = p[2] - plm_level_height(level, p[0], p[1]);
        const double du = p[0] - level->centre[0], dv = p[1] - level->centre[1];
        const double out = hypot(du, dv) / fmax(plm_level_reach(level, du, dv), cell);
        for (int i = 0; i < 2; i++) {
            low[i] = fminf(low[i], p[i]);
            high[i] = fmaxf(high[i], p[i]);
        }
        if (off < -slack) {
            if (out > 1.05)
                f.below += 1 / all;
            else
                f.under += 1 / all;
        } else if (off > slack) {
            f.above += 1 / all;
            f.over += out < 1;
            top = fmax(top, off);
            if (off < 2 * slack && out < 1.1) inner += out < 0.75, touch++;
        }
    }
    f.height = top / sqrt(level->area);
    if (f.above > 0) f.over /= f.above * all;
    f.inward = touch > 0 ? inner / touch : 1;
    f.reach = sqrt(level->area / fmax(((double)high[0] - low[0]) * ((double)high[1] - low[1]), cell * cell));
    return f;
}

/* Thick noise shows as two levels, one a little over the other. */
static bool same_surface(const plm_stand *t, const plm_level *a, const plm_level *b)
{
    const double off =
        plm_level_height(b, b->centre[0], b->centre[1]) - plm_level_height(a, b->centre[0], b->centre[1]);
    const double du = b->centre[0] - a->centre[0], dv = b->centre[1] - a->centre[1];
    return fabs(off) < fmax(3 * t->surfels->cell, 6 * a->scatter) && hypot(du, dv) < 0.5 * plm_level_reach(a, du, dv);
}

/* Is the level ground, although no pot was found? Gives a confidence, 0 for no. Bounds were set between what
 * leaves and what soils and tables show (over 90 clouds without and 60 with ground): leaves are rougher than 1.6 % of
 * their size unless small, and their normals agree to 0.96 to 0.98 unless they are flat. */
static double plain_ground(const plm_stand *t, const plm_level level[], int levels, int i)
{
    const plm_level *it = &level[i];
    const int colour = colour_speaks(t, it);
    const level_facts f = facts_of(t, it);
    double largest_other = 0;
    for (int j = 0; j < levels; j++)
        if (j != i && !same_surface(t, it, &level[j])) largest_other = fmax(largest_other, level[j].area);
    /* The young leaves at a flat rosette's middle are greener than the others, between which there are gaps. */
    const bool has_gaps = it->area < 0.85 * it->hull_area;
    const double rough = it->scatter / sqrt(it->area), ease = colour > 0 && !has_gaps ? 1.5 : 1;
    if (sqrt(it->area) < 12 * t->surfels->cell) return 0;
    /* Where the normals agree well the roughness is noise, not shape. */
    if (rough > (it->agreement > 0.99 ? 0.05 : colour < 0 ? 0.02 : 0.025 * ease)) return 0;
    if (it->agreement < (colour > 0 ? 0.95 : 0.962)) return 0;
    if (it->area < (colour > 0 ? 1.5 : colour < 0 ? 4 : 3) * largest_other) return 0;
    if (f.below > 0.03 * ease || f.under > 0.10 * ease) return 0;
    /* Floaters lie on both sides of a single leaf. */
    if (f.above < 3 * f.below) return 0;
    if (f.above < 0.01 || f.height < 0.05 || f.inward < 0.3 || f.over < 0.2) return 0;
    /* The lowest leaf of a head: rough, and most of the plant is not over it, as a plant is over its soil. */
    if (f.over < 0.65 && it->agreement < 0.985 && rough > 0.011) return 0;
    if (f.reach < (colour > 0 ? 0.2 : 0.3) || it->area < 0.5 * it->hull_area) return 0;
    return fmin(1, 0.5 + 0.25 * (colour > 0) + 0.25 * (rough < 0.01) + 0.25 * (f.reach > 0.5));
}

/* ---- Pot and table -------------------------------------------------------------------------------------------- */

static bool near_level(const plm_ground_scene *s, const float p[3])
{
    for (int i = 0; i < s->levels; i++)
        if (fabs(p[2] - plm_level_height(&s->level[i], p[0], p[1])) < 3 * s->stand.surfels->cell) return true;
    return false;
}

/* Does the wall belong to a pot? Gives a confidence, 0 for no. */
static double accept_pot(const plm_ground_scene *s)
{
    const plm_pot *pot = &s->pot;
    const plm_stand *t = &s->stand;
    const double cell = t->surfels->cell, top = pot->radius[pot->rows - 1], all = (double)t->surfels->count;
    /* A small ring is soon filled by leaves: it must be more complete, and even. */
    const double small = fmin(fmax((12 - top / cell) / 6, 0), 1);
    if (pot->coverage < POT_COVERAGE + 0.25 * small || pot->scatter > 0.06 * top + 0.5 * cell) return 0;
    if (pot->lid < 0.15 && (pot->coverage < 0.85 || pot->scatter > 0.05 * top + 0.3 * cell)) return 0;
    const bool is_sure = pot->coverage > SURE_COVERAGE && pot->lid > SURE_LID;
    double above = 0, below = 0, own = 0, high = pot->rim;
    for (size_t k = 0; k < t->surfels->count; k++) {
        const double p[3] = {t->place[k][0], t->place[k][1], t->place[k][2]};
        high = fmax(high, p[2]);
        const bool is_within = is_sure && plm_pot_distance(pot, p) < WITHIN * plm_pot_radius(pot, p[2]);
        above += p[2] > (is_within ? pot->soil : fmax(pot->rim, pot->soil)) + 3 * cell;
        own += p[2] > pot->rim || plm_pot_distance(pot, p) < ABOUT * plm_pot_radius(pot, p[2]);
        below += p[2] < pot->foot - 4 * cell && !near_level(s, t->place[k]);
    }
    /* The stem under a head is as round; no soil closes it. */
    const double size[3] = {t->size[0] * t->cell, t->size[1] * t->cell, high - pot->foot};
    if (top < SLIM * plm_norm(size) && pot->rim - pot->foot > LONG * top && pot->lid < 0.15) return 0;
    const double rest = fmax(BELOW * (pot->coverage - POT_COVERAGE) / (1 - POT_COVERAGE), BELOW_LEAST);
    if (above < fmax(20, (is_sure ? ABOVE_SURE : ABOVE) * own) || below > rest * all) return 0;
    return fmin(1, pot->coverage * (0.6 + fmin(0.4, pot->lid)));
}

/* The level around the pot's foot, if any. */
static int find_table(const plm_ground_scene *s)
{
    const plm_pot *pot = &s->pot;
    const double cell = s->stand.surfels->cell, height = pot->rim - pot->foot, width = pot->radius[0];
    int best = -1;
    for (int i = 0; i < s->levels; i++) {
        const plm_level *it = &s->level[i];
        const double off = plm_level_height(it, pot->centre[0], pot->centre[1]) - pot->foot;
        if (off < -fmax(4 * cell, 0.2 * height) || off > fmax(3 * cell, 0.25 * height)) continue;
        double outside = 0;
        for (int d = 0; d < PLM_OUTLINE; d++) {
            const double r = it->radius[d];
            outside += fmax(0, r * r - 1.05 * width * width) * PLM_PI / PLM_OUTLINE;
        }
        if (outside < 0.2 * width * width || it->agreement < 0.95) continue;
        if (best < 0 || it->area > s->level[best].area) best = i;
    }
    return best;
}

/* The level inside of the pot, if any. */
static int find_soil(const plm_ground_scene *s)
{
    const plm_pot *pot = &s->pot;
    const double cell = s->stand.surfels->cell, top = pot->radius[pot->rows - 1];
    int best = -1;
    for (int i = 0; i < s->levels && pot->soil_seen; i++) {
        const plm_level *it = &s->level[i];
        const double h = pot->soil - pot->foot;
        const double u = pot->centre[0] + pot->slant[0] * h, v = pot->centre[1] + pot->slant[1] * h;
        if (fabs(plm_level_height(it, u, v) - pot->soil) > fmax(2 * cell, 0.08 * top)) continue;
        if (hypot(it->centre[0] - u, it->centre[1] - v) > 0.5 * top) continue;
        if (best < 0 || it->area > s->level[best].area) best = i;
    }
    return best;
}

static plm_status look_along(const plm_surfels *surfels, const double up[3], plm_ground_scene *s, plm_error *error)
{
    *s = (plm_ground_scene){.soil = -1, .table = -1};
    plm_status status = plm_stand_make(surfels, up, &s->stand, error);
    if (status == PLM_OK) status = plm_find_levels(&s->stand, s->level, &s->levels, error);
    if (status == PLM_OK) status = plm_find_pot(&s->stand, s->level, s->levels, &s->has_pot, &s->pot, error);
    if (status != PLM_OK) return status;
    if (s->has_pot) s->confidence = accept_pot(s);
    s->has_pot = s->confidence > 0;
    if (s->has_pot) {
        s->table = find_table(s);
        s->soil = find_soil(s);
    } else {
        for (int i = 0; i < s->levels && s->soil < 0; i++) {
            s->confidence = plain_ground(&s->stand, s->level, s->levels, i);
            if (s->confidence > 0) s->soil = i;
        }
    }
    return PLM_OK;
}

plm_status plm_ground_look(const plm_surfels *surfels, const double up[3], plm_ground_scene *scene, plm_error *error)
{
    double direction[3];
    (void)plm_find_tilt(surfels, up, direction);
    plm_ground_scene s;
    plm_status status = look_along(surfels, direction, &s, error);
    /* Leaves may have said the tilt: the axis of a pot knows better. */
    if (status == PLM_OK && s.has_pot && hypot(s.pot.slant[0], s.pot.slant[1]) > 0.03) {
        for (int i = 0; i < 3; i++)
            direction[i] = s.stand.rotation[2][i] + s.pot.slant[0] * s.stand.rotation[0][i] +
                           s.pot.slant[1] * s.stand.rotation[1][i];
        plm_normalise(direction);
        plm_ground_scene again;
        status = look_along(surfels, direction, &again, error);
        if (status == PLM_OK && again.confidence >= 0.9 * s.confidence) {
            plm_ground_scene_free(&s);
            s = again;
        } else {
            plm_ground_scene_free(&again);
        }
    }
    if (status == PLM_OK)
        *scene = s;
    else
        plm_ground_scene_free(&s);
    return status;
}

void plm_ground_scene_free(plm_ground_scene *scene)
{
    plm_stand_free(&scene->stand);
    plm_levels_free(scene->level, scene->levels);
    *scene = (plm_ground_scene){.soil = -1, .table = -1};
}
