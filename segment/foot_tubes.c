/* segment/foot_tubes.c: the stem and the petioles about a node as tubes. The stem is straight there, a petiole is bent and
 * prolonged from where it is clear of the stem; both are blurred by the noise. The points are taken for a Poisson process: its
 * likelihood tells how far a stem goes, and which tube a point is of. */
#include "segment/foot_tubes.h"

#include "cloud/linear.h"
#include "segment/line_fit.h"
#include "segment/stem_fit.h"

#include <math.h>

/* Lengths in R. */
static const double FIRST_FROM = 5, FIRST_TO = 2;     /* before the way's end: stem that gives its first line */
static const double NEXT_FROM = 4, NEXT_TO = 0.3;     /* before the end that was found: its next line */
static const double NODE_REACH = 2.5;                 /* to either side of a node below: stem that gives its line */
static const double LEAST_WINDOW = 1.5;               /* of stem that gives a line */
static const double SEARCH_BACK = 4, SEARCH_ON = 1.5; /* about the way's end */
static const double STEP = 1.0 / 32;
static const double FOOT_BACK = 3;    /* before the petiole's clear part: where its foot is sought */
static const double EMERGED = 0.5;    /* of its radius: a petiole's line so deep below the stem's surface is its foot */
static const double BEND_SD = 0.4;    /* of a petiole: its sag over its length times four */
static const double CLEAR = 2.5;      /* SDs beyond the stem's surface: no stem */
static const double ON_TUBE = 3;      /* SDs from a tube's surface: of it */
static const double THINNEST = 0.25;  /* radius of a petiole, in the stem's, at least */
static const double ELSEWHERE = 0.01; /* density of points, in that of the stem */
static const double LEAST_TURN = 0.15, /* radians between stem and petiole, ... */
    LEAST_BESIDE = 3;                  /* ... or SDs between their lines at the foot: else they cannot be told apart */
static const double CAP_SD = 0.3;      /* of the stem's radius: its end is flat or round */
static const double LEAST_KNOWN = 0.9; /* of the stem's points are on one of the tubes */
enum { ROUNDS = 3, FEWEST_STEM = 30 };

static double below(double x)
{
    return 0.5 * erfc(-x / sqrt(2));
}

/* exp(-x) I0(x), by Abramowitz and Stegun 9.8.1 and 9.8.2: relative error below 1e-6. */
static double scaled_bessel(double x)
{
    if (x < 3.75) {
        const double t = x / 3.75 * (x / 3.75);
        return exp(-x) *
               (1 + t * (3.5156229 +
                         t * (3.0899424 + t * (1.2067492 + t * (0.2659732 + t * (0.0360768 + t * 0.0045813))))));
    }
    const double t = 3.75 / x;
    return (0.39894228 +
            t * (0.01328592 +
                 t * (0.00225319 +
                      t * (-0.00157565 +
                           t * (0.00916281 +
                                t * (-0.02057706 + t * (0.02635537 + t * (-0.01647633 + t * 0.00392377)))))))) /
           sqrt(x);
}

/* Density per area of a ring's points at a distance from its centre when each is moved by normal errors. */
static double blurred_ring(double distance, double radius, double blur)
{
    const double off = (distance - radius) / blur;
    return exp(-0.5 * off * off) * scaled_bessel(distance * radius / (blur * blur)) / (2 * PLM_PI * blur * blur);
}

static void line_at(const plm_foot_tube *t, double s, double out[3])
{
    for (int a = 0; a < 3; a++) out[a] = t->origin[a] + s * t->along[a] + s * s * t->bend[a];
}

/* Distance of a place from a tube's line; s: place along it. */
static double distance_from(const plm_foot_tube *t, const double place[3], double *s)
{
    double d[3], tangent[3];
    for (int a = 0; a < 3; a++) d[a] = place[a] - t->origin[a];
    *s = plm_dot(d, t->along);
    for (int a = 0; a < 3; a++) {
        d[a] -= *s * t->along[a] + *s * *s * t->bend[a];
        tangent[a] = t->along[a] + 2 * *s * t->bend[a];
    }
    plm_normalise(tangent);
    const double forward = plm_dot(d, tangent);
    return sqrt(fmax(plm_dot(d, d) - forward * forward, 0));
}

double plm_tube_distance(const plm_foot_tube *t, const float xyz[3], double *s)
{
    return distance_from(t, (const double[3]){xyz[0], xyz[1], xyz[2]}, s);
}

static uint8_t label_of(const plm_foot *p, size_t i)
{
    return p->out->label[p->row[p->point[i]]];
}

