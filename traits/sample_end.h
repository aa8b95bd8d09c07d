/* traits/sample_end.h: where a surface ends, from the outermost ones of points sampled on it. Internal. */
#ifndef PLANTIMETER_TRAITS_SAMPLE_END_H
#define PLANTIMETER_TRAITS_SAMPLE_END_H

#include <stddef.h>

/** The end is found from so many heights at least, and from all within so many SD of the noise that may be in them below the highest. */
#define PLM_END_FEWEST 24
#define PLM_END_DEPTH  3.0

/** How high a point lies, and the noise in that. No noise at all: 0 in all of them. */
typedef struct plm_height {
    double at;
    double spread; /**< SD, as known beforehand */
    /** SD of more of it that is there in part: which part the heights tell; not 0 where spread is, in noise. */
    double along;
} plm_height;

/** SD of the noise that may be in a height: with all of what is there in part. */
double plm_height_spread(const plm_height *height);

/** Mean of max(y + n, 0)^k over standard normal n, for k = 0, 1, 2: a power blurred by noise, and the integral of the one before but for
 * the factor 1 / k. */
void plm_blurred_powers(double y, double mean[3]);

/** Where heights of points of a surface would end if it were sampled without gaps and without noise.
 * height       count of them (at least 1), any order: sorted on return, highest first
 * end, std_error  out, mean and standard deviation of the posterior
 * depth        out, from the end to the lowest height that was used; gives how many were
 *
 * Below the end e the surface's area grows as a power a of the depth: 1 for a flat edge, 3/2 for a round rim, 2 for a tip.
 * The highest points then have the density a (e - z)^(a - 1), blurred by the noise of each; end, power and the part of `along`
 * (a quarter to all of it) are found together, all ends, powers and parts alike beforehand (P. Hall 1982, On estimating the endpoint
 * of a distribution; here with a prior in place of his known power). Where all of `along` blurs a flat edge of some hundred heights
 * an SD and more, the end comes out by up to 0.9 SD too far: within PLM_END_DEPTH it looks like a tip with less. */
size_t plm_end_of_sample(plm_height *height, size_t count, double *end, double *std_error, double *depth);

/** The same for heights without noise of points about one corner of a surface (count of them, at least 1), from so many as `used` of
 * the highest and for powers from 1 to 2. */
void plm_end_of_corner(plm_height *height, size_t count, size_t used, double *end, double *std_error);

#endif
