/* Hostile files: each is refused with the message that tests/hostile/expected.tsv gives; every cut of a good file is
 * refused; every allocation may fail. */
#include "support/failing.h"
#include "support/test.h"

#include <dirent.h>
#include <unistd.h>

#include "io/io.h"

enum { MOST_BYTES = 1 << 16 };

static size_t read_file(const char *folder, const char *name, unsigned char *to)
{
    char path[8192];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file) fail_msg("%s is missing", path);
    const size_t size = fread(to, 1, MOST_BYTES, file);
    fclose(file);
    return size;
}

static void every_hostile_file_is_refused_with_its_message(void **unused)
{
    (void)unused;
    static const char folder[] = TEST_SOURCE_DIR "/tests/hostile";
    static unsigned char bytes[MOST_BYTES];
    FILE *list = fopen(TEST_SOURCE_DIR "/tests/hostile/expected.tsv", "r");
    assert_non_null(list);
    char line[1024], expected[2048];
    size_t listed = 0, present = 0;
    while (fgets(line, sizeof line, list)) {
        char *tab = strchr(line, '\t');
        if (line[0] == '#' || !tab) continue;
        *tab = 0;
        tab[strcspn(tab + 1, "\n") + 1] = 0;
        const plm_read_options options = {.label_field = strncmp(line, "labels_", 7) ? NULL : "label"};
        plm_error error = {0};
        plm_cloud cloud = {.count = 77};
        plm_read_report report = {.rows = 77};
        const size_t size = read_file(folder, line, bytes);
        assert_int_equal(plm_cloud_parse(bytes, size, line, &options, &cloud, &report, &error), PLM_E_FORMAT);
        snprintf(expected, sizeof expected, "%s: %s", line, tab + 1);
        assert_string_equal(error.message, expected);
        assert_int_equal(cloud.count, 77); /* outputs are untouched */
        assert_int_equal(report.rows, 77);
        listed++;
    }
    fclose(list);
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory));) present += entry->d_name[0] != '.';
    closedir(directory);
    assert_int_equal(listed + 1, present); /* a file that is not listed is not tested */
}

static void files_that_are_none_are_named(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_cloud cloud;
    char *folder = test_make_folder(), path[8192];
    assert_int_equal(plm_cloud_read(folder, NULL, &cloud, NULL, &error), PLM_E_READ);
    assert_non_null(strstr(error.message, "is a folder"));
    snprintf(path, sizeof path, "%s/absent.ply", folder);
    assert_int_equal(plm_cloud_read(path, NULL, &cloud, NULL, &error), PLM_E_READ);
    assert_non_null(strstr(error.message, "absent.ply: cannot be opened"));
    for (size_t i = strlen(path); i < 3000; i++) path[i] = 'a';
    memcpy(path + 3000, "end.ply", 8);
    assert_int_equal(plm_cloud_read(path, NULL, &cloud, NULL, &error), PLM_E_READ);
    assert_non_null(strstr(error.message, "aaaend.ply: cannot be opened")); /* a long path loses its front */
    test_remove_folder(folder);
}

/* Good files of all formats, as they are written, and one of each that is not. */
static size_t good_file(int kind, const char *folder, unsigned char *bytes)
{
    static const char *const names[] = {"a.ply", "a.pcd", "a.csv"};
    static const char list[] = "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty list uchar uchar a\n"
                               "property float x\nproperty float y\nproperty float z\nend_header\n";
    plm_error error = {0};
    plm_cloud cloud;
    char path[8192];
    if (kind == 3) {
        memcpy(bytes, list, sizeof list - 1);
        memset(bytes + sizeof list - 1, 0, 26);
        return sizeof list - 1 + 26;
    }
    assert_ok(plm_cloud_create(3, PLM_HAS_RGB | PLM_HAS_NORMAL | PLM_HAS_LABEL | PLM_HAS_ORGAN, &cloud, &error));
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            cloud.xyz[i][k] = (float)(i * k) + 0.25f;
            cloud.rgb[i][k] = 7;
            cloud.normal[i][k] = k == 2;
        }
        cloud.label[i] = 3;
        cloud.organ[i] = i;
    }
    snprintf(path, sizeof path, "%s/%s", folder, names[kind]);
    assert_ok(plm_cloud_write(path, &cloud, &error));
    plm_cloud_free(&cloud);
    return read_file(folder, names[kind], bytes);
}

