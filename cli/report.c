/* SPDX-License-Identifier: Apache-2.0 */
#include "session.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { LAYOUT = JSON_INDENT(1) | JSON_REAL_PRECISION(17) };

void cli_report_begin(cli_session *session) {
    session->report = json_object();
    session->log = json_array();
    session->report_broken = session->report == NULL || session->log == NULL;
}

void cli_report_free(cli_session *session) {
    json_decref(session->report);
    json_decref(session->log);
    session->report = session->log = NULL;
}

void cli_put(cli_session *session, json_t *object, const char *key, json_t *value) {
    if (json_object_set_new(object, key, value) != 0)
        session->report_broken = true;
}

void cli_append(cli_session *session, json_t *array, json_t *value) {
    if (json_array_append_new(array, value) != 0)
        session->report_broken = true;
}

/* Length of the UTF-8 sequence at `text`; 0 if invalid. jansson decides what is valid, so that
 * overlong forms and surrogates are treated in one place. */
static size_t sequence_length(const char *text) {
    for (size_t size = 1; size <= 4 && text[size - 1] != '\0'; size++) {
        json_t *probe = json_stringn(text, size);
        if (probe != NULL) {
            json_decref(probe);
            return size;
        }
    }
    return 0;
}

json_t *cli_json_text(const char *text) {
    static const char replacement[] = "\xEF\xBF\xBD";
    json_t *value = json_string(text);
    char *clean = value == NULL ? malloc(3 * strlen(text) + 1) : NULL;
    if (clean == NULL)
        return value;
    size_t used = 0;
    while (*text != '\0') {
        size_t size = sequence_length(text);
        memcpy(clean + used, size > 0 ? text : replacement, size > 0 ? size : 3);
        used += size > 0 ? size : 3;
        text += size > 0 ? size : 1;
    }
    value = json_stringn(clean, used);
    free(clean);
    return value;
}

json_t *cli_json_real(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *cli_json_point(const double point[3]) {
    return json_pack("[fff]", point[0], point[1], point[2]);
}

void cli_report_head(cli_session *session, const char *format, const char *file,
                     const starg_mesh *mesh) {
    if (session->report != NULL)
        cli_put_head(session, session->report, format, file, mesh);
}

void cli_put_head(cli_session *session, json_t *report, const char *format, const char *file,
                  const starg_mesh *mesh) {
    cli_put(session, report, "format", json_string(format));
    cli_put(session, report, "version", json_integer(1));
    if (mesh == NULL)
        return;
    json_t *model = json_object();
    cli_put(session, model, "file", cli_json_text(file));
    cli_put(session, model, "vertices", json_integer((json_int_t)starg_mesh_vertex_count(mesh)));
    cli_put(session, model, "faces", json_integer((json_int_t)starg_mesh_face_count(mesh)));
    cli_put(session, report, "model", model);
}

void cli_report_take(cli_session *session, char *text, size_t size) {
    json_t *object = json_loadb(text, size, 0, NULL);
    if (object == NULL || json_object_update(session->report, object) != 0)
        session->report_broken = true;
    json_decref(object);
    starg_text_free(session->context, text);
}

json_t *cli_json_record(cli_session *session, const starg_fields *fields, const void *record) {
    char *text;
    size_t size;
    if (starg_fields_json(session->context, fields, record, &text, &size) != STARG_OK)
        return NULL;
    json_t *object = json_loadb(text, size, 0, NULL);
    starg_text_free(session->context, text);
    return object;
}

void cli_report_log(cli_session *session, starg_log_level level, const char *message) {
    if (session->log == NULL)
        return;
    json_t *line = json_object();
    cli_put(session, line, "level", json_string(level == STARG_LOG_WARNING ? "warning" : "notice"));
    cli_put(session, line, "message", cli_json_text(message));
    cli_append(session, session->log, line);
}

static json_t *seconds(cli_session *session) {
    json_t *object = json_object();
    for (size_t i = 0; i < session->progress.count; i++) {
        const cli_stage *stage = &session->progress.stages[i];
        cli_put(session, object, stage->name, json_real(stage->seconds));
    }
    cli_put(session, object, "total", json_real(cli_clock() - session->began));
    return object;
}

static json_t *memory(cli_session *session) {
    json_t *object = json_object();
    struct rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) == 0)
        cli_put(session, object, "peak_resident_bytes",
                json_integer((json_int_t)usage.ru_maxrss * 1024));
    cli_put(session, object, "peak_library_bytes",
            json_integer((json_int_t)starg_context_peak_bytes(session->context)));
    return object;
}

