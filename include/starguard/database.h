/* SPDX-License-Identifier: Apache-2.0 */
/* A retrieval database: signatures of models in an SQLite file (docs/formats.md has its schema). */
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

/* An open database. Several processes may have the same file open; each change is a transaction,
 * and one that meets another waits for it, for up to a minute. */
typedef struct starg_database starg_database;

/* Makes an empty database. The file appears whole or not at all. Errors: WRITE (it exists already,
 * or the folder cannot be written), MEMORY. */
STARG_API starg_status starg_database_create(starg_context *context, const char *path);

/* Errors: READ (there is no such file, or it may not be read), FORMAT (no database of ours, or of
 * another schema version), MEMORY. The database must be closed before its context is freed. */
STARG_API starg_status starg_database_open(starg_context *context, const char *path,
                                           starg_database **out);
STARG_API void starg_database_close(starg_database *database);

/* ---- adding and removing ---- */

typedef enum starg_database_outcome {
    STARG_DATABASE_ADDED = 0,
    STARG_DATABASE_KNOWN = 1,  /* a model of the same content is stored */
    STARG_DATABASE_REFUSED = 2 /* unreadable, or no usable model        */
} starg_database_outcome;

/* What became of one file. */
typedef struct starg_database_result {
    starg_database_outcome outcome;
    char *text; /* KNOWN: the name that the content is stored under; REFUSED: why; else NULL */
} starg_database_result;

typedef struct starg_database_report {
    size_t count, added, known, refused;
    starg_database_result *results; /* one a file, in their order */
} starg_database_report;

/* Stores models with their signatures of all kinds, under their paths as given. Contents that are
 * stored already are skipped (their signatures are made anew where they are missing or of another
 * version). A file that cannot be used does not keep the others from being stored. Files are worked
 * on in parallel and stored in their order, a few at a time: what is stored when the call is
 * cancelled, runs out of time or dies stays, and the file stays in order.
 * Errors: ARGUMENT ("-" as a file), WRITE, MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_database_add(starg_database *database, const char *const *files,
                                          size_t count, starg_database_report **out);
STARG_API void starg_database_report_free(starg_context *context, starg_database_report *report);

/* Removes models, all or none. Each word is a stored path, the file name at its end, or "id:N";
 * it must mean exactly one model. Errors: READ (no such model), ARGUMENT (several of that name),
 * WRITE, MEMORY. */
STARG_API starg_status starg_database_remove(starg_database *database, const char *const *words,
                                             size_t count);

/* ---- reading ---- */

typedef struct starg_database_model {
    int64_t id;
    char *path;       /* as it was given                        */
    const char *name; /* the file name at its end, within path  */
    char hash[65];    /* SHA-256 of the file, in hexadecimal    */
    size_t vertices, faces;
    double distance;            /* query: to the signature asked for      */
    starg_signature *signature; /* starg_database_signatures only         */
} starg_database_model;

typedef struct starg_database_models {
    size_t count;
    starg_database_model *items;
} starg_database_models;

/* All models by file name, equal ones by their id. */
STARG_API starg_status starg_database_list(starg_database *database, starg_database_models **out);

/* The same with their signatures of a kind. Errors: ARGUMENT, FORMAT (a signature is missing, or
 * damaged), MEMORY, CANCELLED. */
STARG_API starg_status starg_database_signatures(starg_database *database,
                                                 starg_signature_kind kind,
                                                 starg_database_models **out);

/* The `wanted` models nearest to a signature, the nearest first, equal ones by their id. */
STARG_API starg_status starg_database_query(starg_database *database,
                                            const starg_signature *signature, size_t wanted,
                                            starg_database_models **out);
STARG_API void starg_database_models_free(starg_context *context, starg_database_models *models);

/* ---- classes ---- */

typedef struct starg_classes {
    size_t count;
    char **names;       /* ascending                                            */
    size_t model_count; /* of the list that they were made for                  */
    uint32_t *class_of; /* by model: an index into names, or STARG_NO_CLASS     */
} starg_classes;

/* The class of a model is its file name up to the last '_' (the whole name if it has none). */
STARG_API starg_status starg_classes_by_prefix(starg_context *context,
                                               const starg_database_models *models,
                                               starg_classes **out);

/* From a text of lines "MODEL CLASS", MODEL being a stored path or a file name; empty lines and
 * lines that begin with '#' say nothing. Models that no line names have no class.
 * Errors: READ, FORMAT (a line that names no model, or one that has a class), MEMORY. */
STARG_API starg_status starg_classes_read(starg_context *context, const char *path,
                                          const starg_database_models *models, starg_classes **out);
STARG_API void starg_classes_free(starg_context *context, starg_classes *classes);

/* As starg_ranks_serve, and describes the files of a starg_database_add. */
STARG_API starg_status starg_database_ranks_serve(starg_context *context, const starg_ranks *ranks);

#ifdef __cplusplus
}
#endif

#endif
