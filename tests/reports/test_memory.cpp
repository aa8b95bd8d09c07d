/* Every allocation of a small measurement fails in turn, those of the C++ libraries too: each gives a status and a message,
 * nothing is lost and no half of a file is left. */
extern "C" {
#include "support/test.h"

#include "reports/export.h"
#include "reports/plant_files.h"
#include "reports/report.h"
#include "reports/run_json.h"
#include "reports/view_file.h"
}

#include <dirent.h>
#include <new>
#include <string>

namespace
{
/* Counts allocations from both seams, and fails the one whose turn it is. */
struct counter {
    long made, fails_at, live;
    bool is_counting, has_failed;
} seam;

bool must_fail()
{
    if (!__atomic_load_n(&seam.is_counting, __ATOMIC_RELAXED)) return false;
    if (__atomic_fetch_add(&seam.made, 1, __ATOMIC_RELAXED) != seam.fails_at) return false;
    seam.has_failed = true;
    return true;
}

void *reallocate(void *block, size_t size, void *)
{
    if (must_fail()) return nullptr;
    if (!block) __atomic_fetch_add(&seam.live, 1, __ATOMIC_RELAXED);
    return realloc(block, size);
}

void release(void *block, void *)
{
    if (block) __atomic_fetch_sub(&seam.live, 1, __ATOMIC_RELAXED);
    free(block);
}
} // namespace

void *operator new(size_t size)
{
    if (must_fail()) throw std::bad_alloc();
    if (void *block = malloc(size ? size : 1)) return block;
    throw std::bad_alloc();
}

void operator delete(void *block) noexcept
{
    free(block);
}

void operator delete(void *block, size_t) noexcept
{
    free(block);
}

/* CGAL's container drops the block it has just got when the list of its blocks cannot grow: LeakSanitizer, which reads
 * this name of its own, would tell of nothing else. Leaks of ours show in the count of live blocks. */
extern "C" __attribute__((visibility("default"))) int __lsan_is_turned_off()
{
    return 1;
}

