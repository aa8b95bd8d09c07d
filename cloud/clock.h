/* cloud/clock.h: how long something took and how much memory the process has held: what run records say. */
#ifndef PLANTIMETER_CLOUD_CLOCK_H
#define PLANTIMETER_CLOUD_CLOCK_H

#include <stdint.h>
#include <sys/resource.h>
#include <time.h>

/** Seconds since some moment; never goes back. */
static inline double plm_seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/** The most memory that the process has held so far; 0 where the system does not say. */
static inline uint64_t plm_peak_bytes(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (uint64_t)usage.ru_maxrss * 1024 : 0;
}

#endif
