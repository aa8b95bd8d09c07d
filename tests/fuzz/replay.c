/* tests/fuzz/replay.c: runs files through a fuzz target without a fuzzer. Arguments: files and folders of files. */
#include "fuzz.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

enum { MOST_BYTES = 1 << 20 };

static int replay_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = malloc(MOST_BYTES);
    const int is_read = file && bytes;
    if (is_read)
        LLVMFuzzerTestOneInput(bytes, fread(bytes, 1, MOST_BYTES, file));
    else
        fprintf(stderr, "%s cannot be read\n", path);
    free(bytes);
    if (file) fclose(file);
    return is_read;
}

static int replay(const char *path)
{
    DIR *folder = opendir(path);
    int count = 0;
    if (!folder) return replay_file(path);
    for (struct dirent *entry; (entry = readdir(folder));) {
        char child[4096];
        struct stat found;
        snprintf(child, sizeof child, "%s/%s", path, entry->d_name);
        if (entry->d_name[0] != '.' && stat(child, &found) == 0 && S_ISREG(found.st_mode)) count += replay_file(child);
    }
    closedir(folder);
    return count;
}

int main(int count, char **arguments)
{
    int replayed = 0;
    for (int i = 1; i < count; i++) replayed += replay(arguments[i]);
    printf("%d files\n", replayed);
    return replayed ? 0 : 1;
}
