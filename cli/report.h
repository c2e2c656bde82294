/* SPDX-License-Identifier: Apache-2.0 */
/* --json: one object on standard output. docs/formats.md describes the keys. */
#ifndef STARGUARD_CLI_REPORT_H
#define STARGUARD_CLI_REPORT_H

#include "session.h"
#include "starguard/fields.h"
#include "starguard/mesh.h"

/* Starts the report; all functions below do nothing without a report. */
void cli_report_begin(cli_session *session);
void cli_report_free(cli_session *session);

/* Adds a key and takes over `value`; NULL means out of memory. */
void cli_put(cli_session *session, json_t *object, const char *key, json_t *value);
void cli_append(cli_session *session, json_t *array, json_t *value);

/* Values. Invalid UTF-8 bytes in text are replaced; a real that is not finite becomes null. */
json_t *cli_json_text(const char *text);
json_t *cli_json_real(double value);
json_t *cli_json_point(const double point[3]);

/* "format", "version" and "model". */
void cli_report_head(cli_session *session, const char *format, const char *file,
                     const starg_mesh *mesh);

/* The same in any object. */
void cli_put_head(cli_session *session, json_t *object, const char *format, const char *file,
                  const starg_mesh *mesh);

/* Writes an object as the output announced as `name`. Errors: WRITE, MEMORY. */
starg_status cli_report_write(cli_session *session, const json_t *object, const char *name);

/* Takes over the members of the object in a text of the library; frees the text. */
void cli_report_take(cli_session *session, char *text, size_t size);

/* The members of a record that have keys, as an object; NULL when out of memory. */
json_t *cli_json_record(cli_session *session, const starg_fields *fields, const void *record);

/* Collects a log line of the library for "log". */
void cli_report_log(cli_session *session, starg_log_level level, const char *message);

/* Adds log, seconds and memory, and prints. Errors: WRITE, MEMORY. */
starg_status cli_report_print(cli_session *session);

/* Prints an error instead, unless a report has been printed. */
void cli_report_error(cli_session *session, const starg_error *error, int exit_status);

#endif
