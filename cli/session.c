/* SPDX-License-Identifier: Apache-2.0 */
#include "session.h"

#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "commands.h"

bool cli_terminal(FILE *stream) {
    const char *type = getenv("TERM");
    return isatty(fileno(stream)) == 1 && type != NULL && strcmp(type, "dumb") != 0;
}

/* NO_COLOR counts if it is set and not empty (no-color.org). */
static bool has_colors(FILE *stream) {
    const char *refused = getenv("NO_COLOR");
    return (refused == NULL || *refused == '\0') && cli_terminal(stream);
}

const char *cli_style_on(FILE *stream, cli_style style) {
    static const char *const sequences[] = {"\033[1m", "\033[31m", "\033[32m", "\033[33m"};
    return has_colors(stream) ? sequences[style] : "";
}

const char *cli_style_off(FILE *stream) {
    return has_colors(stream) ? "\033[0m" : "";
}

static const double PATIENCE = 1.0; /* seconds before a stage gets a bar */
static const double REDRAW = 0.1;

double cli_clock(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* NULL if there are too many stages: the excess is not timed and has no bar. */
static cli_stage *find_stage(cli_progress *progress, const char *name) {
    for (size_t i = 0; i < progress->count; i++)
        if (strcmp(progress->stages[i].name, name) == 0)
            return &progress->stages[i];
    if (progress->count == CLI_STAGES)
        return NULL;
    cli_stage *stage = &progress->stages[progress->count++];
    *stage = (cli_stage){.name = name};
    return stage;
}

/* A starg_progress_fn; `user` is a cli_progress. Never cancels: signals do. */
static bool cli_progress_report(void *user, const char *name, double fraction) {
    cli_progress *progress = user;
    cli_stage *stage = find_stage(progress, name);
    if (stage == NULL)
        return true;
    double now = cli_clock();
    if (fraction >= 1) {
        cli_progress_erase(progress);
        if (stage->running)
            stage->seconds += now - stage->began;
        stage->running = false;
        return true;
    }
    if (!stage->running) {
        stage->began = now;
        stage->running = true;
    }
    bool due = now - stage->began >= PATIENCE && now - progress->drawn_at >= REDRAW;
    if (progress->bar && due && fraction > 0) {
        cli_progress_draw(progress, stage, progress->context, fraction, now - stage->began);
        progress->drawn_at = now;
    }
    return true;
}

typedef cli_common values;

const cli_option cli_common_options[] = {
    CLI_COUNT_OPTION("threads", threads, "N", 0, 1024, 0, "0, all cores",
                     "Number of threads. Results do not depend on it."),
    CLI_COUNT_OPTION("seed", seed, "N", 0, UINT64_MAX, 1, NULL, "Seed for random numbers."),
    CLI_POSITIVE_OPTION("time-limit", time_limit, "S", 1e9, 0, "none",
                        "Stop after S seconds. Searches return their best result; without one, the "
                        "exit status is 3."),
    CLI_FLAG_OPTION("keep-best", keep_best,
                    "On Ctrl-C end searches and write their best result; a second one cancels."),
    CLI_FLAG_OPTION("quiet", quiet, "Print only warnings and errors."),
    CLI_FLAG_OPTION("verbose", verbose, "Print details, too."),
    CLI_FLAG_OPTION("json", json,
                    "Print one JSON object to standard output instead of text (docs/formats.md)."),
    {CLI_OPTION("help", STARG_FIELD_FLAG, help, NULL,
                "Show help; '--help all' and '--help GROUP' show more."),
     .letter = 'h'},
    CLI_FLAG_OPTION("version", version, "Show the version."),
};
const size_t cli_common_option_count = sizeof cli_common_options / sizeof *cli_common_options;

/* ---- signals ---- */

/* The context for the signal handler, which has no other access to it. */
static starg_context *volatile signal_context;
static volatile sig_atomic_t signal_count, signals_to_finish;

/* The first one may end searches only, the next two request cancellation; then one kills. */
static void on_signal(int number) {
    signal_count = signal_count + 1;
    if (signal_context != NULL && signal_count <= signals_to_finish)
        starg_context_finish(signal_context);
    else if (signal_context != NULL)
        starg_context_cancel(signal_context);
    if (signal_count >= 3 + signals_to_finish) {
        signal(number, SIG_DFL);
        raise(number);
    }
}

static void catch_signals(void) {
    struct sigaction action = {.sa_handler = on_signal}, old;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    if (sigaction(SIGHUP, NULL, &old) == 0 && old.sa_handler != SIG_IGN)
        sigaction(SIGHUP, &action, NULL);
    /* Failed writes must return an error, not kill the process. */
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
}

void cli_say_limited(cli_session *session) {
    cli_say(session, "%s; this is the best result found\n",
            signal_count > 0 ? "interrupted   on request" : "time limit    reached");
}

/* ---- start ---- */

static void on_log(void *user, starg_log_level level, const char *message) {
    cli_session *session = user;
    cli_report_log(session, level, message);
    if (level == STARG_LOG_WARNING) {
        cli_warn(session, "%swarning:%s %s", cli_style_on(stderr, CLI_YELLOW),
                 cli_style_off(stderr), message);
    } else if (!session->common.quiet) {
        cli_progress_erase(&session->progress);
        fprintf(stderr, "starguard %s: %s\n", session->command->name, message);
    }
}

void cli_session_init(cli_session *session, const cli_command *command) {
    *session = (cli_session){.command = command, .began = cli_clock()};
}

starg_status cli_session_start(cli_session *session) {
    const cli_common *common = &session->common;
    starg_context_options options;
    starg_context_options_default(&options);
    options.threads = common->threads > 0 ? (int)common->threads : cli_ranks_threads();
    options.seed = common->seed;
    options.log = on_log;
    options.log_user = session;
    options.progress = cli_progress_report;
    options.progress_user = &session->progress;
    session->progress.bar = !common->quiet && cli_progress_visible();
    if (common->json)
        cli_report_begin(session);

    starg_status status = starg_context_create(&options, &session->context);
    if (status != STARG_OK)
        return cli_fail(session, status, "%s", starg_status_string(status));
    starg_context_set_ranks(session->context, cli_ranks());
    signal_context = session->context;
    session->progress.context = session->context;
    signals_to_finish = session->common.keep_best;
    catch_signals();
    if (common->time_limit > 0)
        starg_context_set_time_limit(session->context, common->time_limit);
    return STARG_OK;
}

/* Reports why a name is not accepted as an output. */
static starg_status fail_output(cli_session *session) {
    return cli_fail(session, session->outputs.clash ? STARG_ERROR_ARGUMENT : STARG_ERROR_WRITE,
                    "%s", session->outputs.message);
}

/* TetGen's tetrahedra are read from two files, either of which may be named. */
static bool add_pair(cli_session *session, const char *name) {
    const char *other = cli_has_extension(name, ".node")  ? ".ele"
                        : cli_has_extension(name, ".ele") ? ".node"
                                                          : NULL;
    char path[PATH_MAX];
    if (other == NULL || strlen(name) + strlen(other) >= sizeof path)
        return true;
    snprintf(path, sizeof path, "%.*s%s", (int)(strrchr(name, '.') - name), name, other);
    return cli_outputs_add_input(&session->outputs, path);
}

starg_status cli_name_input(cli_session *session, const char *name) {
    if (name == NULL || session->command->in_place)
        return STARG_OK;
    if (!cli_outputs_add_input(&session->outputs, name) || !add_pair(session, name))
        return fail_output(session);
    return STARG_OK;
}

starg_status cli_announce(cli_session *session, const char *name) {
    if (name == NULL)
        return STARG_OK;
    if (strcmp(name, "-") == 0) {
        if (session->common.json)
            return cli_fail(session, STARG_ERROR_ARGUMENT,
                            "--json and output '-' both use standard output; give a file name");
        if (session->stdout_taken)
            return cli_fail(session, STARG_ERROR_ARGUMENT,
                            "only one output may be '-' (standard output)");
        session->stdout_taken = true;
        return STARG_OK;
    }
    return cli_outputs_add(&session->outputs, name) ? STARG_OK : fail_output(session);
}

starg_status cli_announce_needed(cli_session *session, const char *name, const char *form) {
    if (name == NULL)
        return cli_fail(session, STARG_ERROR_ARGUMENT, "no output; add -o %s", form);
    return cli_announce(session, name);
}

starg_status cli_announce_folder(cli_session *session, const char *name) {
    if (name == NULL || cli_outputs_add_folder(&session->outputs, name))
        return STARG_OK;
    return fail_output(session);
}

/* ---- text ---- */

void cli_log(cli_session *session, starg_log_level level, const char *format, ...) {
    char text[sizeof session->message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    on_log(session, level, text);
}

void cli_say(cli_session *session, const char *format, ...) {
    if (session->common.quiet || session->common.json)
        return;
    cli_progress_erase(&session->progress);
    va_list arguments;
    va_start(arguments, format);
    vfprintf(session->stdout_taken ? stderr : stdout, format, arguments);
    va_end(arguments);
}

void cli_warn(cli_session *session, const char *format, ...) {
    cli_progress_erase(&session->progress);
    fprintf(stderr, "starguard %s: ", session->command->name);
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

starg_status cli_fail(cli_session *session, starg_status status, const char *format, ...) {
    session->error = (starg_error){
        .status = status, .stage = session->command->name, .message = session->message};
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(session->message, sizeof session->message, format, arguments);
    va_end(arguments);
    return status;
}

starg_status cli_fail_memory(cli_session *session) {
    return cli_fail(session, STARG_ERROR_MEMORY, "out of memory");
}

/* ---- finish ---- */

static cli_exit exit_status(starg_status status) {
    switch (status) {
    case STARG_OK:
        return CLI_EXIT_DONE;
    case STARG_ERROR_ARGUMENT:
        return CLI_EXIT_USAGE;
    case STARG_ERROR_READ:
    case STARG_ERROR_FORMAT:
    case STARG_ERROR_RANGE:
    case STARG_ERROR_MESH:
        return CLI_EXIT_INPUT;
    case STARG_ERROR_CANCELLED:
        return CLI_EXIT_CANCELLED;
    case STARG_ERROR_MEMORY:
    case STARG_ERROR_WRITE:
    case STARG_ERROR_SOLVER:
    case STARG_ERROR_TIME:
    case STARG_ERROR_RANK:
        break;
    }
    return CLI_EXIT_UNFINISHED;
}

/* A closed pipe is fine for text, but not for a result. */
static starg_status flush_stdout(cli_session *session) {
    errno = 0;
    bool broken = fflush(stdout) != 0 || ferror(stdout) != 0;
    int error = errno;
    if (!broken || (error == EPIPE && !session->stdout_taken && !session->common.json))
        return STARG_OK;
    return cli_fail(session, STARG_ERROR_WRITE, "cannot write standard output: %s",
                    error != 0 ? strerror(error) : "an earlier write failed");
}

/* Everything that can still fail, the outputs last: after a failure none has changed. */
static starg_status deliver(cli_session *session) {
    if (session->common.json)
        TRY(cli_report_print(session));
    TRY(flush_stdout(session));
    if (signal_count > signals_to_finish)
        return STARG_ERROR_CANCELLED;
    if (!cli_outputs_commit(&session->outputs))
        return cli_fail(session, STARG_ERROR_WRITE, "%s", session->outputs.message);
    return STARG_OK;
}

/* Detail of a failure: the command line's own, otherwise the library's. */
static starg_error find_error(cli_session *session, starg_status status) {
    if (session->error.status == status)
        return session->error;
    if (session->context != NULL && starg_context_error(session->context)->status == status)
        return *starg_context_error(session->context);
    return (starg_error){.status = status, .stage = "", .message = starg_status_string(status)};
}

static void tell_error(cli_session *session, starg_status status) {
    char message[sizeof session->message];
    starg_error error = find_error(session, status);
    snprintf(message, sizeof message, "%s", error.message);
    cli_outputs_translate(&session->outputs, message, sizeof message);
    error.message = message;
    cli_report_error(session, &error, (int)exit_status(status));
    fprintf(stderr, "starguard %s: %s%s%s\n", session->command->name, cli_style_on(stderr, CLI_RED),
            message, cli_style_off(stderr));
    if (status == STARG_ERROR_ARGUMENT)
        fprintf(stderr, "Try 'starguard %s --help'.\n", session->command->name);
}

int cli_session_finish(cli_session *session, starg_status status) {
    cli_progress_erase(&session->progress);
    if (status == STARG_OK)
        status = deliver(session);
    if (status != STARG_OK && signal_count > 0)
        status = STARG_ERROR_CANCELLED; /* whatever failure the interruption caused */
    int result = (int)session->outcome;
    if (status != STARG_OK) {
        tell_error(session, status);
        result = (int)exit_status(status);
    }
    cli_outputs_discard(&session->outputs);
    cli_report_free(session);
    starg_solid_free(session->solid);
    starg_mesh_free(session->mesh);
    signal_context = NULL;
    starg_context_free(session->context);
    return result;
}

void cli_free_scoped(void *pointer) {
    void *block;
    memcpy(&block, pointer, sizeof block);
    free(block);
}