double plm_foot_distance(const plm_foot *p, const float xyz[3])
{
    return plm_distance(p->at, (const double[3]){xyz[0], xyz[1], xyz[2]});
}

/* Radius, by the mean square distance less the noise. */
static double radius_of(const plm_foot *p, double squares, size_t count, double least)
{
    const double noise = p->scale->noise;
    return fmax(sqrt(fmax(squares / (double)count - 2 * noise * noise, 0)), least);
}

/* ---- The tubes ----------------------------------------------------------------------------------------------- */

/* Density of the stem at a point when it ends at a place: its side, and what closes it. */
static double stem_density(const plm_foot *p, size_t i, double end)
{
    const double sd = hypot(p->blur, CAP_SD * p->tube[0].radius), off = (p->place[i] - end) / sd;
    const double cap = (1 - p->outside[i]) * exp(-0.5 * off * off) / (sd * sqrt(2 * PLM_PI));
    return below(-off * sd / p->blur) * p->density[i][0] + cap * p->tube[0].density / (2 * PLM_PI * p->tube[0].radius);
}

/* Share of a petiole that a stem which ends at a place leaves at a point. */
static double seen_beside(const plm_foot *p, size_t i, double end)
{
    return 1 - below((end - p->place[i]) / p->blur) * (1 - p->outside[i]);
}

/* Which a point is of, by the tubes of the last round: 0 the stem, k the petiole k - 1. */
size_t plm_foot_likeliest(const plm_foot *p, size_t i, double *most)
{
    const double seen = seen_beside(p, i, p->end);
    size_t best = 0;
    *most = stem_density(p, i, p->end);
    for (size_t k = 1; k <= p->petioles; k++)
        if (seen * p->density[i][k] > *most) *most = seen * p->density[i][k], best = k;
    return best;
}

/* The stem's line through its points between two places of the old line; the first time, of the way. s is 0 at the way's end. */
static bool fit_stem(plm_foot *p, bool first)
{
    const double R = p->scale->radius, length = p->path->along[p->path->count - 1];
    const double back = p->is_tip ? FIRST_FROM : NODE_REACH, top = p->is_tip ? p->end - NEXT_TO * R : NODE_REACH * R;
    const double from = first ? fmax(p->along - back * R, 0) : (p->is_tip ? p->end - NEXT_FROM * R : -NODE_REACH * R);
    const double to = first ? fmin(p->is_tip ? length - FIRST_TO * R : p->along + NODE_REACH * R, length) : top;
    if (to - from < LEAST_WINDOW * R) return false;
    plm_foot_tube old = p->tube[0];
    for (int pass = 0; pass < 2; pass++) {
        plm_line_sums sums = {0};
        double squares = 0;
        const bool by_way = first && !pass;
        for (size_t i = 0; i < p->count; i++) {
            const float *xyz = p->xyz[p->point[i]];
            plm_stem_place place = {0};
            double s, most, distance = 0;
            if (label_of(p, i) != PLM_LABEL_STEM && (first || plm_foot_likeliest(p, i, &most) != 0)) continue;
            if (first) plm_stem_nearest(p->path, xyz, &place);
            if (!by_way) distance = plm_tube_distance(&old, xyz, &s);
            const double t = first ? place.along : s;
            if (t < from || t > to || (!by_way && distance > old.radius + CLEAR * p->blur)) continue;
            const double where[3] = {xyz[0], xyz[1], xyz[2]};
            plm_line_add(&sums, by_way ? t : s, where);
            squares += distance * distance;
        }
        plm_foot_tube next = {.density = sums.n / (to - from)};
        if (sums.n < FEWEST_STEM || !plm_line_fit(&sums, next.origin, next.along)) return false;
        next.radius =
            by_way ? p->scale->stem_radius : radius_of(p, squares, (size_t)sums.n, THINNEST * p->scale->stem_radius);
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = p->at[a] - next.origin[a];
        const double forward = plm_dot(d, next.along);
        for (int a = 0; a < 3; a++) next.origin[a] += forward * next.along[a];
        old = next;
    }
    p->tube[0] = old;
    return true;
}

/* Solves the normal equations of place = a + b s + c s^2, c held near 0. */
static bool solve_bent(const double m[5], const double y[3], double ridge, double x[3])
{
    const double a = m[0], b = m[1], c = m[2], d = m[3], e = m[4] + ridge;
    const double det = a * (c * e - d * d) - b * (b * e - d * c) + c * (b * d - c * c);
    if (!(fabs(det) > 0)) return false;
    x[0] = (y[0] * (c * e - d * d) - b * (y[1] * e - d * y[2]) + c * (y[1] * d - c * y[2])) / det;
    x[1] = (a * (y[1] * e - d * y[2]) - y[0] * (b * e - d * c) + c * (b * y[2] - y[1] * c)) / det;
    x[2] = (a * (c * y[2] - d * y[1]) - b * (b * y[2] - y[1] * c) + y[0] * (b * d - c * c)) / det;
    return true;
}

