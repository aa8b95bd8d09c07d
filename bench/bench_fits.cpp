/* bench/bench_fits.cpp: stiff fits by the library's scaled trust region, GSL's, Gauss-Newton, Levenberg-Marquardt and Adam: steps,
 * time, error against the truth, failures; and from how far off the truth each still gets to the minimum.
 *
 * Usage: bench_fits [--trials N] [--csv FILE] [--smoke]. A failure is a cost more than a millionth above the least that any
 * method found, from its start or from the truth. --smoke: few trials, and exit code 1 where the trust region needs more steps
 * or fails more often than it may. Prints the tables of docs/stability.md. With --only, as bench/run.sh has it, it does nothing
 * but for `all`. */
#include "bench.hpp"
#include "fit_methods.hpp"

#include <memory>
#include <string>

using namespace fits;

namespace
{

constexpr size_t POINTS = 200;
const struct {
    const char *name;
    Method run;
} methods[] = {{"trust region", trust_region},
               {"GSL trust region", gsl},
               {"Gauss-Newton", gauss_newton},
               {"Levenberg-Marquardt", levenberg_marquardt},
               {"Adam", adam}};
constexpr size_t METHODS = sizeof methods / sizeof *methods;

using Maker = std::unique_ptr<Problem> (*)(double extent, double noise, Random &random);
template <class Kind> std::unique_ptr<Problem> make(double extent, double noise, Random &random)
{
    return std::make_unique<Kind>(extent, noise, POINTS, random);
}
template <class Kind> std::unique_ptr<Problem> make_in_degrees(double extent, double noise, Random &random)
{
    return std::make_unique<Kind>(extent * M_PI / 180, noise, POINTS, random);
}

struct Case {
    const char *what, *unit; /* of the extent */
    Maker maker;
    std::vector<double> extents, noises;
    double wide, narrow; /* extents from which the smoke run holds the trust region to its bounds; of the basin */
};
const Case cases[] = {
    {"circle", "deg", make_in_degrees<Circle>, {10, 20, 45, 90, 180, 360}, {0.001, 0.01, 0.1, 0.3}, 90, 45},
    {"cylinder", "deg", make_in_degrees<Cylinder>, {10, 20, 45, 90, 180, 360}, {0.001, 0.01, 0.1, 0.3}, 180, 45},
    {"leaf patch", "wide", make<Surface>, {0.01, 0.1, 1}, {0.0003, 0.003, 0.03}, 0.1, 0.1},
    {"rotation axis", "deg", make_in_degrees<Axis>, {2, 10, 30, 90, 180}, {0.0003, 0.003, 0.03}, 10, 10},
};

struct Tally {
    std::vector<double> steps, micros, error;
    int failed = 0, tried = 0;
};

bool is_at(const Problem &problem, const Result &found, double least)
{
    const double cost = problem.cost(found.x.data());
    return std::isfinite(cost) && cost <= least * (1 + 1e-6) + 1e-30;
}

/** Every method from start. */
void race(const Problem &problem, const Parameters &start, Tally *tally)
{
    Result found[METHODS];
    double least = problem.cost(trust_region(problem, problem.truth).x.data());
    for (size_t m = 0; m < METHODS; m++) {
        const double begin = bench::seconds(CLOCK_PROCESS_CPUTIME_ID);
        found[m] = methods[m].run(problem, start);
        tally[m].micros.push_back(1e6 * (bench::seconds(CLOCK_PROCESS_CPUTIME_ID) - begin));
        const double cost = problem.cost(found[m].x.data());
        if (cost < least) least = cost;
    }
    for (size_t m = 0; m < METHODS; m++) {
        tally[m].tried++;
        tally[m].steps.push_back(found[m].steps);
        const double error = problem.error(found[m].x.data());
        tally[m].error.push_back(std::isfinite(error) ? error : INFINITY);
        tally[m].failed += !is_at(problem, found[m], least);
    }
}

void print_race(const Case &own, double extent, const Tally *tally, FILE *csv)
{
    for (size_t m = 0; m < METHODS; m++) {
        const Tally &t = tally[m];
        const double share = 100.0 * t.failed / t.tried;
        std::printf("| %s, %g %s | %s | %.0f | %.0f | %.2g | %.0f |\n", own.what, extent, own.unit, methods[m].name,
                    bench::median(t.steps), bench::median(t.micros), bench::median(t.error), share);
        if (csv)
            std::fprintf(csv, "%s,%g,%s,%g,%g,%g,%g\n", own.what, extent, methods[m].name, bench::median(t.steps),
                         bench::median(t.micros), bench::median(t.error), share);
    }
    std::fflush(stdout);
}

/** Starts off the truth by so many times what is typical of each parameter, at random. */
bool basins(int trials, FILE *csv, bool is_smoke)
{
    static const double offs[] = {1e-3, 1e-2, 1e-1, 1, 10};
    bool is_good = true;
    std::printf("\n| start off by | 0.001 | 0.01 | 0.1 | 1 | 10 |\n|---|---|---|---|---|---|\n");
    for (const Case &own : cases) {
        int reached[METHODS][5] = {};
        for (int o = 0; o < 5; o++) {
            Random random(77);
            for (int trial = 0; trial < trials; trial++) {
                const auto problem = own.maker(own.narrow, 0.003, random);
                Parameters start = problem->truth;
                for (size_t a = 0; a < static_cast<size_t>(problem->size); a++)
                    start[a] += offs[o] * problem->typical[a] * normal(random);
                const double least = problem->cost(trust_region(*problem, problem->truth).x.data());
                for (size_t m = 0; m < METHODS; m++)
                    reached[m][o] += is_at(*problem, methods[m].run(*problem, start), least);
            }
        }
        for (size_t m = 0; m < METHODS; m++) {
            std::printf("| %s, %g %s: %s |", own.what, own.narrow, own.unit, methods[m].name);
            for (int o = 0; o < 5; o++) {
                const double share = 100.0 * reached[m][o] / trials;
                std::printf(" %.0f |", share);
                if (csv) std::fprintf(csv, "basin of %s,%g,%s,,,,%g\n", own.what, offs[o], methods[m].name, share);
            }
            std::printf("\n");
        }
        std::fflush(stdout);
        for (int o = 0; is_smoke && o < 3; o++)
            if (reached[0][o] < trials) {
                std::printf("smoke: %s: %d of %d starts off by %g do not get there\n", own.what, trials - reached[0][o],
                            trials, offs[o]);
                is_good = false;
            }
    }
    return is_good;
}

bool races(int trials, FILE *csv, bool is_smoke)
{
    bool is_good = true;
    int own_failures = 0, gsl_failures = 0;
    std::printf("| fit | method | steps | us | error | failed, %% |\n|---|---|---|---|---|---|\n");
    for (const Case &own : cases)
        for (const double extent : own.extents) {
            Tally tally[METHODS];
            Random random(5);
            for (const double noise : own.noises)
                for (int trial = 0; trial < trials; trial++) {
                    const auto problem = own.maker(extent, noise, random);
                    race(*problem, problem->start, tally);
                }
            print_race(own, extent, tally, csv);
            own_failures += tally[0].failed, gsl_failures += tally[1].failed;
            if (!is_smoke || extent < own.wide) continue;
            const double steps = bench::median(tally[0].steps);
            if (tally[0].failed || steps > 12) {
                std::printf("smoke: %s, %g %s: %d failures and %.0f steps; 0 and 12 at most\n", own.what, extent,
                            own.unit, tally[0].failed, steps);
                is_good = false;
            }
        }
    if (own_failures > gsl_failures) {
        std::printf("smoke: %d failures, %d of GSL\n", own_failures, gsl_failures);
        is_good = false;
    }
    return is_good;
}

} // namespace

int main(int count, char **arguments)
{
    int trials = 20;
    bool is_smoke = false;
    FILE *csv = nullptr;
    for (int i = 1; i < count; i++) {
        const std::string option = arguments[i];
        const char *value = i + 1 < count ? arguments[i + 1] : nullptr;
        if (option == "--smoke")
            is_smoke = true, trials = 3;
        else if (option == "--trials" && value)
            trials = std::max(1, std::atoi(arguments[++i]));
        else if (option == "--csv" && value)
            csv = std::fopen(arguments[++i], "w");
        else if (option == "--only" && value) {
            if (std::strcmp(value, "all")) return 0;
            break;
        } else
            bench::Run::fail("usage: [--trials N] [--csv FILE] [--smoke]");
    }
    if (csv) std::fprintf(csv, "fit,extent,method,steps,microseconds,error,failed_percent\n");
    const bool raced = races(trials, csv, is_smoke), started = basins(is_smoke ? trials : 2 * trials, csv, is_smoke);
    if (csv) std::fclose(csv);
    return raced && started ? 0 : 1;
}
