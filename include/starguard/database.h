/* SPDX-License-Identifier: Apache-2.0 */
/* A retrieval database: signatures of models in an SQLite file (schema in docs/formats.md). */
#ifndef STARGUARD_DATABASE_H
#define STARGUARD_DATABASE_H

#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "ranks.h"
#include "shape.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An open database. Several processes may open the same file; each change is a transaction and
 * waits up to a minute for others. */
typedef struct starg_database starg_database;

/* Creates an empty database. The file is written completely or not at all. Errors: WRITE (it
 * already exists, or the folder is not writable), MEMORY. */
STARG_API starg_status starg_database_create(starg_context *context, const char *path);

/* Opens a database. Close it before freeing its context. Errors: READ (missing or not readable),
 * FORMAT (not a starguard database, or another schema version), MEMORY. */
STARG_API starg_status starg_database_open(starg_context *context, const char *path,
                                           starg_database **out);
STARG_API void starg_database_close(starg_database *database);

/* ---- adding and removing ---- */

typedef enum starg_database_outcome {
    STARG_DATABASE_ADDED = 0,
    STARG_DATABASE_KNOWN = 1,  /* a model with the same content is stored */
    STARG_DATABASE_REFUSED = 2 /* unreadable, or no usable model        */
} starg_database_outcome;

/* The outcome for one file. */
typedef struct starg_database_result {
    starg_database_outcome outcome;
    char *text; /* KNOWN: the name of the stored content; REFUSED: the reason; ADDED: a warning
                about the model, or NULL */
} starg_database_result;

typedef struct starg_database_report {
    size_t count, added, known, refused;
    starg_database_result *results; /* one per file, in order */
} starg_database_report;

/* Stores models with signatures of all kinds under the given paths. Contents already stored are
 * skipped (missing or outdated signatures are recomputed). Unusable files do not stop the others.
 * Files are processed in parallel and stored in order, a few at a time: after a cancellation, a
 * time limit or a crash, everything stored so far remains and the database is consistent. Errors:
 * ARGUMENT ("-" as a file), WRITE, MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_database_add(starg_database *database, const char *const *files,
                                          size_t count, starg_database_report **out);
STARG_API void starg_database_report_free(starg_context *context, starg_database_report *report);

/* Removes models, all or none. Each word is a stored path, a file name, or "id:N", and must
 * identify exactly one model. Errors: READ (no such model), ARGUMENT (ambiguous name), WRITE,
 * MEMORY. */
STARG_API starg_status starg_database_remove(starg_database *database, const char *const *words,
                                             size_t count);

/* ---- reading ---- */

typedef struct starg_database_model {
    int64_t id;
    char *path;       /* as it was given                        */
    const char *name; /* the file name at its end, within path  */
    char hash[65];    /* SHA-256 of the file, in hexadecimal    */
    size_t vertices, faces;
    double distance;            /* query: to the given signature */
    starg_signature *signature; /* starg_database_signatures only         */
} starg_database_model;

typedef struct starg_database_models {
    size_t count;
    starg_database_model *items;
} starg_database_models;

/* All models sorted by file name, then id. */
STARG_API starg_status starg_database_list(starg_database *database, starg_database_models **out);

/* The same with signatures of one kind. Errors: ARGUMENT, FORMAT (a signature is missing or
 * damaged), MEMORY, CANCELLED. */
STARG_API starg_status starg_database_signatures(starg_database *database,
                                                 starg_signature_kind kind,
                                                 starg_database_models **out);

/* The `wanted` models nearest to a signature, sorted by distance, then id. */
STARG_API starg_status starg_database_query(starg_database *database,
                                            const starg_signature *signature, size_t wanted,
                                            starg_database_models **out);
STARG_API void starg_database_models_free(starg_context *context, starg_database_models *models);

/* ---- classes ---- */

typedef struct starg_classes {
    size_t count;
    char **names;       /* ascending                                            */
    size_t model_count; /* of the list they were computed for */
    uint32_t *class_of; /* by model: an index into names, or STARG_NO_CLASS     */
} starg_classes;

/* The class of a model is its file name up to the last '_' (the whole name if it has none). */
STARG_API starg_status starg_classes_by_prefix(starg_context *context,
                                               const starg_database_models *models,
                                               starg_classes **out);

/* Reads lines "MODEL CLASS", where MODEL is a stored path or a file name; empty lines and lines
 * that begin with '#' are ignored. Models not listed have no class. Errors: READ, FORMAT (a line
 * with an unknown model, or one that already has a class), MEMORY. */
STARG_API starg_status starg_classes_read(starg_context *context, const char *path,
                                          const starg_database_models *models, starg_classes **out);
STARG_API void starg_classes_free(starg_context *context, starg_classes *classes);

/* Like starg_ranks_serve, and also describes files of starg_database_add. */
STARG_API starg_status starg_database_ranks_serve(starg_context *context, const starg_ranks *ranks);

#ifdef __cplusplus
}
#endif

#endif
