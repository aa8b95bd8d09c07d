/* segment/ground_colour.c: does colour tell plant from ground in this cloud, and which colours are the plant's? Counts in
 * a cube of colours in steps of 16, learned from what shape has told apart. Nothing is known of leaves or pots beforehand: white
 * pots, red leaves and grey clouds are all judged by themselves. */
#include <math.h>
#include <string.h>

#include "segment/ground_mark.h"

static const double most_mixed = 0.1; /* share of points that would be taken for the other kind */
static const float BESIDE = 0.1f;     /* of a colour's points that might have been seen in each colour beside it */
static const double SUPPOSED = 200;   /* points that are as if they had been seen in colours beside the seen ones */
static const double CLEAR = 2;        /* of a surface's slack: so far off it few points of the surface are */
static const double ENOUGH = 0.1; /* share of what is no ground that is clear of it: less would leave a low plant out */

/* Makes shares of counts by colour. What few points leave open the neighbouring colours tell: as much as SUPPOSED points do. */
static void spread(float count[PLM_COLOURS])
{
    static const int stride[3] = {PLM_SHADES * PLM_SHADES, PLM_SHADES, 1};
    float smooth[PLM_COLOURS] = {0};
    double sum = 0, all = 0;
    for (int c = 0; c < PLM_COLOURS; c++) {
        smooth[c] += count[c];
        for (int axis = 0; axis < 3; axis++) {
            const int at = c / stride[axis] % PLM_SHADES;
            if (at > 0) smooth[c - stride[axis]] += BESIDE * count[c];
            if (at + 1 < PLM_SHADES) smooth[c + stride[axis]] += BESIDE * count[c];
        }
    }
    for (int c = 0; c < PLM_COLOURS; c++) sum += smooth[c], all += count[c];
    for (int c = 0; c < PLM_COLOURS; c++)
        count[c] = sum > 0 ? (float)((count[c] + SUPPOSED * smooth[c] / sum) / (all + SUPPOSED)) : 0;
}

/* Does a point that is no ground teach the plant's colours? The tail of a dense ground's noise may be more than all of the plant. */
static bool is_clear(const plm_marker *m, size_t i)
{
    if (m->over[i] < CLEAR * m->soil_slack) return false;
    const double p[3] = {m->place[i][0], m->place[i][1], m->place[i][2]};
    return !plm_at_table(m, CLEAR * m->table_slack, p);
}

/* Is a point that is ground above the soil, at the rim, where leaves that hang over it may be among the wall's points? */
static bool is_at_rim(const plm_marker *m, size_t i)
{
    return isfinite(m->over[i]) && m->over[i] > m->soil_slack;
}

bool plm_ground_colours(const plm_marker *m, float plant_share[PLM_COLOURS])
{
    float plant[PLM_COLOURS] = {0}, low[PLM_COLOURS] = {0}, ground[PLM_COLOURS] = {0}, rim[PLM_COLOURS] = {0};
    double mixed = 0, clear = 0, rest = 0, all = 0;
    for (size_t i = 0; i < m->cloud->count; i++) {
        const int shade = plm_shade(m->cloud->rgb[i]);
        if (m->zone[i] != PLM_ZONE_FREE)
            is_at_rim(m, i) ? rim[shade]++ : ground[shade]++;
        else if (is_clear(m, i))
            plant[shade]++, clear++;
        else
            low[shade]++, rest++;
    }
    if (clear < ENOUGH * (clear + rest))
        for (int c = 0; c < PLM_COLOURS; c++) plant[c] += low[c];
    /* A rim may have colours of its own; those of leaves over it are more elsewhere. */
    for (int c = 0; c < PLM_COLOURS; c++) {
        if (rim[c] > plant[c]) ground[c] += rim[c];
        all += ground[c];
    }
    if (!(clear + rest > 0 && all > 0)) return false;
    spread(plant);
    spread(ground);
    for (int c = 0; c < PLM_COLOURS; c++) {
        mixed += 0.5 * (double)fminf(plant[c], ground[c]);
        const float sum = plant[c] + ground[c];
        plant_share[c] = sum > 0 ? plant[c] / sum : 0.5f;
    }
    return mixed < most_mixed;
}
