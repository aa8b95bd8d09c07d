/* segment/votes.h: what small components of points lie amid, by votes of their neighbours. Internal. */
#ifndef PLANTIMETER_SEGMENT_VOTES_H
#define PLANTIMETER_SEGMENT_VOTES_H

#include <stddef.h>
#include <stdint.h>

/** One neighbour of a component, by its colour. */
typedef struct plm_vote {
    int32_t component, colour;
} plm_vote;

/** winner[c], for each component c that has votes: the colour that most of them are for (the smallest of equal ones), -1 where those
 * are less than share of all. Sorts votes. */
void plm_votes_count(plm_vote *votes, size_t count, double share, int32_t *winner);

#endif