/* Whether a point is of a petiole: clear of the stem, or by the tubes of the last round. */
static bool is_petiole(const plm_foot *p, size_t i, size_t k, bool first)
{
    const float *xyz = p->xyz[p->point[i]];
    const bool is_stem = label_of(p, i) == PLM_LABEL_STEM;
    double s;
    if (!is_stem && p->out->organ[p->row[p->point[i]]] != p->leaf[k]) return false;
    if (plm_foot_distance(p, xyz) > PLM_FOOT_PETIOLE_REACH * p->scale->radius) return false;
    const double distance = plm_tube_distance(&p->tube[0], xyz, &s);
    if (is_stem && (s < -FIRST_TO * p->scale->radius || (first && (k || !p->is_tip)))) return false;
    if (first) return distance > p->tube[0].radius + CLEAR * p->blur;
    double most;
    return plm_foot_likeliest(p, i, &most) == k + 1 &&
           plm_tube_distance(&p->tube[1 + k], xyz, &s) < p->tube[1 + k].radius + ON_TUBE * p->blur;
}

/* Where a petiole comes out of the stem, below a place of its line. */
static double foot_of(const plm_foot *p, const plm_foot_tube *petiole, double clear)
{
    const double step = STEP * p->scale->radius, deep = p->tube[0].radius - EMERGED * petiole->radius;
    double s = clear, before = INFINITY;
    for (; s > clear - FOOT_BACK * p->scale->radius; s -= step) {
        double at[3], on;
        line_at(petiole, s, at);
        const double off = distance_from(&p->tube[0], at, &on);
        if (off < deep || off > before) break;
        before = off;
    }
    return s;
}

/* The petiole's line; s is 0 at the middle of its points. */
static bool fit_petiole(plm_foot *p, size_t which, bool first)
{
    double mean[3] = {0};
    size_t count = 0;
    for (size_t i = 0; i < p->count; i++) {
        if (!is_petiole(p, i, which, first)) continue;
        for (int a = 0; a < 3; a++) mean[a] += p->xyz[p->point[i]][a];
        count++;
    }
    if (count < PLM_FOOT_FEWEST) return false;
    plm_foot_tube next = {0};
    for (int a = 0; a < 3; a++) mean[a] /= (double)count;
    for (int a = 0; a < 3; a++) next.along[a] = mean[a] - p->at[a];
    if (!(plm_normalise(next.along) > 0)) return false;
    double m[5] = {0}, y[3][3] = {{0}}, low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < p->count; i++) {
        if (!is_petiole(p, i, which, first)) continue;
        double d[3], power = 1;
        for (int a = 0; a < 3; a++) d[a] = p->xyz[p->point[i]][a] - mean[a];
        const double s = plm_dot(d, next.along);
        low = fmin(low, s), high = fmax(high, s);
        for (int k = 0; k < 5; k++, power *= s) {
            m[k] += power;
            for (int a = 0; a < 3 && k < 3; a++) y[a][k] += power * (d[a] - s * next.along[a]);
        }
    }
    const double spread = (p->tube[0].radius * p->tube[0].radius) / 2 + p->blur * p->blur;
    const double sd = BEND_SD / (high - low);
    for (int a = 0; a < 3; a++) {
        double x[3];
        if (!solve_bent(m, y[a], spread / (sd * sd), x)) return false;
        next.origin[a] = mean[a] + x[0], next.along[a] += x[1], next.bend[a] = x[2];
    }
    const double stretch = plm_normalise(next.along); /* places along the line are that much farther apart */
    if (!(stretch > 0)) return false;
    for (int a = 0; a < 3; a++) next.bend[a] /= stretch * stretch;
    low *= stretch, high *= stretch;
    next.density = (double)count / (high - low);
    double squares = 0;
    for (size_t i = 0; i < p->count; i++) {
        double s;
        if (!is_petiole(p, i, which, first)) continue;
        const double distance = plm_tube_distance(&next, p->xyz[p->point[i]], &s);
        squares += distance * distance;
    }
    next.radius = fmin(radius_of(p, squares, count, THINNEST * p->scale->stem_radius), p->tube[0].radius);
    p->foot[which] = foot_of(p, &next, low), p->last[which] = high;
    p->tube[1 + which] = next;
    return true;
}