static const plm_read_options labelled = {
    .label_field = "label", .label_scheme = PLM_LABELS_INSTANCES, .stem_label = 3};

static void every_cut_of_a_good_file_is_refused(void **unused)
{
    (void)unused;
    static unsigned char bytes[MOST_BYTES];
    char *folder = test_make_folder();
    plm_error error = {0};
    plm_cloud cloud;
    for (int kind = 0; kind < 4; kind++) {
        if (kind == 2) continue; /* text has no end that a reader could know of */
        const size_t size = good_file(kind, folder, bytes);
        for (size_t cut = 0; cut < size; cut++) {
            unsigned char *exact = malloc(cut ? cut : 1); /* a block of its own, so that a sanitizer sees its end */
            assert_non_null(exact);
            memcpy(exact, bytes, cut);
            const plm_status status = plm_cloud_parse(exact, cut, "cut", NULL, &cloud, NULL, &error);
            free(exact);
            assert_int_equal(status, PLM_E_FORMAT);
        }
        assert_ok(plm_cloud_parse(bytes, size, "whole", NULL, &cloud, NULL, &error));
        plm_cloud_free(&cloud);
    }
    test_remove_folder(folder);
}

static void every_allocation_of_a_reader_may_fail(void **unused)
{
    (void)unused;
    static unsigned char bytes[MOST_BYTES];
    char *folder = test_make_folder();
    for (int kind = 0; kind < 4; kind++) {
        const size_t size = good_file(kind, folder, bytes);
        test_failing state = {0};
        const plm_allocator allocator = test_failing_allocator(&state);
        plm_status status = PLM_E_MEMORY;
        for (long at = 0; status != PLM_OK; at++) {
            plm_error error = {0};
            plm_cloud cloud = {.count = 77};
            state = (test_failing){.fail_at = at};
            plm_set_allocator(&allocator);
            status = plm_cloud_parse(bytes, size, "x", kind == 3 ? NULL : &labelled, &cloud, NULL, &error);
            if (status == PLM_OK) plm_cloud_free(&cloud);
            plm_set_allocator(NULL);
            assert_int_equal(state.alive, 0);
            if (status == PLM_OK)
                assert_true(at > 1);
            else
                assert_true(status == PLM_E_MEMORY && cloud.count == 77 && strstr(error.message, "out of memory"));
        }
    }
    test_remove_folder(folder);
}

static void every_allocation_of_a_writer_may_fail_and_leaves_no_file(void **unused)
{
    (void)unused;
    static const char *const names[] = {"b.ply", "b.pcd", "b.csv"};
    plm_error error = {0};
    plm_cloud cloud;
    char path[8192], *folder = test_make_folder();
    assert_ok(plm_cloud_create(2, 0, &cloud, &error));
    memset(cloud.xyz, 0, 2 * sizeof *cloud.xyz);
    for (size_t i = 0; i < COUNT(names); i++) {
        test_failing state = {0};
        const plm_allocator allocator = test_failing_allocator(&state);
        plm_status status = PLM_E_MEMORY;
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        for (long at = 0; status != PLM_OK; at++) {
            state = (test_failing){.fail_at = at};
            plm_set_allocator(&allocator);
            status = plm_cloud_write(path, &cloud, &error);
            plm_set_allocator(NULL);
            assert_int_equal(state.alive, 0);
            assert_int_equal(status == PLM_OK, access(path, F_OK) == 0);
        }
    }
    plm_cloud_free(&cloud);
    test_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_hostile_file_is_refused_with_its_message),
        cmocka_unit_test(files_that_are_none_are_named),
        cmocka_unit_test(every_cut_of_a_good_file_is_refused),
        cmocka_unit_test(every_allocation_of_a_reader_may_fail),
        cmocka_unit_test(every_allocation_of_a_writer_may_fail_and_leaves_no_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
