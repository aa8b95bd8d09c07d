/* segment/blade_base.c: the border between a petiole and its blade at all points of the plant. The stages before find it on
 * the sketch, by widths of level sets, to a few steps; here the leaf about that place is flattened, the outline of its base
 * tells the border (base_outline.c), the petiole's line is taken up to there, and the outline is asked once more, now as the plant's
 * leaves have it (base_shares.c). A rosette's small blades are looked at by outlines as small as they are (look_at_small). */
#include "segment/blade_base.h"

#include "cloud/linear.h"
#include "segment/leaf_of.h"
#include "segment/scratch.h"
#include "segment/subset.h"

#include <math.h>
#include <string.h>

/* Lengths in R. */
static const double PIECE = 1.6;                         /* of the petiole before its end: gives its line there */
static const double REACH = 4.4;                         /* what of the leaf is flattened */
static const double PLANE = 1.8;                         /* blade so near gives its plane, ... */
static const double AHEAD = 0.1;                         /* ... from so far ahead */
static const double THICK = 0.9;                         /* off the plane */
static const double SIDE = 1.1;                          /* to either side of the petiole: what changes its label */
static const double MIDDLE_BACK = 2;                     /* petiole that gives its middle across */
static const double END = 0.98;                          /* quantile of the petiole's points that is its end */
static const double THINNEST = 0.25;                     /* radius of a petiole, in the stem's, at least */
static const double LEAST_TURN = 0.8, LEAST_LEVEL = 0.3; /* cosines: of lines before and after; of petiole and blade */
/* A rosette's thick tubes are its petioles: where the noise is more than half of their radius, their width is not known, and
 * outlines put the border farther off than the widths of level sets do (3 of 16 virtual splats, with 0.57 to 0.68 of it). */
static const double CLEAR_NOISE = 0.5;
/* In R: a rosette's blades have no lobes beside the petiole that put the first guess farther off. Farther moves go to the tip. */
static const double MOST_MOVE = 1;
/* Of a small blade's reach: what is farther gives its plane. And where it begins at the latest. */
static const double FAR_PART = 0.5, FARTHEST = 0.65;
/* Before a small blade, which has no lobes beside it, all within so many of its radii is petiole. */
static const double SMALL_STRIP = 3;
/* Of a small blade: blur, in its petiole's radii, at least (a tube is densest at its sides, and its middle is known to less than that), and
 * cosine of petiole and blade, at least (where it bends between them, heights have a course that no cubic follows). */
static const double SMALL_BLUR = 0.3, SMALL_LEVEL = 0.8;
/* In the edge of voxels whose means the points are: what edges are blurred by beside the noise across the blade. The noise of
 * depth cameras lies along their rays, which graze a blade more than they meet it, and views are a little off each other.
 * Junctions are right in the mean with it (131 petioles of 20 mm and more; without it 0.2 mm early, with 0.33 0.1 mm late).
 * Not of rosettes, whose petioles end 0.15 mm late as it is (48 virtual ones; 0.34 mm with 0.33). */
static const double PITCH_ALONG = 0.25;
enum { FEWEST_PETIOLE = 15, FEWEST_BLADE = 30, FEWEST_PIECE = 9, FEWEST_PLANE = 15, MOST_POINTS = 8000, ROUNDS = 2 };

typedef struct leaf_points {
    const float (*xyz)[3];
    const uint32_t *point; /* the leaf's points, ... */
    size_t count, petiole; /* ... those of its petiole first */
    bool is_rosettes;      /* small blades are looked at apart */
} leaf_points;

/* The petiole's line at its end, and the blade's plane beyond. */
typedef struct frame {
    double origin[3], along[3], across[3], off[3];
    double ahead[3], ahead_across[3]; /* the same two in the blade's plane */
    double middle;                    /* of the petiole, across */
    double radius;
} frame;

static void offset_from(const float xyz[3], const double origin[3], double out[3])
{
    for (int a = 0; a < 3; a++) out[a] = xyz[a] - origin[a];
}

