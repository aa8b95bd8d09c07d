/* segment/threads.h: how many threads a parallel loop may have, and which one it is; 1 and 0 without OpenMP. Internal. */
#ifndef PLANTIMETER_SEGMENT_THREADS_H
#define PLANTIMETER_SEGMENT_THREADS_H

#include <stddef.h>

#ifdef _OPENMP
#include <omp.h>
#endif

static inline size_t plm_thread_count(void)
{
#ifdef _OPENMP
    return (size_t)omp_get_max_threads();
#else
    return 1;
#endif
}

static inline size_t plm_thread_number(void)
{
#ifdef _OPENMP
    return (size_t)omp_get_thread_num();
#else
    return 0;
#endif
}

#endif