/* ---- The end ---------------------------------------------------------------------------------------------------- */

void plm_foot_densities(plm_foot *p)
{
    for (size_t i = 0; i < p->count; i++) {
        const float *xyz = p->xyz[p->point[i]];
        double s;
        const double from_stem = plm_tube_distance(&p->tube[0], xyz, &p->place[i]);
        p->density[i][0] = p->tube[0].density * blurred_ring(from_stem, p->tube[0].radius, p->blur);
        p->outside[i] = below((from_stem - p->tube[0].radius) / p->blur);
        for (size_t k = 0; k < p->petioles; k++) {
            const plm_foot_tube *t = &p->tube[1 + k];
            const double off = plm_tube_distance(t, xyz, &s);
            p->density[i][k + 1] = t->density * blurred_ring(off, t->radius, p->blur) *
                                   below((s - p->foot[k]) / p->blur) * below((p->last[k] - s) / p->blur);
        }
    }
}

double plm_foot_elsewhere(const plm_foot *p)
{
    const double reach = p->tube[0].radius + 2 * p->blur;
    return ELSEWHERE * p->tube[0].density / (PLM_PI * reach * reach);
}

/* Log likelihood of a stem that ends at a place. */
static double judge(const plm_foot *p, double end)
{
    const double faint = plm_foot_elsewhere(p);
    double sum = -p->tube[0].density * end;
    for (size_t i = 0; i < p->count; i++) {
        const double seen = seen_beside(p, i, end);
        double density = stem_density(p, i, end) + faint;
        for (size_t k = 1; k <= p->petioles; k++) density += seen * p->density[i][k];
        sum += log(density);
    }
    return sum;
}

static void find_end(plm_foot *p)
{
    const double R = p->scale->radius;
    double most = -INFINITY;
    for (double end = -SEARCH_BACK * R; end <= SEARCH_ON * R; end += STEP * R) {
        const double value = judge(p, end);
        if (value > most) most = value, p->end = end;
    }
}

/* Whether the petiole turns from the stem at its foot, or begins beside the stem's line. */
static bool is_apart(const plm_foot *p)
{
    const plm_foot_tube *petiole = &p->tube[1];
    double tangent[3], at[3], on;
    for (int a = 0; a < 3; a++) tangent[a] = petiole->along[a] + 2 * p->foot[0] * petiole->bend[a];
    plm_normalise(tangent);
    if (fabs(plm_dot(tangent, p->tube[0].along)) <= cos(LEAST_TURN)) return true;
    line_at(petiole, p->foot[0], at);
    return distance_from(&p->tube[0], at, &on) >= LEAST_BESIDE * p->blur;
}

/* Whether the tubes hold what is called stem there, and are apart. */
static bool is_told(const plm_foot *p)
{
    const double R = p->scale->radius, faint = plm_foot_elsewhere(p);
    size_t all = 0, known = 0;
    if (!is_apart(p)) return false;
    if (p->is_tip && p->end < (-SEARCH_BACK + 2 * STEP) * R) return false;
    if (p->is_tip && p->end > (SEARCH_ON - 2 * STEP) * R) return false;
    for (size_t i = 0; i < p->count; i++) {
        if (label_of(p, i) != PLM_LABEL_STEM || p->place[i] < (p->is_tip ? p->end - NEXT_FROM * R : -NODE_REACH * R) ||
            (!p->is_tip && p->place[i] > NODE_REACH * R))
            continue;
        all++;
        double density = p->place[i] < p->end + p->blur ? p->density[i][0] : 0;
        for (size_t k = 1; k <= p->petioles; k++) density += p->density[i][k];
        known += density > 2 * faint;
    }
    return (double)known >= LEAST_KNOWN * (double)all;
}

bool plm_foot_fit(plm_foot *p)
{
    for (int round = 0; round < ROUNDS; round++) {
        if (!fit_stem(p, !round)) return false;
        size_t kept = 0;
        for (size_t k = 0; k < p->petioles; k++) {
            if (!fit_petiole(p, k, !round)) {
                if (!k) return false;
                continue;
            }
            p->tube[1 + kept] = p->tube[1 + k], p->foot[kept] = p->foot[k], p->last[kept] = p->last[k],
                        p->leaf[kept] = p->leaf[k];
            kept++;
        }
        p->petioles = kept;
        plm_foot_densities(p);
        if (p->is_tip) find_end(p);
    }
    return is_told(p);
}
