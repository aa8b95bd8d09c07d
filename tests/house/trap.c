/* tests/house/trap.c: preloaded into the program (LD_PRELOAD), traps invalid operations, divisions by zero and overflows of
 * floating-point arithmetic. Every place that raises one is written to standard error once, as the return addresses that
 * lead there, and the program goes on: one run finds them all. x86-64 and glibc. The program must be built with
 * -ftrapping-math, or the compiler raises some itself. */
#define _GNU_SOURCE
#include <execinfo.h>
#include <fenv.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <ucontext.h>

enum {
    DEPTH = 24,
    PLACES = 256,
    FLAGS = 0x3f,
    TRAP_MASKS = (FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW) << 7,
    ONE_STEP = 0x100
};

static volatile greg_t seen[PLACES]; /* two threads may write one place twice: harmless */
static volatile int seen_count;

/* Writes the place, then lets the one instruction pass with its exception masked. */
static void on_exception(int number, siginfo_t *info, void *context)
{
    (void)number;
    ucontext_t *at = context;
    const greg_t place = at->uc_mcontext.gregs[REG_RIP];
    int i = 0;
    while (i < seen_count && seen[i] != place) i++;
    if (i == seen_count && i < PLACES) {
        seen[seen_count++] = place;
        const char *what = info->si_code == FPE_FLTDIV   ? "divide by zero"
                           : info->si_code == FPE_FLTOVF ? "overflow"
                                                         : "invalid";
        void *frame[DEPTH];
        fprintf(stderr, "floating-point trap: %s\n", what);
        backtrace_symbols_fd(frame, backtrace(frame, DEPTH), 2);
    }
    at->uc_mcontext.fpregs->mxcsr |= TRAP_MASKS;
    at->uc_mcontext.gregs[REG_EFL] |= ONE_STEP;
}

static void on_step(int number, siginfo_t *info, void *context)
{
    (void)number, (void)info;
    ucontext_t *at = context;
    at->uc_mcontext.fpregs->mxcsr &= ~(uint32_t)(TRAP_MASKS | FLAGS);
    at->uc_mcontext.gregs[REG_EFL] &= ~(greg_t)ONE_STEP;
}

/* Threads inherit what is enabled from the thread that starts them. */
__attribute__((constructor)) static void arm(void)
{
    void *frame[2];
    backtrace(frame, 2); /* loads what it needs now: not in the handler */
    sigaction(SIGFPE, &(struct sigaction){.sa_sigaction = on_exception, .sa_flags = SA_SIGINFO}, NULL);
    sigaction(SIGTRAP, &(struct sigaction){.sa_sigaction = on_step, .sa_flags = SA_SIGINFO}, NULL);
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
}