/* Mean and principal axes of chosen points. */
static void principal(const leaf_points *leaf, const uint32_t *chosen, size_t count, double mean[3],
                      double vector[3][3])
{
    double moment[6] = {0}, value[3], d[3];
    memset(mean, 0, 3 * sizeof *mean);
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) mean[a] += leaf->xyz[chosen[i]][a] / (double)count;
    for (size_t i = 0; i < count; i++) {
        offset_from(leaf->xyz[chosen[i]], mean, d);
        for (int a = 0, m = 0; a < 3; a++)
            for (int c = a; c < 3; c++) moment[m++] += d[a] * d[c];
    }
    plm_eigen3(moment, value, vector);
}

static void turn_towards(double vector[3], const double direction[3])
{
    if (plm_dot(vector, direction) < 0)
        for (int a = 0; a < 3; a++) vector[a] = -vector[a];
}

/* Quantile END of the places along a direction. */
static double end_along(const leaf_points *leaf, const uint32_t *chosen, size_t count, const double origin[3],
                        const double direction[3], float *value)
{
    double d[3];
    for (size_t i = 0; i < count; i++) {
        offset_from(leaf->xyz[chosen[i]], origin, d);
        value[i] = (float)plm_dot(d, direction);
    }
    return plm_quantile(value, count, END);
}

/* The petiole's end, direction there and radius, by its labels. chosen and value: scratch. */
static bool first_line(const leaf_points *leaf, const plm_scale *scale, uint32_t *chosen, float *value, frame *f)
{
    double mean[3], blade[3], vector[3][3], d[3], piece_mean[3], towards[3];
    principal(leaf, leaf->point + leaf->petiole, leaf->count - leaf->petiole, blade, vector);
    principal(leaf, leaf->point, leaf->petiole, mean, vector);
    for (int a = 0; a < 3; a++) towards[a] = blade[a] - mean[a];
    turn_towards(vector[0], towards);
    double whole[3];
    memcpy(whole, vector[0], sizeof whole);
    const double from = end_along(leaf, leaf->point, leaf->petiole, mean, whole, value) - PIECE * scale->radius;
    size_t count = 0;
    for (size_t i = 0; i < leaf->petiole; i++) {
        offset_from(leaf->xyz[leaf->point[i]], mean, d);
        if (plm_dot(d, whole) > from) chosen[count++] = leaf->point[i];
    }
    if (count < FEWEST_PIECE) return false;
    principal(leaf, chosen, count, piece_mean, vector);
    turn_towards(vector[0], whole);
    memcpy(f->along, vector[0], sizeof f->along);
    const double end = end_along(leaf, chosen, count, piece_mean, f->along, value);
    double squares = 0;
    for (size_t i = 0; i < count; i++) {
        offset_from(leaf->xyz[chosen[i]], piece_mean, d);
        const double forward = plm_dot(d, f->along);
        squares += (plm_dot(d, d) - forward * forward) / (double)count;
    }
    for (int a = 0; a < 3; a++) f->origin[a] = piece_mean[a] + end * f->along[a];
    f->radius = fmax(sqrt(fmax(squares - 2 * scale->noise * scale->noise, 0)), THINNEST * scale->stem_radius);
    return true;
}

/* The blade's plane by its points between two distances ahead of the line's origin. false where these are few, or it stands across
 * the petiole. */
static bool find_plane(const leaf_points *leaf, double from, double to, uint32_t *chosen, frame *f)
{
    double mean[3], vector[3][3], d[3];
    size_t count = 0;
    for (size_t i = leaf->petiole; i < leaf->count; i++) {
        offset_from(leaf->xyz[leaf->point[i]], f->origin, d);
        if (plm_dot(d, f->along) > from && plm_dot(d, d) < to * to) chosen[count++] = leaf->point[i];
    }
    if (count < FEWEST_PLANE) return false;
    principal(leaf, chosen, count, mean, vector);
    const double *normal = vector[2], lean = plm_dot(normal, f->along);
    for (int a = 0; a < 3; a++) {
        f->off[a] = normal[a] - lean * f->along[a];
        f->ahead[a] = f->along[a] - lean * normal[a];
    }
    if (plm_normalise(f->off) < LEAST_LEVEL || plm_normalise(f->ahead) < LEAST_LEVEL) return false;
    plm_cross(f->off, f->along, f->across);
    plm_cross(normal, f->ahead, f->ahead_across);
    return true;
}