namespace
{
/* A stem and leaves on a grid, labelled or not, as a text file. */
void write_plant(const std::string &path, bool labelled)
{
    FILE *file = fopen(path.c_str(), "w");
    assert_non_null(file);
    fprintf(file, labelled ? "x,y,z,red,green,blue,label,organ\n" : "x,y,z,red,green,blue\n");
    for (int i = 0; i < 200; i++) {
        fprintf(file, "%.6f,%.6f,%.6f,90,140,60", 0.002 * cos(i * 0.7), 0.002 * sin(i * 0.7), i * 0.0005);
        fprintf(file, labelled ? ",1,0\n" : "\n");
    }
    for (int leaf = 0; leaf < 2; leaf++)
        for (int i = 0; i < 20; i++)
            for (int j = 0; j < 12; j++) {
                const double u = 0.004 + 0.0015 * i, v = 0.0015 * (j - 6), turn = 2.5 * leaf;
                fprintf(file, "%.6f,%.6f,%.6f,60,160,50", u * cos(turn) - v * sin(turn), u * sin(turn) + v * cos(turn),
                        0.05 + 0.03 * leaf + 0.2 * u);
                fprintf(file, labelled ? ",3,%d\n" : "\n", leaf);
            }
    fclose(file);
}

/* Paths of the outputs, made before anything is counted. */
struct paths {
    explicit paths(const std::string &folder)
        : input(folder + "/plant.csv"), labelled(folder + "/plant.labelled.ply"), leaves(folder + "/plant.leaves.ply"),
          picture(folder + "/plant.png"), traits(folder + "/traits.csv"), plants(folder + "/plants.csv"),
          record(folder + "/run.json"), view(folder + "/plant.view.json"), home(folder)
    {
    }
    std::string input, labelled, leaves, picture, traits, plants, record, view, home;
};

/** What is repeated, each time with another allocation that fails. */
typedef plm_status (*task)(const paths &files, plm_error *error);

plm_status measure_plant(const paths &files, const char *label, const char *traits, plm_measurement *plant,
                         plm_error *error)
{
    plm_read_options reading = {};
    reading.label_field = label;
    plm_cloud cloud;
    const plm_status status = plm_cloud_read(files.input.c_str(), &reading, &cloud, nullptr, error);
    if (status != PLM_OK) return status;
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = traits;
    return plm_measure(&cloud, &options, plant, error);
}

plm_status measure_labelled(const paths &files, plm_error *error)
{
    plm_measurement plant;
    const plm_status status = measure_plant(files, "label", nullptr, &plant, error);
    if (status == PLM_OK) plm_measurement_free(&plant);
    return status;
}

plm_status measure_unlabelled(const paths &files, plm_error *error)
{
    plm_measurement plant;
    const plm_status status = measure_plant(files, nullptr, "leaf_count", &plant, error);
    if (status == PLM_OK) plm_measurement_free(&plant);
    return status;
}

/* Measured before any failure. */
plm_measurement measured;

plm_status write_picture(const paths &files, plm_error *error)
{
    const plm_plant_report report = {"plant", &measured, nullptr, nullptr};
    return plm_write_picture(files.picture.c_str(), &report, error);
}

plm_status write_cloud_and_meshes(const paths &files, plm_error *error)
{
    plm_input_frame frame = {};
    frame.metres_per_unit = 1;
    frame.xyz = measured.cloud.xyz;
    plm_status status = plm_write_labelled_cloud(files.labelled.c_str(), &measured, &frame, error);
    if (status == PLM_OK) status = plm_write_leaf_meshes(files.leaves.c_str(), &measured, &frame, error);
    return status;
}

plm_status write_tables(const paths &files, plm_error *error)
{
    const plm_plant_report report = {"plant", &measured, nullptr, nullptr};
    char file[1][64 + 256] = {"plant.png"};
    plm_run_plant record = {};
    record.report = &report;
    record.input = "plant.csv";
    record.sha256 = "";
    record.unit_evidence = "given";
    record.file = file;
    record.file_count = 1;
    plm_results results = {};
    json_t *object = nullptr, *options = nullptr, *shown = nullptr;
    plm_status status = plm_run_plant_json(&record, &object, error);
    if (status == PLM_OK) status = plm_results_add(&results, &report, 0, object, error);
    if (status == PLM_OK) status = plm_results_write_traits(&results, files.traits.c_str(), error);
    if (status == PLM_OK) status = plm_results_write_plants(&results, files.plants.c_str(), error);
    if (status == PLM_OK) {
        options = json_object();
        status = plm_json_check(options, error);
    }
    if (status == PLM_OK) status = plm_run_json_write(files.record.c_str(), options, &results, error);
    if (status == PLM_OK) status = plm_results_json(&results, &shown, error);
    json_decref(shown);
    json_decref(options);
    plm_results_free(&results);
    return status;
}

plm_status write_view(const paths &files, plm_error *error)
{
    return plm_write_view(files.view.c_str(), "plant", &measured, nullptr, error);
}

/* The page from tables, picture and view that are there. */
plm_status write_page(const paths &files, plm_error *error)
{
    const plm_report_options options = {nullptr, 1, false};
    bool has_view;
    return plm_report_write(files.home.c_str(), &options, &has_view, error);
}

/* What a run leaves in its folder, once; the first call is without failures. */
plm_status write_run(const paths &files, plm_error *error)
{
    static std::string written;
    if (written == files.home) return PLM_OK;
    plm_status status = write_tables(files, error);
    if (status == PLM_OK) status = write_picture(files, error);
    if (status == PLM_OK) status = write_view(files, error);
    if (status == PLM_OK) written = files.home;
    return status;
}

plm_status write_run_and_page(const paths &files, plm_error *error)
{
    const plm_status status = write_run(files, error);
    return status == PLM_OK ? write_page(files, error) : status;
}

plm_status write_run_and_exports(const paths &files, plm_error *error)
{
    plm_status status = write_run(files, error);
    const plm_export_options options = {};
    plm_export run = {};
    const char *folder = files.home.c_str();
    if (status == PLM_OK) status = plm_export_open(&run, folder, &options, error);
    if (status == PLM_OK) status = plm_export_field_book(&run, folder, error);
    if (status == PLM_OK) status = plm_export_brapi(&run, folder, error);
    if (status == PLM_OK) status = plm_export_miappe(&run, folder, error);
    if (status == PLM_OK) status = plm_export_frictionless(&run, folder, error);
    if (status == PLM_OK) status = plm_export_statgen(&run, folder, error);
    plm_export_close(&run);
    return status;
}

/* Files that were not finished. */
int count_parts(const std::string &folder)
{
    int parts = 0;
    DIR *directory = opendir(folder.c_str());
    assert_non_null(directory);
    while (const dirent *entry = readdir(directory)) parts += strstr(entry->d_name, ".part") != nullptr;
    closedir(directory);
    return parts;
}

/* Each allocation in turn takes minutes: that is for PLANTIMETER_EVERY_ALLOCATION=1. Else the first ones are failed each, and
 * later ones at distances that grow by 4 %. */
double usual_growth()
{
    return getenv("PLANTIMETER_EVERY_ALLOCATION") ? 1 : 1.04;
}

/* Runs the task with allocation number 0, 1, ... failing, until none does; growth 1: each of them, more: fewer and fewer. */
void fail_each(const std::string &folder, const paths &files, task run, double growth)
{
    plm_error error = {};
    if (run(files, &error) != PLM_OK) fail_msg("without failures: %s", error.message); /* makes what is made once */
    long failures = 0;
    for (double at = 0;; at = at * growth + 1) {
        const long live = seam.live;
        seam.made = 0;
        seam.fails_at = static_cast<long>(at);
        seam.has_failed = false;
        seam.is_counting = true;
        error = {};
        const plm_status status = run(files, &error);
        seam.is_counting = false;
        if (seam.live != live) fail_msg("allocation %ld failed: %ld blocks are lost", seam.fails_at, seam.live - live);
        if (!seam.has_failed) break;
        failures++;
        if (status == PLM_OK) fail_msg("allocation %ld failed, and nobody noticed", seam.fails_at);
        if (!error.message[0]) fail_msg("allocation %ld failed without a message", seam.fails_at);
        if (count_parts(folder)) fail_msg("allocation %ld failed and left half a file", seam.fails_at);
    }
    print_message("%ld failures of some %ld allocations\n", failures, seam.made);
    assert_true(failures > 3);
}

/* A task in a folder of its own, with a labelled plant or not. */
void fail_task(task run, bool labelled, double growth)
{
    const plm_allocator allocator = {reallocate, release, nullptr};
    plm_set_allocator(&allocator);
    char *made = test_make_folder();
    {
        const std::string folder = made;
        const paths files(folder);
        write_plant(files.input, labelled);
        plm_error error = {};
        if (measure_plant(files, labelled ? "label" : nullptr, labelled ? nullptr : "leaf_count", &measured, &error) !=
            PLM_OK)
            fail_msg("%s", error.message);
        fail_each(folder, files, run, growth);
        plm_measurement_free(&measured);
    }
    test_remove_folder(made);
    plm_set_allocator(nullptr);
}

void allocations_of_measuring_a_labelled_plant_may_fail(void **)
{
    fail_task(measure_labelled, true, usual_growth());
}

void allocations_of_segmenting_may_fail(void **)
{
    fail_task(measure_unlabelled, false, 1.1);
}

void allocations_of_the_picture_may_fail(void **)
{
    fail_task(write_picture, true, usual_growth());
}

void allocations_of_the_view_may_fail(void **)
{
    fail_task(write_view, true, usual_growth());
}

void allocations_of_the_page_may_fail(void **)
{
    fail_task(write_run_and_page, true, usual_growth());
}

void allocations_of_the_exports_may_fail(void **)
{
    fail_task(write_run_and_exports, true, usual_growth());
}

void allocations_of_the_cloud_and_the_meshes_may_fail(void **)
{
    fail_task(write_cloud_and_meshes, true, usual_growth());
}

void allocations_of_the_tables_may_fail(void **)
{
    fail_task(write_tables, true, usual_growth());
}
} // namespace

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(allocations_of_measuring_a_labelled_plant_may_fail),
        cmocka_unit_test(allocations_of_segmenting_may_fail),
        cmocka_unit_test(allocations_of_the_picture_may_fail),
        cmocka_unit_test(allocations_of_the_view_may_fail),
        cmocka_unit_test(allocations_of_the_page_may_fail),
        cmocka_unit_test(allocations_of_the_exports_may_fail),
        cmocka_unit_test(allocations_of_the_cloud_and_the_meshes_may_fail),
        cmocka_unit_test(allocations_of_the_tables_may_fail),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
