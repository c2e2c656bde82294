/* SPDX-License-Identifier: Apache-2.0 */
/* Child processes by fork and exec. Between the two the child calls only async-signal-safe
 * functions, since other threads of the parent may hold locks. It leads its own process group, so
 * that its children are killed with it, and terminal interrupts reach it only through the
 * parent. */
#include "core/process.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "core/memory.h"

enum { NOT_FOUND = 127, FIRST_NAP = 1000000, LONGEST_NAP = 20000000 }; /* naps in nanoseconds */

/* Of processor time: how busy the machine is does not count. A program that goes on after the
 * signal is killed a second later. */
static void limit_time(double seconds) {
    const rlim_t whole = seconds < 1e9 ? (rlim_t)ceil(seconds) : RLIM_INFINITY - 1;
    setrlimit(RLIMIT_CPU, &(struct rlimit){whole, whole + 1});
    signal(SIGXCPU, SIG_DFL);
}

/* Runs in the child; never returns. Where supported, the child dies with its parent. */
static void exec_child(const char *const *arguments, const starg_process_options *options,
                       const int *kept) {
    setpgid(0, 0);
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
    limit_time(options->seconds);
#ifndef __SANITIZE_ADDRESS__ /* its shadow takes terabytes of addresses */
    if (options->memory > 0)
        setrlimit(RLIMIT_AS, &(struct rlimit){options->memory, options->memory});
#endif
    int nothing = open("/dev/null", O_RDWR);
    for (int stream = 0; stream < 3 && nothing >= 0; stream++)
        dup2(kept[stream] >= 0 ? kept[stream] : nothing, stream);
    signal(SIGPIPE, SIG_DFL);
    signal(SIGXFSZ, SIG_DFL);
    union { /* exec takes non-const pointers but does not write */
        const char *const *given;
        char *const *taken;
    } words = {.given = arguments};
    execvp(arguments[0], words.taken);
    _exit(NOT_FOUND);
}

static starg_status took_too_long(starg_context *context, const char *stage, const char *program) {
    return starg_fail(context, STARG_ERROR_SOLVER, stage, "'%s' took too long and was stopped",
                      program);
}

static starg_status explain(starg_context *context, const char *stage, const char *program,
                            int status) {
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
        return took_too_long(context, stage, program);
    if (WIFSIGNALED(status))
        return starg_fail(context, STARG_ERROR_SOLVER, stage, "'%s' was terminated by signal %d",
                          program, WTERMSIG(status));
    if (WEXITSTATUS(status) == NOT_FOUND)
        return starg_fail(context, STARG_ERROR_SOLVER, stage,
                          "'%s' cannot be run; is it installed?", program);
    if (WEXITSTATUS(status) != 0)
        return starg_fail(context, STARG_ERROR_SOLVER, stage, "'%s' failed with status %d", program,
                          WEXITSTATUS(status));
    return STARG_OK;
}

/* Checks cancellation and time while waiting. */
static starg_status check_stop(starg_context *context, const char *stage, const char *program) {
    starg_status status = starg_check_cancel(context, stage);
    if (status == STARG_OK && starg_time_is_over(context))
        status = took_too_long(context, stage, program);
    return status;
}

static starg_status await(starg_context *context, const char *stage, const char *program,
                          pid_t child) {
    struct timespec nap = {0, FIRST_NAP};
    for (;;) {
        int status;
        pid_t ended = waitpid(child, &status, WNOHANG);
        if (ended == child)
            return explain(context, stage, program, status);
        if (ended < 0 && errno != EINTR)
            return starg_fail(context, STARG_ERROR_SOLVER, stage, "'%s' was lost: %s", program,
                              strerror(errno));
        starg_status reason = check_stop(context, stage, program);
        if (reason != STARG_OK) {
            kill(-child, SIGKILL);
            kill(child, SIGKILL); /* it may have no group yet */
            while (waitpid(child, &status, 0) < 0 && errno == EINTR)
                continue;
            return reason;
        }
        nanosleep(&nap, NULL);
        if (nap.tv_nsec < LONGEST_NAP)
            nap.tv_nsec *= 2;
    }
}

