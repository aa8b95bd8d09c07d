/* A big file that someone cuts, or rewrites shorter, while it is read: what was read stands, and no signal ends the process. */
#include "support/test.h"

#include "io/bytes.h"

#include <fcntl.h>
#include <unistd.h>

enum { SIZE = 20 << 20 }; /* larger than what is read in one go */

static unsigned char byte_at(size_t i)
{
    return (unsigned char)(i * 2654435761u >> 13);
}

static void a_file_cut_behind_the_readers_back_is_still_there(void **unused)
{
    (void)unused;
    char *folder = test_make_folder(), path[4096];
    snprintf(path, sizeof path, "%s/cut", folder);
    const int file = open(path, O_RDWR | O_CREAT | O_EXCL, 0600);
    assert_true(file >= 0);
    unsigned char *all = plm_alloc(SIZE, 1, NULL);
    assert_non_null(all);
    for (size_t i = 0; i < SIZE; i++) all[i] = byte_at(i);
    assert_int_equal(write(file, all, SIZE), SIZE);
    plm_error error = {0};
    plm_bytes bytes;
    assert_ok(plm_bytes_open(path, &bytes, &error));
    assert_int_equal(ftruncate(file, 4096), 0);
    assert_int_equal(bytes.size, SIZE);
    assert_memory_equal(bytes.data, all, SIZE); /* a mapping would end the process here */
    plm_bytes_drop(&bytes, bytes.data, SIZE / 2);
    assert_memory_equal(bytes.data + SIZE / 2 + 8192, all + SIZE / 2 + 8192, SIZE / 2 - 8192);
    plm_bytes_close(&bytes);
    plm_free(all);
    close(file);
    test_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_file_cut_behind_the_readers_back_is_still_there)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
