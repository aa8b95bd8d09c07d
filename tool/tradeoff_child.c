/* tool/tradeoff_child.c: work in a child process, and what it has to say. */
#include "tool/tradeoff.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* All that comes until the other end is closed. */
static plm_status read_all(int fd, char **output, size_t *size, plm_error *error)
{
    size_t room = 0;
    *output = NULL;
    *size = 0;
    for (;;) {
        if (*size + 1 >= room) {
            room = 2 * room + 65536;
            char *grown = plm_realloc(*output, room, 1, error);
            if (!grown) return PLM_E_MEMORY;
            *output = grown;
        }
        const ssize_t got = read(fd, *output + *size, room - *size - 1);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return plm_fail(error, PLM_E_READ, "a child process cannot be read: %s", strerror(errno));
        if (got == 0) break;
        *size += (size_t)got;
    }
    (*output)[*size] = 0;
    return PLM_OK;
}

static plm_status judge(int state, unsigned limit, plm_error *error)
{
    if (WIFEXITED(state) && WEXITSTATUS(state) == 0) return PLM_OK;
    if (WIFEXITED(state)) return plm_fail(error, PLM_E_LIBRARY, "ended with exit code %d", WEXITSTATUS(state));
    if (WTERMSIG(state) == SIGALRM) return plm_fail(error, PLM_E_LIBRARY, "took longer than %u s", limit);
    if (WTERMSIG(state) == SIGKILL) return plm_fail(error, PLM_E_LIBRARY, "was killed, as for want of memory");
    return plm_fail(error, PLM_E_LIBRARY, "crashed by signal %d", WTERMSIG(state));
}

plm_status tradeoff_in_child(int (*work)(void *user, int fd), void *user, unsigned limit, char **output, size_t *size,
                             plm_error *error)
{
    int end[2];
    *output = NULL;
    if (pipe(end) != 0) return plm_fail(error, PLM_E_LIBRARY, "no pipe to a child process: %s", strerror(errno));
    const pid_t child = fork();
    if (child < 0) {
        close(end[0]);
        close(end[1]);
        return plm_fail(error, PLM_E_LIBRARY, "no child process: %s", strerror(errno));
    }
    if (child == 0) {
        close(end[0]);
        if (limit) alarm(limit); /* outlives an exec */
        _exit(work(user, end[1]));
    }
    close(end[1]);
    plm_status status = read_all(end[0], output, size, error);
    close(end[0]);
    int state = 0;
    while (waitpid(child, &state, 0) < 0 && errno == EINTR) continue;
    if (status == PLM_OK) status = judge(state, limit, error);
    if (status != PLM_OK) {
        plm_free(*output);
        *output = NULL;
    }
    return status;
}