/* ---- what it writes ---- */

/* A file without a name. */
static starg_status open_nameless(starg_context *context, const char *stage, FILE **out) {
    *out = tmpfile();
    if (*out != NULL)
        return STARG_OK;
    return starg_fail(context, STARG_ERROR_WRITE, stage, "cannot make a temporary file: %s",
                      strerror(errno));
}

static starg_status take_output(starg_context *context, const char *stage, FILE *file,
                                const starg_process_options *options) {
    starg_status status = STARG_OK;
    struct stat info;
    rewind(file);
    if (fstat(fileno(file), &info) != 0)
        return starg_fail(context, STARG_ERROR_READ, stage, "cannot read a temporary file: %s",
                          strerror(errno));
    *options->size = (size_t)info.st_size;
    STARG_NEW(context, stage, *options->output, *options->size + 1);
    if (fread(*options->output, 1, *options->size, file) != *options->size) {
        status = starg_fail(context, STARG_ERROR_READ, stage, "cannot read a temporary file");
        starg_release(context, *options->output);
        *options->output = NULL;
    }
done:
    return status;
}

static void take_complaint(FILE *file, const starg_process_options *options) {
    char line[256];
    rewind(file);
    options->complaint[0] = '\0';
    while (fgets(line, sizeof line, file) != NULL) {
        line[strcspn(line, "\r\n")] = '\0';
        if (line[0] != '\0')
            snprintf(options->complaint, options->room, "%s", line);
    }
}

starg_status starg_process_run_with(starg_context *context, const char *stage,
                                    const char *const *arguments,
                                    const starg_process_options *options) {
    starg_status status = STARG_OK;
    FILE *output = NULL, *errors = NULL;
    if (options->output != NULL)
        STARG_TRY(open_nameless(context, stage, &output));
    if (options->complaint != NULL)
        STARG_TRY(open_nameless(context, stage, &errors));
    const int kept[3] = {-1, output != NULL ? fileno(output) : -1,
                         errors != NULL ? fileno(errors) : -1};
    pid_t child = fork();
    if (child == 0)
        exec_child(arguments, options, kept);
    if (child < 0)
        status = starg_fail(context, STARG_ERROR_SOLVER, stage, "cannot start '%s': %s",
                            arguments[0], strerror(errno));
    else
        status = await(context, stage, arguments[0], child);
    if (errors != NULL)
        take_complaint(errors, options);
    if (status == STARG_OK && output != NULL)
        status = take_output(context, stage, output, options);
done:
    if (output != NULL)
        fclose(output);
    if (errors != NULL)
        fclose(errors);
    return status;
}

starg_status starg_process_run(starg_context *context, const char *stage,
                               const char *const *arguments, double seconds) {
    const starg_process_options options = {.seconds = seconds};
    return starg_process_run_with(context, stage, arguments, &options);
}

starg_status starg_scratch_create(starg_context *context, const char *stage, char **path) {
    static const char name[] = "/starguard-XXXXXX";
    starg_status status = STARG_OK;
    const char *parent = getenv("TMPDIR");
    *path = NULL;
    if (parent == NULL || *parent == '\0')
        parent = "/tmp";
    size_t length = strlen(parent);
    STARG_NEW(context, stage, *path, length + sizeof name);
    memcpy(*path, parent, length);
    memcpy(*path + length, name, sizeof name);
    if (mkdtemp(*path) == NULL) {
        status = starg_fail(
            context, STARG_ERROR_WRITE, stage,
            "cannot create a temporary folder in '%s': %s; set TMPDIR to a writable folder", parent,
            strerror(errno));
        starg_release(context, *path);
        *path = NULL;
    }
done:
    return status;
}

void starg_scratch_remove(starg_context *context, char *path) {
    if (path == NULL)
        return;
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder != NULL && (entry = readdir(folder)) != NULL;)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            unlinkat(dirfd(folder), entry->d_name, 0);
    if (folder != NULL)
        closedir(folder);
    rmdir(path);
    starg_release(context, path);
}