/* Place of a point along, across (about the petiole's middle) and off. */
static void flatten(const frame *f, const float xyz[3], double place[3])
{
    double d[3];
    offset_from(xyz, f->origin, d);
    const double forward = plm_dot(d, f->along);
    place[0] = forward > 0 ? plm_dot(d, f->ahead) : forward;
    place[1] = (forward > 0 ? plm_dot(d, f->ahead_across) : plm_dot(d, f->across)) - f->middle;
    place[2] = plm_dot(d, f->off);
}

static void find_middle(const leaf_points *leaf, const plm_scale *scale, float *value, frame *f)
{
    size_t count = 0;
    f->middle = 0;
    for (size_t i = 0; i < leaf->count; i++) {
        double place[3];
        flatten(f, leaf->xyz[leaf->point[i]], place);
        if (fabs(place[1]) < 1.5 * f->radius && place[0] > -MIDDLE_BACK * scale->radius && place[0] < 0)
            value[count++] = (float)place[1];
    }
    if (count > FEWEST_PIECE) f->middle = plm_quantile(value, count, 0.5);
}

/* The line of what lies about the old one up to the junction; its origin goes to the junction. is_bent: the junction is far ahead, on
 * the way to the far blade, from which the petiole may bow off the blade's plane, not aside. false: none. */
static bool next_line(const leaf_points *leaf, const plm_scale *scale, double junction, bool is_bent, uint32_t *chosen,
                      frame *f)
{
    const double *way = is_bent ? f->ahead : f->along;
    const double R = scale->radius, reach = f->radius + 2 * scale->noise + 0.065 * R;
    double mean[3], vector[3][3], d[3];
    size_t count = 0;
    for (size_t i = 0; i < leaf->count; i++) {
        offset_from(leaf->xyz[leaf->point[i]], f->origin, d);
        const double forward = plm_dot(d, way), side = is_bent ? plm_dot(d, f->ahead_across) - f->middle : 0;
        const double aside = is_bent ? side * side : plm_dot(d, d) - forward * forward;
        if (forward < junction - AHEAD * R && forward > junction - PLANE * R && aside < reach * reach)
            chosen[count++] = leaf->point[i];
    }
    if (count < FEWEST_PIECE) return false;
    principal(leaf, chosen, count, mean, vector);
    turn_towards(vector[0], f->along);
    if (plm_dot(vector[0], f->along) < LEAST_TURN) return false;
    for (int a = 0; a < 3; a++) d[a] = f->origin[a] + junction * way[a] - mean[a];
    const double forward = plm_dot(d, vector[0]);
    for (int a = 0; a < 3; a++) f->origin[a] = mean[a] + forward * vector[0][a];
    memcpy(f->along, vector[0], sizeof f->along);
    return true;
}

/* Places of the leaf's points near to the junction, thinned where they are many. Gives their number. */
static size_t flatten_near(const leaf_points *leaf, const plm_scale *scale, const frame *f, double (*place)[3])
{
    const double reach = REACH * scale->radius;
    uint32_t mask = 0;
    for (;;) {
        size_t count = 0;
        for (size_t i = 0; i < leaf->count; i++) {
            const float *xyz = leaf->xyz[leaf->point[i]];
            double d[3];
            offset_from(xyz, f->origin, d);
            if (plm_dot(d, d) > reach * reach || (plm_point_bits(xyz) & mask)) continue;
            flatten(f, xyz, place[count]);
            if (fabs(place[count][2]) < THICK * scale->radius) count++;
        }
        if (count <= MOST_POINTS || mask == UINT32_MAX) return count;
        mask = 2 * mask + 1;
    }
}

