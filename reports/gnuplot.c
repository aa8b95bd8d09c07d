/* reports/gnuplot.c: running gnuplot as a program. Its messages are kept off the terminal. */
#include "reports/plots.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* sh changes the folder, so that this process's own stays as it is, whatever its other threads do. */
plm_status plm_gnuplot_run(const char *folder, const char *script, bool *ran, plm_error *error)
{
    char *const arguments[] = {"sh",
                               "-c",
                               "cd \"$1\" && command -v gnuplot >/dev/null || exit 127; exec gnuplot \"$2\"",
                               "sh",
                               (char *)(uintptr_t)folder,
                               (char *)(uintptr_t)script,
                               NULL};
    posix_spawn_file_actions_t quiet;
    if (posix_spawn_file_actions_init(&quiet) != 0) return plm_fail(error, PLM_E_MEMORY, "out of memory for gnuplot");
    posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child;
    const int failure = posix_spawnp(&child, "sh", &quiet, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&quiet);
    if (failure != 0) return plm_fail(error, PLM_E_LIBRARY, "gnuplot cannot be run: %s", strerror(failure));
    int state = 0;
    while (waitpid(child, &state, 0) < 0)
        if (errno != EINTR) return plm_fail(error, PLM_E_LIBRARY, "gnuplot was lost: %s", strerror(errno));
    *ran = !(WIFEXITED(state) && WEXITSTATUS(state) == 127);
    if (*ran && !(WIFEXITED(state) && WEXITSTATUS(state) == 0))
        return plm_fail(error, PLM_E_LIBRARY, "gnuplot failed on %s/%s; run it there to see why", folder, script);
    return PLM_OK;
}
