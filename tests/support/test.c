/* tests/support/test.c: helpers of all tests. */
#include "support/test.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

void test_near(double value, double expected, double tolerance, const char *text, const char *file, int line)
{
    if (fabs(value - expected) <= tolerance) return;
    print_error("%s is %.17g, expected %.17g +- %g\n", text, value, expected, tolerance);
    _fail(file, line);
}

void test_ok(plm_status status, const plm_error *error, const char *text, const char *file, int line)
{
    if (status == PLM_OK) return;
    print_error("%s: %s: %s\n", text, plm_status_name(status), error->message);
    _fail(file, line);
}

const char *test_data_folder(void)
{
    static char folder[4096];
    const char *given = getenv("PLANTIMETER_DATA");
    snprintf(folder, sizeof folder, "%s", given ? given : TEST_SOURCE_DIR "/../shared/data");
    struct stat found;
    if (stat(folder, &found) == 0 && S_ISDIR(found.st_mode)) return folder;
    print_message("skipped: no clouds with known truth at %s\n", folder);
    return NULL;
}

static uint64_t next(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

double test_uniform(uint64_t *state)
{
    return (double)(next(state) >> 11) * 0x1p-53;
}

double test_normal(uint64_t *state)
{
    const double radius = sqrt(-2.0 * log(1.0 - test_uniform(state)));
    return radius * cos(2.0 * 3.14159265358979323846 * test_uniform(state));
}

#ifndef __has_feature
#define __has_feature(feature) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

int test_grows_plants(void **unused)
{
    (void)unused;
    return 0;
}

/* Of how many plant cases one is run. */
static size_t plant_case_stride(void)
{
    const char *every = getenv("PLANTIMETER_EVERY_CASE");
    return SANITIZED && !(every && !strcmp(every, "1")) ? 3 : 1;
}

int test_run(const struct CMUnitTest *cases, size_t count)
{
    struct CMUnitTest *chosen = malloc(count * sizeof *chosen);
    if (!chosen) return EXIT_FAILURE;
    size_t kept = 0, plants = 0;
    for (size_t i = 0; i < count; i++)
        if (cases[i].setup_func != test_grows_plants || plants++ % plant_case_stride() == 0) chosen[kept++] = cases[i];
    if (kept < count)
        print_message("%zu of %zu cases left out: PLANTIMETER_EVERY_CASE=1 runs all\n", count - kept, count);
    const int failed = _cmocka_run_group_tests("cases", chosen, kept, NULL, NULL);
    free(chosen);
    return failed;
}

char *test_make_folder(void)
{
    char *folder = malloc(4096);
    assert_non_null(folder);
    const char *base = getenv("TMPDIR");
    snprintf(folder, 4096, "%s/plantimeter-test-XXXXXX", base ? base : "/tmp");
    assert_non_null(mkdtemp(folder));
    return folder;
}

static void remove_tree(const char *path)
{
    DIR *directory = opendir(path);
    if (directory) {
        for (struct dirent *entry; (entry = readdir(directory));) {
            if (!strcmp(entry->d_name, ".") || !strcmp(entry->d_name, "..")) continue;
            char child[8192];
            snprintf(child, sizeof child, "%s/%s", path, entry->d_name);
            remove_tree(child);
        }
        closedir(directory);
        rmdir(path);
    } else {
        unlink(path);
    }
}

void test_remove_folder(char *folder)
{
    remove_tree(folder);
    free(folder);
}