double plm_base_blur(double noise, double pitch)
{
    return hypot(noise, PITCH_ALONG * pitch);
}

/* Turns the way ahead in the blade's plane. */
static void turn_ahead(frame *f, double angle)
{
    const double c = cos(angle), s = sin(angle);
    for (int a = 0; a < 3; a++) {
        const double ahead = f->ahead[a], across = f->ahead_across[a];
        f->ahead[a] = c * ahead + s * across;
        f->ahead_across[a] = c * across - s * ahead;
    }
}

/* The leaf as it lies in a frame. place: the caller's, to be freed; NULL where there is no memory. */
static plm_base_view view_in(const leaf_points *leaf, const plm_scale *scale, const frame *f, plm_error *error)
{
    plm_base_view view = {.scale = scale->radius,
                          .radius = f->radius,
                          .noise = scale->noise,
                          .blur = plm_base_blur(scale->noise, leaf->is_rosettes ? 0 : scale->pitch),
                          .gathering = scale->gathering};
    view.place = plm_alloc(leaf->count, sizeof *view.place, error);
    if (view.place) view.count = flatten_near(leaf, scale, f, view.place);
    return view;
}

/* A narrow blade lies straight ahead: f is turned to it. */
static plm_status ask_outline(const leaf_points *leaf, const plm_scale *scale, bool is_small, frame *f, double expected,
                              plm_base_table *table, bool *told, plm_error *error)
{
    plm_base_view view = view_in(leaf, scale, f, error);
    if (!view.place) return PLM_E_MEMORY;
    if (is_small) view.blur = fmax(view.blur, SMALL_BLUR * f->radius);
    const bool any = !leaf->is_rosettes || is_small || plm_base_is_wide(&view);
    const double turn = any ? plm_base_turn(&view) : 0;
    if (turn != 0) {
        turn_ahead(f, turn);
        view.count = flatten_near(leaf, scale, f, view.place);
    }
    *told = false;
    const plm_status status = any ? plm_base_look(&view, expected, table, told, error) : PLM_OK;
    plm_free(view.place);
    return status;
}

/** A leaf whose base was looked at: its points, the frame that it was flattened in, and what the outlines say there. */
typedef struct base {
    leaf_points leaf;
    plm_scale scale; /* of a small blade its own */
    bool is_small;   /* told by outlines as small as it is */
    bool is_guess;   /* the table is by thickness alone */
    double guess;    /* where that has the junction, from the petiole's end by its labels */
    double most;     /* how far from there towards the tip it can be */
    frame frame;
    double moved;          /* the frame's origin, from the petiole's end by its labels */
    plm_base_table *table; /* NULL: it tells no border */
} base;

/* Room for the points of a leaf. */
typedef struct scratch_room {
    uint32_t *chosen;
    float *value;
} scratch_room;

/* Rounds of asking the outline, each with the petiole's line up to where the one before put the junction. */
static plm_status ask_in_rounds(const scratch_room *room, base *b, plm_error *error)
{
    const leaf_points *leaf = &b->leaf;
    const double R = b->scale.radius;
    double any[PLM_BASE_OUTLINES];
    plm_base_any(any);
    for (int round = 0; round < ROUNDS; round++) {
        frame next = b->frame;
        const double junction = b->table ? plm_base_mean(b->table, any) : 0, moved = b->moved + junction;
        if (b->table && !next_line(leaf, &b->scale, junction, b->is_guess, room->chosen, &next)) break;
        if (!find_plane(leaf, AHEAD * R, PLANE * R, room->chosen, &next)) break;
        find_middle(leaf, &b->scale, room->value, &next);
        plm_base_table *table = plm_alloc(1, sizeof *table, error);
        bool told = false;
        const plm_status status =
            table ? ask_outline(leaf, &b->scale, b->is_small, &next, -moved, table, &told, error) : PLM_E_MEMORY;
        if (status != PLM_OK || !told) {
            plm_free(table);
            if (status != PLM_OK) return status;
            break;
        }
        plm_free(b->table);
        b->frame = next, b->moved = moved, b->table = table, b->is_guess = false;
    }
    return PLM_OK;
}

