/* bench/bench.hpp: what the benchmarks share: timing of two rivals in turns, one row of the table a goal, CSV.
 *
 * A goal is a ratio, because machines are noisy: both rivals run in turns in one process, and the ratio is the median of
 * the turns' ratios. Times are wall times; with one thread they are processor times, which a busy machine stretches less.
 *
 *   int main(int count, char **arguments)
 *   {
 *       bench::Run run(count, arguments);
 *       run.compare({"P12", "binary PLY, 5e6 points", "pcl_io", 0.2, 1}, [&] { ours(); }, [&] { theirs(); });
 *       return run.end();
 *   }
 *
 * Options of every benchmark: --only P1,P9 (default: all), --csv FILE (append rows), --repeats N, --points F (factor on
 * the number of points, for a quick look; the goals hold for 1), --clock processor (processor time for any number of
 * threads, where other work keeps the machine busy; says nothing about P13, and wants OMP_WAIT_POLICY=passive). */
#ifndef PLANTIMETER_BENCH_HPP
#define PLANTIMETER_BENCH_HPP

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <omp.h>
#include <string>
#include <vector>

namespace bench
{

/** A row of the table. threads: 0 leaves OpenMP as it is. */
struct Goal {
    const char *id, *what, *rival;
    double most;
    int threads;
};

inline double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    const size_t n = values.size();
    return n == 0 ? NAN : n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

inline double seconds(clockid_t clock)
{
    timespec now;
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/** Processor time for any number of threads. */
inline bool busy_machine = false;

/** Seconds that work takes; processor time for one thread, else wall time. */
template <class Work> double timed(int threads, Work work)
{
    const clockid_t clock = threads == 1 || busy_machine ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
    if (threads > 0) omp_set_num_threads(threads);
    const double begin = seconds(clock);
    work();
    return seconds(clock) - begin;
}

class Run
{
  public:
    Run(int count, char **arguments)
    {
        for (int i = 1; i < count; i++) {
            const std::string option = arguments[i];
            const char *value = i + 1 < count ? arguments[i + 1] : nullptr;
            if (value && option == "--only")
                only = std::string(",") + value + ",";
            else if (value && option == "--csv")
                csv = value;
            else if (value && option == "--repeats")
                repeats = std::max(1, std::atoi(value));
            else if (value && option == "--points")
                factor = std::atof(value);
            else if (value && option == "--clock")
                busy_machine = std::strcmp(value, "processor") == 0;
            else
                fail("usage: [--only P1,P9] [--csv FILE] [--repeats N] [--points FACTOR] [--clock wall|processor]");
            i++;
        }
        if (only == ",all,") only.clear();
    }

    bool wanted(const char *id) const
    {
        return only.empty() || only.find("," + std::string(id) + ",") != std::string::npos;
    }

    size_t points(double count) const
    {
        return static_cast<size_t>(count * factor);
    }

    /** How often each rival has its turn. */
    int turns() const
    {
        return repeats;
    }

    /** Both rivals in turns; gives the median seconds of ours (NAN where the row is not wanted). */
    template <class Ours, class Theirs> double compare(const Goal &goal, Ours ours, Theirs theirs)
    {
        if (!wanted(goal.id)) return NAN;
        std::vector<double> own, rival, ratio;
        for (int turn = 0; turn < repeats; turn++) {
            own.push_back(timed(goal.threads, ours));
            rival.push_back(timed(goal.threads, theirs));
            ratio.push_back(own.back() / rival.back());
        }
        report(goal, median(own), median(rival), median(ratio), "s");
        return median(own);
    }

    /** A row whose two figures were found otherwise. */
    void report(const Goal &goal, double ours, double theirs, double ratio, const char *unit)
    {
        if (!wanted(goal.id)) return;
        const bool met = ratio <= goal.most;
        std::printf("%-4s %-44s %9.4g %-5s %-34s %9.4g  %6.3f  %5.3g  %s\n", goal.id, goal.what, ours, unit, goal.rival,
                    theirs, ratio, goal.most, met ? "yes" : "NO");
        std::fflush(stdout);
        if (csv.empty()) return;
        FILE *file = std::fopen(csv.c_str(), "a");
        if (!file) fail(("cannot write " + csv).c_str());
        char day[16];
        const time_t now = std::time(nullptr);
        std::strftime(day, sizeof day, "%Y-%m-%d", std::gmtime(&now));
        const char *commit = std::getenv("BENCH_COMMIT");
        std::fprintf(file, "%s,%s,%s,\"%s\",\"%s\",%.6g,%.6g,%s,%.4f,%g\n", day, commit ? commit : "", goal.id,
                     goal.what, goal.rival, ours, theirs, unit, ratio, goal.most);
        std::fclose(file);
    }

    [[noreturn]] static void fail(const char *message)
    {
        std::fprintf(stderr, "%s\n", message);
        std::exit(2);
    }

    int end() const
    {
        return 0;
    }

  private:
    std::string only, csv;
    int repeats = 5;
    double factor = 1;
};

/** Ends the benchmark with the message of a call that failed. */
template <class Status, class Error> void check(Status status, const Error &error)
{
    if (status != 0) Run::fail(error.message);
}

} // namespace bench

#endif
