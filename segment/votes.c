/* segment/votes.c: votes of neighbours, counted. */
#include "segment/votes.h"

#include <stdlib.h>

static int by_component(const void *a, const void *b)
{
    const plm_vote *p = a, *q = b;
    if (p->component != q->component) return p->component < q->component ? -1 : 1;
    return (p->colour > q->colour) - (p->colour < q->colour);
}

void plm_votes_count(plm_vote *votes, size_t count, double share, int32_t *winner)
{
    if (count) qsort(votes, count, sizeof *votes, by_component);
    for (size_t begin = 0, end; begin < count; begin = end) {
        size_t most = 0, run = begin;
        int32_t best = 0;
        for (end = begin; end < count && votes[end].component == votes[begin].component; end++) {
            if (votes[end].colour != votes[run].colour) run = end;
            if (end - run + 1 <= most) continue;
            most = end - run + 1;
            best = votes[end].colour;
        }
        winner[votes[begin].component] = (double)most >= share * (double)(end - begin) ? best : -1;
    }
}