/* A rosette's small blade. The first guess may be as far off as the blade is long: thickness tells about where it begins, its far part
 * its plane, and outlines as small as it is the border. */
static plm_status look_at_small(const scratch_room *room, base *b, plm_error *error)
{
    const leaf_points *leaf = &b->leaf;
    frame f = b->frame;
    const double end =
        end_along(leaf, leaf->point + leaf->petiole, leaf->count - leaf->petiole, f.origin, f.along, room->value);
    if (!find_plane(leaf, FAR_PART * end, INFINITY, room->chosen, &f)) return PLM_OK;
    if (plm_dot(f.along, f.ahead) < SMALL_LEVEL) return PLM_OK;
    find_middle(leaf, &b->scale, room->value, &f);
    plm_base_view view = view_in(leaf, &b->scale, &f, error);
    plm_base_table *guess = plm_alloc(1, sizeof *guess, error);
    plm_status status = view.place && guess ? PLM_OK : PLM_E_MEMORY;
    bool told = false;
    const bool small = status == PLM_OK && !plm_base_is_wide(&view) && !plm_base_is_noisy(&view);
    if (small) status = plm_base_look_at_thickness(&view, guess, &told, error);
    if (told) {
        b->is_small = b->is_guess = true, b->frame = f, b->table = guess;
        b->scale.radius = plm_base_own_scale(&view);
        double any[PLM_BASE_OUTLINES];
        plm_base_any(any);
        b->guess = plm_base_mean(guess, any);
        b->most = FARTHEST * end;
        status = ask_in_rounds(room, b, error);
        if (b->is_guess) {
            plm_free(b->table);
            b->table = NULL;
        }
    } else
        plm_free(guess);
    plm_free(view.place);
    return status;
}

static plm_status look(const leaf_points *leaf, const plm_scale *scale, const scratch_room *room, base *out,
                       plm_error *error)
{
    *out = (base){.leaf = *leaf, .scale = *scale, .most = leaf->is_rosettes ? MOST_MOVE * scale->radius : INFINITY};
    if (leaf->petiole < FEWEST_PETIOLE || leaf->count - leaf->petiole < FEWEST_BLADE) return PLM_OK;
    if (!first_line(leaf, scale, room->chosen, room->value, &out->frame)) return PLM_OK;
    const plm_status status = ask_in_rounds(room, out, error);
    return status == PLM_OK && !out->table && leaf->is_rosettes ? look_at_small(room, out, error) : status;
}

/* Beyond the junction all is blade; before it, up to where the petiole ended (beside a small blade anywhere), what lies about its line is
 * petiole. */
static void relabel(const base *b, double junction, const uint32_t *row, plm_segmentation *out)
{
    const leaf_points *leaf = &b->leaf;
    const frame *f = &b->frame;
    const double R = b->scale.radius, noise = b->scale.noise;
    const double strip = (b->is_small ? SMALL_STRIP : 1) * f->radius + 1.5 * noise;
    for (size_t i = 0; i < leaf->count; i++) {
        double place[3];
        flatten(f, leaf->xyz[leaf->point[i]], place);
        if (fabs(place[1]) > SIDE * R || fabs(place[2]) > THICK * R || fabs(place[0]) > REACH * R) continue;
        const uint32_t at = row[leaf->point[i]];
        const uint8_t old = out->label[at];
        if (place[0] >= junction)
            out->label[at] = PLM_LABEL_LEAF;
        else if ((b->is_small || place[0] > -b->moved - AHEAD * R) && fabs(place[1]) < strip &&
                 fabs(place[2]) < strip + noise)
            out->label[at] = PLM_LABEL_PETIOLE;
        if (out->leaflet && out->label[at] != old)
            out->leaflet[at] = out->label[at] == PLM_LABEL_LEAF ? 0 : -1; /* a simple leaf has one */
    }
}