/* Work shared by the processes of an MPI run; the rest of the time only rank 0 worked. */
static json_t *shared(cli_session *session) {
    json_t *object = json_object();
    cli_put(session, object, "count", json_integer(cli_ranks()->count));
    cli_put(session, object, "shared_seconds",
            json_real(starg_context_shared_seconds(session->context)));
    cli_put(session, object, "helped_items",
            json_integer((json_int_t)starg_context_helped_items(session->context)));
    return object;
}

starg_status cli_report_write(cli_session *session, const json_t *object, const char *name) {
    if (session->report_broken || object == NULL)
        return cli_fail_memory(session);
    FILE *stream = fopen(cli_outputs_place(&session->outputs, name), "w");
    bool written =
        stream != NULL && json_dumpf(object, stream, LAYOUT) == 0 && putc('\n', stream) != EOF;
    int error = errno;
    if (stream != NULL && fclose(stream) != 0 && written) {
        written = false;
        error = errno;
    }
    return written ? STARG_OK
                   : cli_fail(session, STARG_ERROR_WRITE, "cannot write '%.200s': %s", name,
                              strerror(error));
}

/* Prints an object and releases it. */
static bool print(json_t *object) {
    bool printed = object != NULL && json_dumpf(object, stdout, LAYOUT) == 0;
    if (printed)
        putc('\n', stdout);
    json_decref(object);
    return printed;
}

starg_status cli_report_print(cli_session *session) {
    json_t *report = session->report;
    cli_put(session, report, "log", json_incref(session->log));
    cli_put(session, report, "counted_work",
            json_integer((json_int_t)starg_context_work(session->context)));
    cli_put(session, report, "seconds", seconds(session));
    cli_put(session, report, "memory", memory(session));
    if (cli_ranks() != NULL)
        cli_put(session, report, "ranks", shared(session));
    if (session->report_broken)
        return cli_fail_memory(session);
    session->report = NULL;
    if (!print(report))
        return cli_fail(session, STARG_ERROR_WRITE, "cannot write standard output");
    return STARG_OK;
}

static const char *element_name(starg_element element) {
    static const char *const names[] = {"none", "vertex", "face",      "edge",       "line",
                                        "byte", "guard",  "candidate", "tetrahedron"};
    return (size_t)element < sizeof names / sizeof *names ? names[element] : "unknown";
}

static const char *status_name(starg_status status) {
    static const char *const names[] = {"ok",   "argument", "memory", "read", "write",     "format",
                                        "mesh", "range",    "solver", "time", "cancelled", "rank"};
    return (size_t)status < sizeof names / sizeof *names ? names[status] : "unknown";
}

void cli_report_error(cli_session *session, const starg_error *error, int exit_status) {
    if (session->report == NULL)
        return;
    json_t *indices = json_array();
    for (size_t i = 0; i < error->index_count; i++)
        cli_append(session, indices, json_integer((json_int_t)error->indices[i]));
    json_t *detail = json_object();
    cli_put(session, detail, "status", json_string(status_name(error->status)));
    cli_put(session, detail, "exit_status", json_integer(exit_status));
    cli_put(session, detail, "stage", json_string(error->stage));
    cli_put(session, detail, "message", cli_json_text(error->message));
    cli_put(session, detail, "element", json_string(element_name(error->element)));
    cli_put(session, detail, "indices", indices);
    json_t *object = json_object();
    cli_put(session, object, "error", detail);
    print(object);
}