/* Moves the borders of all leaves to where the outlines of all put them; a rosette's leaves of different ages begin unlike. */
static void set_borders(const base *list, size_t count, const plm_base_table *const *table, const uint32_t *row,
                        plm_segmentation *out)
{
    double share[PLM_BASE_OUTLINES];
    plm_base_shares(table, list->leaf.is_rosettes ? 0 : count, share);
    for (size_t i = 0; i < count; i++) {
        const double moved = list[i].moved;
        double junction = plm_base_mean(table[i], share);
        /* What is thin is no petiole: outlines of few points may put the border beyond. */
        if (list[i].is_small) junction = fmin(junction, list[i].guess - moved);
        if (moved + junction > list[i].most) continue;
        relabel(&list[i], junction, row, out);
    }
}

/* Gathers the points of each leaf: of its petiole, then of its blade. first: where each of them ends. */
static void gather(const uint32_t *row, size_t count, const plm_segmentation *out, uint32_t *first, uint32_t *point)
{
    const size_t leaves = out->leaf_count;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < count; i++) {
            const int32_t leaf = plm_leaf_of(out, row[i]);
            if (leaf < 0) continue;
            const size_t slot = 2 * (size_t)leaf + (out->label[row[i]] == PLM_LABEL_LEAF);
            if (pass)
                point[first[slot]++] = (uint32_t)i;
            else
                first[slot + 1]++;
        }
        for (size_t slot = 1; !pass && slot <= 2 * leaves; slot++) first[slot] += first[slot - 1];
    }
}

size_t plm_simple_leaves(const uint32_t *row, size_t count, const plm_segmentation *out)
{
    if (!out->leaflet) return out->leaf_count;
    size_t simple = out->leaf_count;
    for (size_t i = 0; i < count; i++) {
        const size_t leaf = (size_t)out->organ[row[i]];
        if (out->label[row[i]] == PLM_LABEL_LEAF && out->leaflet[row[i]] > 0 && leaf < simple) simple = leaf;
    }
    return simple < out->leaf_count ? simple : 0;
}

plm_status plm_blade_bases(const float (*xyz)[3], const uint32_t *row, size_t count, const plm_scale *scale,
                           plm_segmentation *out, plm_error *error)
{
    const bool is_rosette = out->habit == PLM_HABIT_ROSETTE;
    if (is_rosette && scale->noise > CLEAR_NOISE * scale->stem_radius) return PLM_OK;
    plm_scratch scratch = {.error = error};
    const size_t leaves = out->leaf_count;
    uint32_t *first = plm_scratch_take(&scratch, 2 * leaves + 2, sizeof *first);
    uint32_t *point = plm_scratch_take(&scratch, count + 1, sizeof *point);
    uint32_t *chosen = plm_scratch_take(&scratch, count + 1, sizeof *chosen);
    float *value = plm_scratch_take(&scratch, count + 1, sizeof *value);
    base *list = plm_scratch_take(&scratch, leaves + 1, sizeof *list);
    const plm_base_table **table = plm_scratch_take(&scratch, leaves + 1, sizeof *table);
    size_t number = 0;
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK) gather(row, count, out, first, point);
    const size_t simple = plm_simple_leaves(row, count, out);
    for (size_t leaf = 0; leaf < simple && status == PLM_OK; leaf++) {
        const uint32_t begin = leaf ? first[2 * leaf - 1] : 0, middle = first[2 * leaf], end = first[2 * leaf + 1];
        const leaf_points points = {xyz, point + begin, end - begin, middle - begin, is_rosette};
        status = look(&points, scale, &(scratch_room){chosen, value}, &list[number], error);
        table[number] = list[number].table;
        number += table[number] != NULL;
    }
    if (status == PLM_OK) set_borders(list, number, table, row, out);
    for (size_t i = 0; i < number; i++) plm_free(list[i].table);
    plm_scratch_free(&scratch, NULL);
    return status;
}
